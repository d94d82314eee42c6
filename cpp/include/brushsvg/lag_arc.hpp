#pragma once

#include "brushsvg/lag.hpp"

// The lag on a circular arc at constant depth: both rules of lag.hpp, each in closed form.
//
// In the equations, k = 1/R is the signed curvature [1/mm] and r the lag [mm]. psi is the angle from the direction of
// motion to the heading.
namespace [[gnu::visibility("default")]] brushsvg {

template <class T>
Vec2<T> rotated(const Vec2<T>& v, const T& angle) {
    using std::cos;
    using std::sin;
    const T c = cos(angle), s = sin(angle);
    return Vec2<T>(c * v.x() - s * v.y(), s * v.x() + c * v.y());
}

/// A move of the TCP along a circular arc at constant depth. The position runs with t from 0 to 1.
template <class T>
struct ArcMove {
    Vec2<T> from, along;  ///< start [mm] and unit direction of motion there
    /// R [mm], signed angle [rad] (counter-clockwise > 0, not 0), length [mm], depth [mm] (>= 0).
    T radius, turn, length, depth_from;
    T depth_by = T(0.0);  ///< always 0: the depth does not change
    double side;          ///< 1 if the centre is to the left, else -1

    ArcMove(const Vec2<T>& start, const Vec2<T>& direction, const T& radius_mm, const T& turn_rad, const T& depth)
        : from(start), along(direction), radius(radius_mm), turn(turn_rad), depth_from(depth) {
        side = value_of(turn) > 0.0 ? 1.0 : -1.0;
        length = radius * (side * turn);
    }
    Vec2<T> direction(const T& t) const { return rotated(along, T(turn * t)); }
    Vec2<T> tcp(const T& t) const {  // computed from the chord, so that a large radius loses no digits
        using std::sin;
        const T half = 0.5 * turn * t;
        return from + rotated(along, half) * (2.0 * radius * sin(half) * side);
    }
    T depth(const T&) const { return depth_from; }
};

/// Return the arc from one point to another [mm] that turns by less than half a turn.
///
/// `turn`: signed angle [rad], counter-clockwise > 0. `depth`: [mm]. The radius follows from the points. So arcs join
/// without a jump even if a file has rounded the positions.
template <class T>
ArcMove<T> arc_between(const Vec2<T>& from, const Vec2<T>& to, const T& turn, const T& depth) {
    using std::sin;
    using std::sqrt;
    const Vec2<T> by = to - from;
    const T chord = sqrt(by.squaredNorm()), half = 0.5 * turn, sine = sin(half);
    return ArcMove<T>(from, rotated(Vec2<T>(by / chord), T(-half)),
                      T(chord / (value_of(turn) > 0.0 ? 2.0 * sine : -2.0 * sine)), turn, depth);
}

namespace detail {

/// Advance the half-angle vector (x, y) = (cos, sin)(psi/2), up to a factor.
///
/// With d(psi)/ds = -sin(psi)/r - k, the vector is multiplied by
///     exp(s A) = C I + S 2r A,   A = [[1/(2r), k/2], [-k/2, -1/(2r)]],   w^2 = 1 - (k r)^2,
/// with C = cosh(w s/(2r)) and S = sinh(w s/(2r)) / w. These become cos and sin where |k| r > 1, and 1 and s/(2r) where
/// |k| r = 1. Both are divided by the cosh, which overflows on long arcs.
///
/// `kr` = k r and `s_r` = s / r have no unit.
template <class T>
void carry_half_angle(const T& kr, const T& s_r, T& x, T& y) {
    using std::cos;
    using std::sin;
    using std::sqrt;
    using std::tanh;
    const T w2 = (T(1.0) - kr) * (T(1.0) + kr);
    T c(1.0), s = 0.5 * s_r;
    if (w2 > T(0.0)) {
        const T w = sqrt(w2);
        s = tanh(T(0.5 * w * s_r)) / w;
    } else if (w2 < T(0.0)) {
        const T w = sqrt(T(-w2));
        c = cos(T(0.5 * w * s_r));
        s = sin(T(0.5 * w * s_r)) / w;
    }
    const T x0 = x, y0 = y;
    x = c * x0 + s * (x0 + kr * y0);
    y = c * y0 - s * (kr * x0 + y0);
}

/// Return the component of a vector to the left of a direction.
template <class T>
T across(const Vec2<T>& along, const Vec2<T>& v) {
    return along.x() * v.y() - along.y() * v.x();
}

/// Advance a taut state from t = `begin` to `t`.
template <class T>
void drag(const LawPiece<T>& law, const ArcMove<T>& arc, const T& begin, const T& t, LagState<T>& state) {
    const T r = law.at(arc.depth_from);
    const Vec2<T> before = arc.direction(begin), now = arc.direction(t);
    const T a = state.heading.dot(before), b = across(before, state.heading);
    const bool ahead = a >= T(0.0);  // selects the form of the half-angle vector that avoids cancellation
    T x = ahead ? T(T(1.0) + a) : b, y = ahead ? b : T(T(1.0) - a);
    if (r > T(0.0))
        carry_half_angle(T(arc.side * r / arc.radius), T(arc.length * (t - begin) / r), x, y);
    else
        y = T(0.0);
    const T norm = x * x + y * y;
    state.heading = now;
    if (norm > T(std::numeric_limits<double>::min())) {
        const T c = (x * x - y * y) / norm, s = T(2.0) * x * y / norm;
        state.heading = Vec2<T>(c * now.x() - s * now.y(), c * now.y() + s * now.x());
    }
    state.contact = arc.tcp(t) - r * state.heading;
}

/// Limit of cos(psi) below which the brush is being pushed. Values between the limit and 0 are rounding errors of
/// psi = 90 degrees, the angle of a turn in place about the contact.
constexpr double kMaxPushedCosine = -1e-13;

/// Return the t at which a taut brush goes loose; above 1 if it stays taut.
///
/// The brush goes loose where psi passes 90 degrees on the outer side of the arc, so only if |k| r > 1. There x + y of
/// the half-angle vector is 0 (x - y if k < 0):
///     tan(w s/(2r)) = w cos(psi) / ((1 - sin(psi)) (k r - 1)),   w^2 = (k r)^2 - 1,   signs for k > 0.
template <class T>
T loosening(const T& r, const ArcMove<T>& arc, const LagState<T>& state, const T& begin) {
    using std::atan2;
    using std::sqrt;
    const T kr = r / arc.radius;
    if (!(kr > T(1.0))) return T(2.0);
    const Vec2<T> direction = arc.direction(begin);
    const T a = state.heading.dot(direction), b = arc.side * across(direction, state.heading);
    const T w = sqrt(T((kr - 1.0) * (kr + 1.0)));
    const T angle =
        b > T(0.0) ? atan2(T(w * (1.0 + b)), T(a * (kr - 1.0))) : atan2(T(w * a), T((1.0 - b) * (kr - 1.0)));
    return angle > T(0.0) ? T(begin + 2.0 * angle / w * r / arc.length) : begin;
}

/// Return the t at which a loose brush pulls tight; above 1 if it stays loose.
///
/// The resting contact is at distance D from the arc's centre, and q is at distance R. beta is the angle at the centre
/// from the contact to q. So
///     |q - p|^2 = R^2 + D^2 - 2 R D cos(beta) = r^2
/// holds at sin^2(beta/2) = sin^2(beta0/2) + (r^2 - |q0 - p|^2) / (4 R D).
///
/// `pushed`: whether the brush was taut until now.
template <class T>
T tightening(const T& r, const ArcMove<T>& arc, const LagState<T>& state, const T& begin, bool pushed) {
    using std::atan2;
    using std::sin;
    using std::sqrt;
    const Vec2<T> direction = arc.direction(begin);
    const Vec2<T> reach = pushed ? Vec2<T>(r * state.heading) : Vec2<T>(arc.tcp(begin) - state.contact);
    const T ahead = reach.dot(direction), outward = arc.radius + arc.side * across(direction, reach);
    const T beta0 = atan2(ahead, outward), whole = arc.side * arc.turn;
    if (pushed) return begin - 2.0 * beta0 / whole;
    const T slack = r * r - reach.squaredNorm();
    if (slack < T(0.0)) return begin;
    T sine2 = sin(T(0.5 * beta0));
    sine2 = sine2 * sine2 + slack / (4.0 * arc.radius * sqrt(T(ahead * ahead + outward * outward)));
    if (!(sine2 <= T(1.0))) return T(2.0);
    const T later = (2.0 * atan2(T(sqrt(sine2)), T(sqrt(T(1.0 - sine2)))) - beta0) / whole;
    return later > T(0.0) ? T(begin + later) : begin;  // with almost no slack, a rounding error can make it negative
}

}  // namespace detail

/// Return psi [rad] in (-pi, pi] after the TCP has moved along an arc at constant lag.
///
/// `psi0`: psi at the start of the arc [rad]. `curvature_per_mm`: signed curvature k [1/mm]. `lag_mm`: r [mm].
/// `length_mm`: length of the arc s [mm]. Valid only while the brush is taut, |psi| <= 90 degrees.
template <class T>
T drag_arc(const T& psi0, const T& curvature_per_mm, const T& lag_mm, const T& length_mm) {
    using std::atan2;
    using std::cos;
    using std::sin;
    T x = cos(T(0.5 * psi0)), y = sin(T(0.5 * psi0));
    detail::carry_half_angle(T(curvature_per_mm * lag_mm), T(length_mm / lag_mm), x, y);
    const T psi = 2.0 * atan2(y, x);
    constexpr double pi = 3.14159265358979323846;
    if (psi > T(pi)) return psi - T(2.0 * pi);
    if (psi <= T(-pi)) return psi + T(2.0 * pi);
    return psi;
}

/// Return the state at `t` of a phase without events.
///
/// `start`: the state at t = `begin`, where the phase begins.
template <class T>
LagState<T> state_in_phase(const LawPiece<T>& law, const ArcMove<T>& arc, const LagState<T>& start, const T& begin,
                           const T& t) {
    LagState<T> state = start;
    if (start.taut)
        detail::drag(law, arc, begin, t, state);
    else
        detail::point_at(arc.tcp(t), state);
    return state;
}

/// Advance the state over one arc, phase by phase, like advance() over a straight move.
///
/// A brush that has loosened because psi passed 90 degrees stays loose to the arc's end, even on a whole circle. Its
/// contact rests at distance r - R from the centre, so q is never further than r from the contact.
template <class T, class PhaseSink>
void advance(const LagLaw<T>& law, const ArcMove<T>& arc, LagState<T>& state, PhaseSink&& phase) {
    const LawPiece<T>& piece = law.piece(value_of(arc.depth_from));
    const auto run = [&](const T& begin, const T& end) {
        if (!(begin < end)) return;
        phase(piece, arc, state, begin, end);
        state = state_in_phase(piece, arc, state, begin, end);
    };
    if (law.rigid) {  // a pen: p = q, the heading is the direction of motion
        state.taut = state.heading_known = true;
        state.heading = arc.along;
        state.contact = arc.from;
        return run(T(0.0), T(1.0));
    }
    const T r = piece.at(arc.depth_from), end(1.0);
    T begin(0.0);
    for (int round = 0; round < 2; ++round) {
        const bool pushed = state.taut && state.heading.dot(arc.direction(begin)) < T(detail::kMaxPushedCosine);
        if (pushed) state.taut = false;
        if (!state.taut) {
            const T t = detail::tightening(r, arc, state, begin, pushed);
            const bool tightens = t <= end;
            run(begin, tightens ? t : end);
            if (!tightens) return;
            begin = t;
            state.taut = true;
            state.contact = arc.tcp(begin) - r * state.heading;
            continue;  // already past the limit because of a rounding error: check again
        }
        break;
    }
    const T t = detail::loosening(r, arc, state, begin);
    run(begin, t < end ? t : end);
    if (!(t < end)) return;
    state.taut = false;
    run(t, end);
}

template <class T>
void advance(const LagLaw<T>& law, const ArcMove<T>& arc, LagState<T>& state) {
    advance(law, arc, state, [](const auto&, const auto&, const auto&, const T&, const T&) {});
}

}  // namespace brushsvg
