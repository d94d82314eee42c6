#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <type_traits>
#include <vector>

#include "brushsvg/profile.hpp"

// How the contact patch trails the handle. Everything is a template on the scalar T: double, or a dual number with
// the value in a member `a` and derivatives in `v` (a solver's jet). Angles in radians, lengths in mm.
namespace [[gnu::visibility("default")]] brushsvg {

template <class T>
using Vec2 = Eigen::Matrix<T, 2, 1>;

inline double value_of(double x) { return x; }
template <class Jet>
auto value_of(const Jet& x) -> decltype(x.a) {
    return x.a;
}

/// A lever's length against depth on [lo, hi], a polynomial, with what the quadrature of its reciprocal and the
/// search for events need to know of it.
template <class T>
struct LawPiece {
    double lo = 0.0, hi = 0.0;
    int degree = 0;
    std::array<T, kMaxLawDegree + 1> coefficients{};
    std::vector<std::complex<double>> roots;  ///< of the polynomial, all of them
    double clear2 = 0.0;                      ///< squared distance of the nearest root from [lo, hi]
    double steepest = 0.0;                    ///< bound of |dr/dd| on [lo, hi]
    double most_twisted = 0.0;                ///< bound of |d3r/dd3| on [lo, hi]

    T at(const T& depth) const {
        std::size_t i = std::size_t(degree);
        T r = coefficients[i];
        if constexpr (std::is_arithmetic_v<T>) {
            while (i-- > 0) r = r * depth + coefficients[i];
        } else {  // the chain rule once, not at every power
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

/// A lever r(d) >= 0 over a range of depths.
template <class T>
struct LagLaw {
    std::vector<LawPiece<T>> pieces;
    bool rigid = false;  ///< r identically 0

    const LawPiece<T>& piece(double depth) const {
        for (std::size_t i = 0; i + 1 < pieces.size(); ++i)
            if (depth < pieces[i].hi) return pieces[i];
        return pieces.back();
    }
    T at(const T& depth) const { return piece(value_of(depth)).at(depth); }
};

/// Law from polynomial pieces; `sign` -1 turns a lever that points the other way.
LagLaw<double> make_law(const std::vector<PolynomialPiece>& pieces, double sign = 1.0);

/// Integral of ds / r over a straight move of `length` [mm] with depth linear along it: length * mean(1/r), the
/// exponent of article (7). The rule, or a split of the move, is chosen by the distance of the nearest complex root of
/// r from the depths passed (error of n nodes ~ rho^(-2n) on the Bernstein ellipse), so that it is good to 1e-13.
/// Grows without bound where r -> 0: from 50 on the heading is the direction of motion, and it stops counting.
template <class T>
T lag_exponent(const LawPiece<T>& law, const T& depth0, const T& depth1, const T& length, int splits_left = 48);

/// Heading after the decay E = exp(-integral ds/r) of a drag in direction `along` (article (7), in vector form):
///     tan(psi1/2) = E tan(psi0/2),  psi = angle from the direction of motion to the heading.
/// The result has unit length for any rounding of the given heading.
template <class T>
Vec2<T> drag_heading(const Vec2<T>& heading, const Vec2<T>& along, const T& decay);

/// beta, article (11) and (12): direction of the tip's displacement against the direction of motion, for constant lag,
/// from 0 < alpha0 <= pi/2 to alpha1 over s [mm]: in (0, pi). Beyond pi/2 the patch rests at first: neither holds.
template <class T>
T tip_direction(const T& alpha0, const T& alpha1, const T& s, const T& lag_mm, const T& tip_gap_mm) {
    using std::atan2;
    using std::cos;
    using std::sin;
    const T reach = lag_mm + tip_gap_mm;
    return atan2(reach * (sin(alpha0) - sin(alpha1)), s - reach * (cos(alpha1) - cos(alpha0)));
}

/// The brush on the paper. The state is (contact, tcp, last heading), never psi alone.
template <class T>
struct LagState {
    Vec2<T> contact = Vec2<T>::Zero();          ///< p [mm]
    Vec2<T> heading = Vec2<T>(T(1.0), T(0.0));  ///< u, unit vector from p to q
    bool taut = false;
    bool heading_known = false;  ///< false from touch-down to the first motion
};

/// A straight move of the TCP: position and depth linear in t from 0 to 1. All depths >= 0.
template <class T>
struct Move {
    Vec2<T> from, by, along;  ///< start, displacement, unit direction (x axis for a move in place)
    T length, depth_from, depth_by;

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

/// State at t of an event-free phase that began in state `start` at t = begin.
template <class T>
LagState<T> within_phase(const LawPiece<T>& law, const Move<T>& move, const LagState<T>& start, const T& begin,
                         const T& t);

/// Carries the state over one move, phase by phase. `phase(law, move, start, begin, end)` is called for every
/// event-free stretch with the state at its beginning; `start.taut` shows which rule holds in it.
///
/// Taut: the lever drags the patch, which never slips sideways (article (4), (7)), until moving on would push it
/// backwards: g = cos(psi) - dr/ds < 0. Loose: the patch rests and the heading points from it to the TCP (article 2.2),
/// until f = |q - p| - r comes up through 0.
template <class T, class PhaseSink>
void advance(const LagLaw<T>& law, const Move<T>& move, LagState<T>& state, PhaseSink&& phase);

template <class T>
void advance(const LagLaw<T>& law, const Move<T>& move, LagState<T>& state) {
    advance(law, move, state, [](const auto&, const auto&, const auto&, const T&, const T&) {});
}

/// The brush meets the paper at q: p = q, nothing drawn out yet.
template <class T>
LagState<T> touch_down(const Vec2<T>& tcp) {
    LagState<T> state;
    state.contact = tcp;
    return state;
}

}  // namespace brushsvg

#include "brushsvg/lag_impl.hpp"
