#pragma once

#include <vector>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/lag.hpp"
#include "brushsvg/plan.hpp"
#include "marks/pass_walk.hpp"

// Traces the patch at chosen places of a pass, for any scalar type, so that a solver can differentiate the simulator.
namespace brushsvg::fit {

/// The patch at one place. If not `down`, the brush is in the air and the other values have no meaning.
template <class T>
struct Trace {
    bool down;
    T depth;
    Vec2<T> tcp;
    LagState<T> state;
};

/// Returns the law of these coefficients (ascending), with the bounds that events need from their values.
template <class T>
LagLaw<T> law_of(const std::vector<T>& coefficients, double lo, double hi) {
    std::vector<double> values;
    for (const T& c : coefficients) values.push_back(value_of(c));
    const LagLaw<double> plain = make_law({{lo, hi, values}});
    const LawPiece<double>& from = plain.pieces.front();
    LawPiece<T> piece;
    piece.lo = lo;
    piece.hi = hi;
    piece.degree = int(coefficients.size()) - 1;
    std::copy(coefficients.begin(), coefficients.end(), piece.coefficients.begin());
    piece.roots = from.roots;
    piece.root_distance2 = from.root_distance2;
    piece.max_slope = from.max_slope;
    piece.max_third_derivative = from.max_third_derivative;
    return {{piece}, plain.rigid};
}

/// Walks a pass and reports the state of the patch at some of its places.
template <class T, class Out>
class TraceAt {
 public:
    /// at: ascending indices of poses, fractional between poses.
    TraceAt(const LagLaw<T>& law, const std::vector<double>& at, Out& out) : law_(law), at_(at), out_(out) {}

    bool is_done() const { return k_ >= at_.size(); }
    void above(Eigen::Index i, const AboveStretch<T>& way, const T& end, bool) {
        const T lower = way.depth_to - way.depth_from;
        for (; !is_done() && here(i) <= value_of(end); ++k_)
            out_(k_, Trace<T>{false, T(way.depth_from + here(i) * lower),
                              Vec2<T>(way.from + here(i) * (way.to - way.from)), state_});
    }
    void touch(Eigen::Index, const T&, const Vec2<T>& tcp) { state_ = touch_down<T>(tcp); }
    template <class Motion>
    void move(const Motion& motion, Eigen::Index i, const T& begin, const T& end) {
        checkpoint();
        if (!is_done() && here(i) < value_of(end)) {
            advance(law_, motion, state_,
                    [&](const auto& piece, const auto& mv, const auto& start, const T& from, const T& until) {
                        for (; !is_done() && here(i) < value_of(end); ++k_) {
                            const T t = (T(here(i)) - begin) / (end - begin);
                            if (value_of(t) > value_of(until)) break;
                            out_(k_, Trace<T>{true, mv.depth(t), mv.tcp(t), state_in_phase(piece, mv, start, from, t)});
                        }
                    });
        } else {
            advance(law_, motion, state_);
        }
        for (; !is_done() && here(i) <= value_of(end); ++k_)
            out_(k_, Trace<T>{true, motion.depth(T(1.0)), motion.tcp(T(1.0)), state_});
    }

 private:
    double here(Eigen::Index i) const { return at_[k_] - double(i); }

    const LagLaw<T>& law_;
    const std::vector<double>& at_;
    Out& out_;
    std::size_t k_ = 0;
    LagState<T> state_;
};

/// Calls out(k, Trace) for every k of `at`: ascending indices of poses, fractional between poses.
///
/// way: a CommandedPath, or a type with the same members. At the first pose, the brush is set down if it is not in the
/// air.
///
/// Derivatives pass through events. Where bristles tighten and where they touch, the derivative of the moment is used.
/// Where bristles loosen, the patch does not move, so that the moment does not matter.
template <class T, class Way, class Out>
void trace(const LagLaw<T>& law, const Way& way, const std::vector<double>& at, Out&& out) {
    TraceAt<T, Out> to(law, at, out);
    walk_pass<T>(way, to);
}

}  // namespace brushsvg::fit
