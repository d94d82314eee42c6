#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <type_traits>
#include <vector>

#include "brushsvg/brush_law.hpp"

// The model of the brush's lag: how the contact patch trails the TCP.
//
// All functions are templates on the scalar type T. T is double, or a dual number with its value in a member `a` and
// its derivatives in `v`, such as a solver's jet. Lengths are in mm, angles in radians, positions in the plane of the
// paper.
namespace [[gnu::visibility("default")]] brushsvg {

template <class T>
using Vec2 = Eigen::Matrix<T, 2, 1>;

/// Return the value of a scalar without its derivatives.
inline double value_of(double x) { return x; }
template <class Jet>
auto value_of(const Jet& x) -> decltype(x.a) {
    return x.a;
}

/// One polynomial piece of a lever law.
///
/// It gives the lever's length r [mm] against the depth d [mm] on [lo, hi]. The other members are needed by the
/// quadrature of 1/r and by the search for events.
template <class T>
struct LawPiece {
    double lo = 0.0, hi = 0.0;
    int degree = 0;
    std::array<T, kMaxLawDegree + 1> coefficients{};  ///< in ascending powers of d
    std::vector<std::complex<double>> roots;          ///< all complex roots of the polynomial
    double root_distance2 = 0.0;                      ///< squared distance of the nearest root from [lo, hi] [mm^2]
    double max_slope = 0.0;                           ///< upper bound of |dr/dd| on [lo, hi]
    double max_third_derivative = 0.0;                ///< upper bound of |d3r/dd3| on [lo, hi]

    T at(const T& depth) const {
        std::size_t i = std::size_t(degree);
        T r = coefficients[i];
        if constexpr (std::is_arithmetic_v<T>) {
            while (i-- > 0) r = r * depth + coefficients[i];
        } else {  // apply the chain rule once, not at every power
            const double x = value_of(depth);
            double by_depth = 0.0;
            while (i-- > 0) {
                by_depth = by_depth * x + value_of(r);
                r = r * x + coefficients[i];
            }
            r.v += by_depth * depth.v;
        }
        return r;
    }
    T slope(const T& depth) const {
        T r(0.0);
        for (std::size_t i = std::size_t(degree); i > 0; --i) r = r * depth + double(i) * coefficients[i];
        return r;
    }
    T curvature(const T& depth) const {
        T r(0.0);
        for (std::size_t i = std::size_t(degree); i > 1; --i)
            r = r * depth + double(i) * double(i - 1) * coefficients[i];
        return r;
    }
};

/// A lever law r(d) >= 0 [mm] over a range of depths d [mm], in polynomial pieces.
template <class T>
struct LagLaw {
    std::vector<LawPiece<T>> pieces;
    bool rigid = false;  ///< true for a pen: r is 0 at all depths

    const LawPiece<T>& piece(double depth) const {
        for (std::size_t i = 0; i + 1 < pieces.size(); ++i)
            if (depth < pieces[i].hi) return pieces[i];
        return pieces.back();
    }
    T at(const T& depth) const { return piece(value_of(depth)).at(depth); }
};

/// Make a law from polynomial pieces in ascending order of depth.
///
/// `sign`: -1 for a lever that points the other way. Throws Error if there are no pieces, if a coefficient is not
/// finite, or if a degree exceeds kMaxLawDegree.
LagLaw<double> make_law(const std::vector<PolynomialPiece>& pieces, double sign = 1.0);

/// Return the exponent of article (7): the integral of ds / r over a straight move.
///
/// The depth is linear along the move, so the exponent is length * mean(1/r). `depth0`, `depth1`: depths [mm] at its
/// ends. `length`: its length on the paper [mm]. `splits_left`: how many more times the move may be split in half.
///
/// The distance of the nearest complex root of r from the depths of the move selects the rule, or a split. The error of
/// n nodes is about rho^(-2n) on the Bernstein ellipse, so the result is accurate to 1e-13.
///
/// The exponent grows without bound as r approaches 0. From 50 on, the heading equals the direction of motion, and the
/// summation stops.
template <class T>
T lag_exponent(const LawPiece<T>& law, const T& depth0, const T& depth1, const T& length, int splits_left = 48);

/// Return the heading after the patch was dragged straight:
///     tan(psi1/2) = E tan(psi0/2),  psi = angle from the direction of motion to the heading.
/// This is article (7) in vector form.
///
/// `heading`: unit vector from the contact to the TCP before the move. `along`: unit direction of motion. `decay`:
/// E = exp(-integral ds/r), see lag_exponent(). The result has unit length, even if rounding has changed the length of
/// the given heading.
template <class T>
Vec2<T> drag_heading(const Vec2<T>& heading, const Vec2<T>& along, const T& decay);

/// Return beta of article (11) and (12) [rad].
///
/// beta is the angle from the direction of motion to the tip's displacement. `alpha0`, `alpha1`: angles [rad] from the
/// direction of motion to the heading, before and after the move. `s`: length of the move [mm].
///
/// The lag is constant and 0 < alpha0 <= pi/2. The result is in (0, pi). Beyond pi/2 the patch rests at first, so
/// neither equation holds.
template <class T>
T tip_direction(const T& alpha0, const T& alpha1, const T& s, const T& lag_mm, const T& tip_gap_mm) {
    using std::atan2;
    using std::cos;
    using std::sin;
    const T reach = lag_mm + tip_gap_mm;
    return atan2(reach * (sin(alpha0) - sin(alpha1)), s - reach * (cos(alpha1) - cos(alpha0)));
}

/// The state of a brush that touches the paper.
///
/// With the TCP, which the move provides, the state is (contact, TCP, last heading). The angle psi alone would not be
/// enough.
template <class T>
struct LagState {
    Vec2<T> contact = Vec2<T>::Zero();          ///< p, the contact [mm]
    Vec2<T> heading = Vec2<T>(T(1.0), T(0.0));  ///< u, unit vector from p to q
    bool taut = false;
    bool heading_known = false;  ///< false from touch-down to the first motion
};

/// A straight move of the TCP. Position and depth are linear in t from 0 to 1. All depths are >= 0.
template <class T>
struct Move {
    Vec2<T> from, by, along;         ///< start [mm], displacement [mm], unit direction (the x axis for a move in place)
    T length, depth_from, depth_by;  ///< length on the paper, depth at the start and its change along the move [mm]

    Move(const Vec2<T>& q0, const Vec2<T>& q1, const T& d0, const T& d1)
        : from(q0), by(q1 - q0), depth_from(d0), depth_by(d1 - d0) {
        using std::sqrt;
        const T squared = by.squaredNorm();
        length = squared > T(0.0) ? sqrt(squared) : T(0.0);
        along = length > T(0.0) ? Vec2<T>(by / length) : Vec2<T>(T(1.0), T(0.0));
    }
    Vec2<T> tcp(const T& t) const { return from + by * t; }
    const Vec2<T>& direction(const T&) const { return along; }
    T depth(const T& t) const { return depth_from + depth_by * t; }
};

/// Return the state at `t` of a phase without events.
///
/// `start`: the state at t = `begin`, where the phase begins.
template <class T>
LagState<T> state_in_phase(const LawPiece<T>& law, const Move<T>& move, const LagState<T>& start, const T& begin,
                           const T& t);

/// Advance the state over one move, phase by phase.
///
/// A phase is a stretch without events, in which one rule holds:
/// * Taut: the lever drags the patch, which never slips sideways (article (4), (7)). The phase ends where the next step
///   would push the patch backwards: g = cos(psi) - dr/ds < 0.
/// * Loose: the patch rests and the heading points from the patch to the TCP (article 2.2). The phase ends where
///   f = |q - p| - r rises through 0.
///
/// `state`: the state at the start of the move; receives the state at its end. `phase(law, move, start, begin, end)` is
/// called for every phase, with the state at its beginning; `start.taut` shows which rule holds.
template <class T, class PhaseSink>
void advance(const LagLaw<T>& law, const Move<T>& move, LagState<T>& state, PhaseSink&& phase);

template <class T>
void advance(const LagLaw<T>& law, const Move<T>& move, LagState<T>& state) {
    advance(law, move, state, [](const auto&, const auto&, const auto&, const T&, const T&) {});
}

/// Return the state of a brush that touches the paper at the TCP q.
///
/// p = q, because the lever is not drawn out yet.
template <class T>
LagState<T> touch_down(const Vec2<T>& tcp) {
    LagState<T> state;
    state.contact = tcp;
    return state;
}

}  // namespace brushsvg

#include "brushsvg/taut_and_loose.hpp"
