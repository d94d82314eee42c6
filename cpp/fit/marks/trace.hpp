#pragma once

#include <vector>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/lag.hpp"
#include "brushsvg/plan.hpp"

// What the patch does at chosen places of a pass, on any scalar: the simulator as a solver differentiates it. Arcs of a
// pass are followed on their chords.
namespace brushsvg::fit {

/// The patch at one place. Not `down`: the brush is in the air and the rest says nothing.
template <class T>
struct Trace {
    bool down;
    T depth;
    Vec2<T> tcp;
    LagState<T> state;
};

/// The law of these coefficients (ascending), with what the events need to know of their values.
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
    piece.clear2 = from.clear2;
    piece.steepest = from.steepest;
    piece.most_twisted = from.most_twisted;
    return {{piece}, plain.rigid};
}

/// Calls out(k, Trace) for every k of `at`: poses, fractional in between, ascending.
///
/// deeper_mm: how much deeper than -z the brush is pressed, paper that lies higher than was thought. begun: the state
/// at the first pose; without it the brush is set down there, if it is not in the air.
///
/// Derivatives pass through events: where bristles tighten and where they touch by the moment's own derivative; where
/// they loosen the patch stands still, so that the moment does not matter.
template <class T, class Out>
void trace(const LagLaw<T>& law, const Poses& poses, const T& deeper_mm, const std::vector<double>& at,
           const LagState<T>* begun, Out&& out) {
    const auto q = [&](Eigen::Index i) -> Vec2<T> { return poses.row(i).head<2>().transpose().template cast<T>(); };
    std::size_t k = 0;
    LagState<T> state;
    bool down = begun != nullptr;
    if (begun) state = *begun;
    const T depth0 = deeper_mm - poses(0, 2);
    if (!begun && value_of(depth0) >= 0.0) {
        down = true;
        state = touch_down<T>(q(0));
        if (value_of(depth0) > 0.0) advance(law, Move<T>(q(0), q(0), T(0.0), depth0), state);
    }
    for (; k < at.size() && at[k] <= 0.0; ++k) out(k, Trace<T>{down, depth0, q(0), state});
    for (Eigen::Index i = 0; i + 1 < poses.rows() && k < at.size(); ++i) {
        checkpoint();
        const T d0 = deeper_mm - poses(i, 2), d1 = deeper_mm - poses(i + 1, 2);
        const bool down0 = value_of(d0) >= 0.0, down1 = value_of(d1) >= 0.0;
        const Vec2<T> q0 = q(i), q1 = q(i + 1);
        const T crossing = down0 == down1 ? T(0.0) : T(d0 / (d0 - d1));
        const Vec2<T> qc = q0 + crossing * (q1 - q0);
        const double c = value_of(crossing);
        const auto here = [&] { return at[k] - double(i); };
        if (!down0)  // in the air, up to where it touches
            for (; k < at.size() && here() <= (down1 ? c : 1.0); ++k)
                out(k, Trace<T>{false, T(d0 + here() * (d1 - d0)), Vec2<T>(q0 + here() * (q1 - q0)), state});
        if (down0 || down1) {
            if (!down) state = touch_down<T>(qc);
            down = true;
            const T begin = down0 ? T(0.0) : crossing, end = down1 ? T(1.0) : crossing;
            const Move<T> move(down0 ? q0 : qc, down1 ? q1 : qc, down0 ? d0 : T(0.0), down1 ? d1 : T(0.0));
            const auto within = [&] { return T((T(here()) - begin) / (end - begin)); };
            if (k < at.size() && here() < value_of(end)) {
                advance(law, move, state,
                        [&](const auto& piece, const auto& mv, const auto& start, const T& from, const T& until) {
                            for (; k < at.size() && here() < value_of(end); ++k) {
                                const T t = within();
                                if (value_of(t) > value_of(until)) break;
                                out(k, Trace<T>{true, mv.depth(t), mv.tcp(t), within_phase(piece, mv, start, from, t)});
                            }
                        });
            } else {
                advance(law, move, state);
            }
            for (; k < at.size() && here() <= value_of(end); ++k)
                out(k, Trace<T>{true, move.depth(T(1.0)), move.tcp(T(1.0)), state});
        }
        if (!down1) {
            down = false;
            for (; k < at.size() && here() <= 1.0; ++k)
                out(k, Trace<T>{false, T(d0 + here() * (d1 - d0)), Vec2<T>(q0 + here() * (q1 - q0)), state});
        }
    }
}

}  // namespace brushsvg::fit
