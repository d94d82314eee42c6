#pragma once

// Definitions of the templates that lag.hpp declares. Include lag.hpp instead of this file.
#include "brushsvg/lag.hpp"

namespace [[gnu::visibility("default")]] brushsvg {
namespace detail {

/// Nodes on [-1, 1] and weights of Gauss-Legendre quadrature with N nodes. The weights add up to 1, so a sum is a mean.
template <int N>
struct Gauss;
template <>
struct Gauss<3> {
    static constexpr double x[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
    static constexpr double w[3] = {0.2777777777777778, 0.4444444444444444, 0.2777777777777778};
};
template <>
struct Gauss<5> {
    static constexpr double x[5] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                                    0.9061798459386640};
    static constexpr double w[5] = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444, 0.2393143352496832,
                                    0.1184634425280945};
};
template <>
struct Gauss<12> {
    static constexpr double x[12] = {-0.9815606342467193, -0.9041172563704749, -0.7699026741943047, -0.5873179542866175,
                                     -0.3678314989981802, -0.1252334085114689, 0.1252334085114689,  0.3678314989981802,
                                     0.5873179542866175,  0.7699026741943047,  0.9041172563704749,  0.9815606342467193};
    static constexpr double w[12] = {0.0235876681932559, 0.0534696629976592, 0.0800391642716731, 0.1015837133615330,
                                     0.1167462682691774, 0.1245735229067014, 0.1245735229067014, 0.1167462682691774,
                                     0.1015837133615330, 0.0800391642716731, 0.0534696629976592, 0.0235876681932559};
};

/// Return the mean of 1/r over the depths [middle - half, middle + half] [mm]. Two mirrored nodes share one division.
template <int N>
double mean_reciprocal(const LawPiece<double>& law, double middle, double half) {
    double sum = 0.0;
    for (int i = 0; i < N / 2; ++i) {
        const double step = half * Gauss<N>::x[i], a = law.at(middle + step), b = law.at(middle - step);
        sum += Gauss<N>::w[i] * (a + b) / (a * b);
    }
    if (N % 2 == 1) sum += Gauss<N>::w[N / 2] / law.at(middle);
    return sum;
}

/// Return the mean of 1/r with its derivatives. The derivatives by the coefficients and depths are summed as plain
/// numbers; the chain rule is applied once at the end.
template <int N, class T>
T mean_reciprocal(const LawPiece<T>& law, const T& middle, const T& half) {
    double sum = 0.0, by_middle = 0.0, by_half = 0.0;
    std::array<double, kMaxLawDegree + 1> by_coefficient{};
    for (int i = 0; i < N; ++i) {
        const double depth = value_of(middle) + Gauss<N>::x[i] * value_of(half);
        double r = 0.0, slope = 0.0;
        for (std::size_t k = std::size_t(law.degree) + 1; k-- > 0;) {
            slope = slope * depth + r;
            r = r * depth + value_of(law.coefficients[k]);
        }
        sum += Gauss<N>::w[i] / r;
        double by_r = -Gauss<N>::w[i] / (r * r);
        by_middle += by_r * slope;
        by_half += by_r * slope * Gauss<N>::x[i];
        for (std::size_t k = 0; k <= std::size_t(law.degree); ++k, by_r *= depth) by_coefficient[k] += by_r;
    }
    T mean(sum);
    mean.v = by_middle * middle.v + by_half * half.v;
    for (std::size_t k = 0; k <= std::size_t(law.degree); ++k) mean.v += by_coefficient[k] * law.coefficients[k].v;
    return mean;
}

/// Remove the derivatives. Only the values decide where events are.
template <class T>
Vec2<double> values_of(const Vec2<T>& v) {
    return {value_of(v.x()), value_of(v.y())};
}
template <class T>
LawPiece<double> values_of(const LawPiece<T>& law) {
    LawPiece<double> out{
        law.lo, law.hi, law.degree, {}, law.roots, law.root_distance2, law.max_slope, law.max_third_derivative};
    for (std::size_t k = 0; k <= std::size_t(law.degree); ++k) out.coefficients[k] = value_of(law.coefficients[k]);
    return out;
}
template <class T>
Move<double> values_of(const Move<T>& move) {
    const double depth = value_of(move.depth_from);
    const Vec2<double> from = values_of(move.from);
    return {from, from + values_of(move.by), depth, depth + value_of(move.depth_by)};
}
template <class T>
LagState<double> values_of(const LagState<T>& state) {
    return {values_of(state.contact), values_of(state.heading), state.taut, state.heading_known};
}

/// Most intervals of a move that are searched for an event. A move whose numbers are finite needs thousands of times
/// fewer.
constexpr int kMaxIntervals = 100000;

/// Return the smallest t in [begin, end] from which a function is negative.
///
/// Returns end + 1 if there is none. `lower(a, b)`: a lower bound of the function on [a, b]. `value(t)`: its exact
/// value.
template <class Lower, class Value>
double first_negative(double begin, double end, Lower&& lower, Value&& value) {
    struct Span {
        double a, b;
    };
    std::array<Span, 128> stack;
    std::size_t top = 0;
    stack[top++] = {begin, end};
    for (int intervals = 0; top > 0 && intervals < kMaxIntervals; ++intervals) {
        const auto [a, b] = stack[--top];
        if (lower(a, b) >= 0.0) continue;
        const double middle = 0.5 * (a + b);
        if (b - a < 1e-15 || !(a < middle && middle < b) || top + 2 > stack.size()) {
            if (value(b) < 0.0) return b;
            continue;
        }
        stack[top++] = {middle, b};
        stack[top++] = {a, middle};
    }
    return end + 1.0;
}

/// Return the smallest x in [0, 1] from which a polynomial is positive.
///
/// Returns 2 if there is none. `polynomial`: coefficients in ascending order. Bernstein coefficients bound the
/// polynomial on each half of an interval, so no pair of roots is overlooked.
double first_positive(std::vector<double> polynomial);

/// Advance a taut state from t = `begin` to `t`.
template <class T>
void drag(const LawPiece<T>& law, const Move<T>& move, const T& begin, const T& t, LagState<T>& state) {
    using std::exp;
    const T depth = move.depth(t);
    if (move.length > T(0.0)) {
        const T x = lag_exponent(law, move.depth(begin), depth, T(move.length * (t - begin)));
        state.heading = drag_heading(state.heading, move.along, T(exp(-x)));
    }
    state.contact = move.tcp(t) - law.at(depth) * state.heading;  // article (5), (6)
}

/// Turn the heading of loose bristles from the contact to the TCP. Where the TCP is over the contact, the heading is
/// kept.
template <class T>
void point_at(const Vec2<T>& tcp, LagState<T>& state) {
    using std::sqrt;
    const Vec2<T> reach = tcp - state.contact;
    const T squared = reach.squaredNorm();
    if (squared > T(0.0)) {
        state.heading = reach / sqrt(squared);
        state.heading_known = true;
    }
}

/// Return whether a taut brush certainly stays taut. psi shrinks while taut, so g >= cos(psi0) - max|dr/ds|. Most moves
/// pass this test and need no search for events.
template <class T>
bool stays_taut(const LawPiece<T>& law, const Move<T>& move, double cosine0) {
    return value_of(move.length) * cosine0 >= std::abs(value_of(move.depth_by)) * law.max_slope;
}

inline double cosine_after(const LawPiece<double>& law, const Move<double>& move, const LagState<double>& start,
                           double begin, double t) {
    return state_in_phase(law, move, start, begin, t).heading.dot(move.along);
}

/// Return the t in [begin, end] at which a taut brush goes loose; 2 if none.
inline double first_loosening(const LawPiece<double>& law, const Move<double>& move, const LagState<double>& start,
                              double begin, double end) {
    const double length = move.length, depth_by = move.depth_by;
    // A shallower dip of g moves the patch only by the square of that depth. A search for such dips would never end
    // where g only touches 0.
    const double noise = 1e-10 * (length + std::abs(depth_by) * law.max_slope);
    const auto lengthening = [&](double t) { return depth_by * law.slope(move.depth(t)); };
    const auto g = [&](double t) { return length * cosine_after(law, move, start, begin, t) - lengthening(t); };
    if (g(begin) < -noise) return begin;
    const double bend = std::abs(depth_by * depth_by * depth_by) * law.max_third_derivative / 8.0;
    const double t = first_negative(
        begin, end,
        [&](double a, double b) {
            // on [a, b] the function is at most as far above its chord as a parabola
            const double most = std::max(lengthening(a), lengthening(b)) + bend * (b - a) * (b - a);
            return length * cosine_after(law, move, start, begin, a) - most + noise;
        },
        [&](double t) { return g(t) + noise; });
    return t <= end ? t : 2.0;
}

/// Return the coefficients of r(d0 + x dd)^2 in ascending powers of x.
template <class T>
std::vector<T> squared_lever(const LawPiece<T>& law, const T& d0, const T& dd) {
    const int n = law.degree;
    std::vector<T> c(law.coefficients.begin(), law.coefficients.begin() + n + 1);
    for (int i = 0; i < n; ++i)
        for (int j = n - 1; j >= i; --j) c[j] += d0 * c[j + 1];
    T power(1.0);
    for (int i = 0; i <= n; ++i, power *= dd) c[i] *= power;
    std::vector<T> square(2 * n + 1, T(0.0));
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) square[i + j] += c[i] * c[j];
    return square;
}

}  // namespace detail

template <class T>
Vec2<T> drag_heading(const Vec2<T>& heading, const Vec2<T>& along, const T& decay) {
    const Vec2<double> u = detail::values_of(heading), v = detail::values_of(along);
    const double e = value_of(decay), a = u.dot(v), b = v.x() * u.y() - v.y() * u.x();
    // (x, y) is (cos, sin)(psi/2) up to a common factor; each of the two forms avoids cancellation for its sign of a
    const double x = a >= 0.0 ? 1.0 + a : b, y = e * (a >= 0.0 ? b : 1.0 - a), norm = x * x + y * y;
    // psi = pi and E = 0: the heading becomes the direction of motion
    if (!(norm > std::numeric_limits<double>::min())) return along;
    const double c = (x * x - y * y) / norm, s = 2.0 * x * y / norm;
    Vec2<T> out(T(c * v.x() - s * v.y()), T(c * v.y() + s * v.x()));
    if constexpr (!std::is_arithmetic_v<T>) {
        // derivatives of angles, not of components:
        // d psi1 = (E d psi0 + sin(psi0) dE) / (cos^2(psi0/2) + E^2 sin^2(psi0/2))
        const double share = 2.0 * (1.0 + std::abs(a)) / norm;
        using Slopes = decltype(T::v);
        const Slopes motion = v.x() * along.y().v - v.y() * along.x().v;
        const Slopes turn = u.x() * heading.y().v - u.y() * heading.x().v - motion;
        const Slopes turned = motion + share * (e * turn + b * decay.v);
        out.x().v = -value_of(out.y()) * turned;
        out.y().v = value_of(out.x()) * turned;
    }
    return out;
}

template <class T>
T lag_exponent(const LawPiece<T>& law, const T& depth0, const T& depth1, const T& length, int splits_left) {
    if (law.degree == 0) return length / law.coefficients[0];
    const T half = 0.5 * (depth1 - depth0), middle = 0.5 * (depth0 + depth1);
    const double h = value_of(half), m = value_of(middle), h2 = h * h;
    if (law.root_distance2 > 73.0 * 73.0 * h2) return length * detail::mean_reciprocal<3>(law, middle, half);
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& root : law.roots) {
        const double dx = root.real() - m, dy = root.imag();
        nearest = std::min(nearest, dx * dx + dy * dy);
    }
    if (nearest > 73.0 * 73.0 * h2) return length * detail::mean_reciprocal<3>(law, middle, half);
    if (nearest > 10.0 * 10.0 * h2) return length * detail::mean_reciprocal<5>(law, middle, half);
    if (!(nearest <= 1.9 * 1.9 * h2) || splits_left == 0 || !(h2 < 1e300))
        return length * detail::mean_reciprocal<12>(law, middle, half);
    // a piece as short as a rounding error, at a root: its halves would be the same piece again
    if (std::abs(h) < 1e-13 * (1.0 + std::abs(m))) {
        const T r = law.at(middle);
        return value_of(r) * 50.0 > value_of(length) ? length / r : T(50.0);
    }
    // begin at the end with the shorter lever: where the lever is nearly 0, the sum is soon large enough
    const T half_length = 0.5 * length;
    const bool first = value_of(law.at(depth0)) < value_of(law.at(depth1));
    const T shorter = lag_exponent(law, first ? depth0 : middle, first ? middle : depth1, half_length, splits_left - 1);
    if (shorter > T(50.0)) return shorter;
    return shorter + lag_exponent(law, first ? middle : depth0, first ? depth1 : middle, half_length, splits_left - 1);
}

template <class T>
LagState<T> state_in_phase(const LawPiece<T>& law, const Move<T>& move, const LagState<T>& start, const T& begin,
                           const T& t) {
    LagState<T> state = start;
    if (start.taut) {
        detail::drag(law, move, begin, t, state);
        return state;
    }
    detail::point_at(move.tcp(t), state);
    return state;
}

namespace detail {

/// How a loose phase began: before this stretch, by a jump of g, or where g crossed 0.
enum class Loosened { before, by_jump, by_crossing };

/// Return where a loose brush pulls tight again; 2 if it stays loose.
///
/// The result is x in [0, 1] over [begin, end]. `polynomial`: receives the coefficients of f = |q - p|^2 - r^2 in
/// ascending powers of x.
template <class T>
double first_tightening(const LawPiece<T>& law, const Move<T>& move, const LagState<T>& start, const T& begin,
                        const T& end, Loosened loosened, std::vector<T>& polynomial) {
    const T span = end - begin;
    polynomial = squared_lever(law, move.depth(begin), T(move.depth_by * span));
    for (T& c : polynomial) c = -c;
    if (polynomial.size() < 3) polynomial.resize(3, T(0.0));
    const Vec2<T> reach = move.tcp(begin) - start.contact, by = move.by * span;
    polynomial[0] += reach.squaredNorm();
    polynomial[1] += T(2.0) * reach.dot(by);
    polynomial[2] += by.squaredNorm();
    std::vector<double> f(polynomial.size());
    std::transform(polynomial.begin(), polynomial.end(), f.begin(), [](const T& c) { return value_of(c); });
    // a brush that has just loosened has f = 0 at x = 0, and also f' = 0 if g crossed 0: search f/x or f/x^2 instead
    if (loosened != Loosened::before) f.erase(f.begin());
    if (loosened == Loosened::by_crossing) f.erase(f.begin());
    return first_positive(std::move(f));
}

template <class T>
T polish_root(const std::vector<T>& f, double x) {
    T value(0.0), slope(0.0);
    for (std::size_t i = f.size(); i-- > 0;) {
        slope = slope * x + value;
        value = value * x + f[i];
    }
    // one Newton step carries the derivatives of a dual number through the event
    const double s = value_of(slope);
    if (!(s > 0.0)) return T(x);
    const T root = T(x) - value / slope;
    return value_of(root) < 0.0 ? T(0.0) : value_of(root) > 1.0 ? T(1.0) : root;
}

/// A lever shorter than this [mm] counts as no lever.
constexpr double kMinLeverMm = 1e-9;

template <class T, class PhaseSink>
void advance_on_piece(const LawPiece<T>& law, const Move<T>& move, LagState<T>& state, T begin, const T& end,
                      PhaseSink&& phase) {
    Loosened loosened = Loosened::before;
    // a move has at most as many events as its polynomials have roots; the limit only guards against rounding errors
    for (int events = 0; events < 64 && value_of(begin) < value_of(end); ++events) {
        if (state.taut) {
            double t = 2.0;
            if (!stays_taut(law, move, value_of(state.heading.dot(move.along))))
                t = first_loosening(values_of(law), values_of(move), values_of(state), value_of(begin), value_of(end));
            if (t > value_of(begin)) {
                T until = end;
                if (t < value_of(end)) until = T(t);
                phase(law, move, state, begin, until);
                state = state_in_phase(law, move, state, begin, until);
                loosened = Loosened::by_crossing;
                begin = until;
            } else {
                loosened = Loosened::by_jump;
            }
            if (t > value_of(end)) return;
            state.taut = false;
            continue;
        }
        std::vector<T> f;
        const double x = first_tightening(law, move, state, begin, end, loosened, f);
        loosened = Loosened::before;
        T until = end;
        if (x <= 1.0) until = begin + (end - begin) * polish_root(f, x);
        if (value_of(until) > value_of(begin)) phase(law, move, state, begin, until);
        state = state_in_phase(law, move, state, begin, until);
        begin = until;
        if (x > 1.0) return;
        state.taut = true;
        const T lever = law.at(move.depth(until));
        // A brush without a lever is dragged as soon as it moves. The heading from its contact to the TCP would be a
        // rounding error.
        if (value_of(lever) < kMinLeverMm && move.length > T(0.0)) {
            state.heading = move.along;
            state.heading_known = true;
        }
        state.contact = move.tcp(until) - lever * state.heading;
    }
    if (value_of(begin) < value_of(end)) {
        phase(law, move, state, begin, end);
        state = state_in_phase(law, move, state, begin, end);
    }
}

}  // namespace detail

template <class T, class PhaseSink>
void advance(const LagLaw<T>& law, const Move<T>& move, LagState<T>& state, PhaseSink&& phase) {
    if (law.rigid) {
        // a pen: p = q, the heading is the direction of motion
        if (move.length > T(0.0)) {
            state.heading = move.along;
            state.heading_known = true;
        }
        state.taut = true;
        state.contact = move.from;
        phase(law.pieces.front(), move, state, T(0.0), T(1.0));
        state.contact = move.from + move.by;
        return;
    }
    const double d0 = value_of(move.depth_from), dd = value_of(move.depth_by);
    if (law.pieces.size() == 1) {
        const LawPiece<T>& piece = law.pieces.front();
        if (state.taut && detail::stays_taut(piece, move, value_of(state.heading.dot(move.along)))) {
            phase(piece, move, state, T(0.0), T(1.0));
            detail::drag(piece, move, T(0.0), T(1.0), state);
        } else {
            detail::advance_on_piece(piece, move, state, T(0.0), T(1.0), phase);
        }
        return;
    }
    double begin = 0.0;
    while (begin < 1.0) {
        // the depth at a joint of two pieces belongs to the piece that the move enters
        const double depth = d0 + dd * begin;
        std::size_t i = 0;
        while (i + 1 < law.pieces.size() &&
               (dd >= 0.0 ? depth >= law.pieces[i].hi - 1e-12 : depth > law.pieces[i].hi + 1e-12))
            ++i;
        const LawPiece<T>& piece = law.pieces[i];
        double end = 1.0;
        if (dd > 0.0 && i + 1 < law.pieces.size()) end = std::min(1.0, (piece.hi - d0) / dd);
        if (dd < 0.0 && i > 0) end = std::min(1.0, (piece.lo - d0) / dd);
        if (!(end > begin)) end = 1.0;
        detail::advance_on_piece(piece, move, state, T(begin), T(end), phase);
        begin = end;
    }
}

}  // namespace brushsvg
