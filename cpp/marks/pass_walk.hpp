#pragma once

#include <Eigen/Core>
#include <vector>

#include "brushsvg/lag.hpp"
#include "brushsvg/lag_arc.hpp"
#include "brushsvg/plan.hpp"

namespace brushsvg {

/// A straight stretch of the TCP's path, part of it above the paper. Depths below 0 are heights.
template <class T>
struct AboveStretch {
    Vec2<T> from, to;
    T depth_from, depth_to;
};

/// The TCP's path as it is commanded in a pass. deeper_mm: how much deeper than -z the brush is pressed.
template <class T>
struct CommandedPath {
    const Poses& poses;
    const std::vector<Arc>& arcs;
    T deeper_mm;

    Eigen::Index count() const { return poses.rows(); }
    Vec2<T> tcp(Eigen::Index i) const { return poses.row(i).head<2>().transpose().template cast<T>(); }
    T depth(Eigen::Index i) const { return T(deeper_mm - poses(i, 2)); }
    /// Return by how much the tool turns on this arc from pose i to the next [rad].
    T turn(const Arc& arc, Eigen::Index i) const {
        return T(turn_between(arc, poses.row(i).head<2>().transpose(), poses.row(i + 1).head<2>().transpose()));
    }
};

/// Walk along the TCP's path of a pass, stretch by stretch, with any scalar type: above the paper, set down, or on the
/// paper. Way: a CommandedPath, or another type with places, depths and arcs. `i` is the pose before a stretch. Shares
/// refer to the move from there to the next pose. These functions are called:
///
///     to.above(i, stretch, end, touches)  above the paper, up to `end` of the move; whether it is set down there
///     to.touch(i, at, tcp)                set down
///     to.move(motion, i, begin, end)      on the paper: a Move, or an ArcMove
///     to.is_done()                        whether to stop
///
/// A pass that begins below the paper's surface is set down on the spot, and a pass that ends there is lifted on the
/// spot. These moves have shares from 0 to 0.
template <class T, class Way, class To>
void walk_pass(const Way& way, To& to) {
    using Index = Eigen::Index;
    const Index last = way.count() - 1;
    const T none(0.0), whole(1.0);
    if (const T depth = way.depth(0); value_of(depth) >= 0.0) {
        to.touch(0, none, way.tcp(0));
        if (value_of(depth) > 0.0) to.move(Move<T>(way.tcp(0), way.tcp(0), none, depth), 0, none, none);
    }
    auto arc = way.arcs.begin();
    for (Index i = 0; i < last && !to.is_done(); ++i) {
        while (arc != way.arcs.end() && arc->last <= i) ++arc;
        const Vec2<T> a = way.tcp(i), b = way.tcp(i + 1);
        const T da = way.depth(i), db = way.depth(i + 1);
        const bool on_paper = value_of(da) >= 0.0, stays = value_of(db) >= 0.0;
        if (on_paper && stays) {
            if (arc != way.arcs.end() && arc->first <= i)
                to.move(arc_between<T>(a, b, way.turn(*arc, i), da), i, none, whole);
            else
                to.move(Move<T>(a, b, da, db), i, none, whole);
        } else if (!on_paper && !stays) {
            to.above(i, AboveStretch<T>{a, b, da, db}, whole, false);
        } else {
            const T crossing = da / (da - db);
            const Vec2<T> c = a + crossing * (b - a);
            if (stays) {
                to.above(i, AboveStretch<T>{a, b, da, db}, crossing, true);
                to.touch(i, crossing, c);
                if (value_of(db) > 0.0) to.move(Move<T>(c, b, none, db), i, crossing, whole);
            } else {
                if (value_of(crossing) > 0.0) to.move(Move<T>(a, c, da, none), i, none, crossing);
                to.above(i, AboveStretch<T>{a, b, da, db}, whole, false);
            }
        }
    }
    if (const T depth = way.depth(last); !to.is_done() && value_of(depth) > 0.0)
        to.move(Move<T>(way.tcp(last), way.tcp(last), depth, none), last, none, none);
}

}  // namespace brushsvg
