#include "marks/follow_lag.hpp"

#include <algorithm>
#include <array>

#include "base/format_text.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "marks/pass_walk.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;

constexpr double kDepthRoundingMm = 1e-9;  ///< rounding of depths
constexpr double kPoseRounding = 1e-9;     ///< rounding of shares of a move

/// The TCP's motion for walk_pass(), with the rows of marks as its poses.
struct RowMotion {
    const PassMarks& marks;
    std::vector<Arc> arcs;         ///< one for each move from a row to the next along an arc
    std::vector<double> turn_rad;  ///< turn of the TCP's path from each row to the next

    RowMotion(const Pass& pass, const PassMarks& of) : marks(of), turn_rad(of.pose.size(), 0.0) {
        if (pass.arcs.empty()) return;
        auto arc = pass.arcs.begin();
        const double last = double(pass.poses_mm.rows() - 1) + kPoseRounding;
        for (Index i = 0; i + 1 < count(); ++i) {
            const double from = marks.pose[std::size_t(i)], to = marks.pose[std::size_t(i) + 1];
            if (!(from >= 0.0 && from <= to + kPoseRounding && to <= last))
                throw Error("not-ascending",
                            "the rows of the marks do not belong to the poses of the pass: simulate this pass",
                            marks.stroke, to);
            const Index pose = std::min(Index(from + kPoseRounding), pass.poses_mm.rows() - 2);
            while (arc != pass.arcs.end() && arc->last <= pose) ++arc;
            if (arc == pass.arcs.end() || arc->first > pose || from >= to || tcp(i) == tcp(i + 1)) continue;
            const Eigen::Vector2d a = pass.poses_mm.row(pose).head<2>(), b = pass.poses_mm.row(pose + 1).head<2>();
            turn_rad[std::size_t(i)] = (to - from) * turn_between(*arc, a, b);
            if (turn_rad[std::size_t(i)] != 0.0) arcs.push_back({i, i + 1, arc->centre_mm, arc->direction});
        }
    }

    Index count() const { return Index(marks.pose.size()); }
    Vec2<double> tcp(Index i) const { return marks.tcp_mm.row(i); }
    double depth(Index i) const { return marks.depth_mm[std::size_t(i)]; }
    double turn(const Arc&, Index i) const { return turn_rad[std::size_t(i)]; }
};

/// Moves the patch along a path; walk_pass() calls it.
class Follower {
 public:
    Follower(const LagLaw<double>& law, Index rows) : law_(law), out_{Ring(rows, 2), Ring(rows, 2)} {}

    void above(Index i, const AboveStretch<double>& stretch, double, bool touches) {
        if (!touches) lift(i + 1, stretch.to);
    }
    void touch(Index i, double at, const Vec2<double>& tcp) {
        const Vec2<double> heading = state_.heading;
        state_ = touch_down<double>(tcp);
        state_.heading = heading;
        const Index row = at > 0.0 ? i + 1 : i;
        if (moved_once_) first_waiting_ = row;
        moved_ = false;
        put(row);
    }
    template <class Motion>
    void move(const Motion& motion, Index i, double, double end) {
        advance(law_, motion, state_);
        put(end > 0.0 ? i + 1 : i);
    }
    void lift(Index row, const Vec2<double>& tcp) {
        state_.contact = tcp;
        put(row);
    }
    bool is_done() const { return false; }
    const FollowedRows& rows() const { return out_; }

 private:
    void put(Index row) {
        checkpoint();
        out_.contact_mm.row(row) = state_.contact;
        out_.heading.row(row) = state_.heading;
        if (moved_ || !(state_.heading_known || (state_.taut && !law_.rigid))) return;
        for (Index k = first_waiting_; k < row; ++k) out_.heading.row(k) = state_.heading;
        moved_ = moved_once_ = true;
    }

    const LagLaw<double>& law_;
    FollowedRows out_;
    LagState<double> state_;
    Index first_waiting_ = 0;  ///< first of the rows that wait for a heading
    bool moved_ = false, moved_once_ = false;
};

void require_usable_rows(const Pass& pass, const PassMarks& marks, const LagLaw<double>& lag) {
    refuse_tilted(pass, "only passes of an upright brush can be followed with another lag");
    const std::size_t rows = marks.pose.size();
    if (std::size_t(marks.tcp_mm.rows()) != rows || marks.depth_mm.size() != rows)
        throw Error("sizes-differ", "the columns of the marks differ in length, but each needs one entry per row",
                    marks.stroke);
    const double hi = lag.pieces.back().hi;
    for (const double depth : marks.depth_mm) {
        if (depth <= hi + kDepthRoundingMm) continue;
        throw Error("depth-out-of-range",
                    format_text("depth %.3f mm is outside the range [0, %.1f] mm of the lag", depth, hi), marks.stroke,
                    depth, std::array<double, 2>{0.0, hi});
    }
}

}  // namespace

FollowedRows follow_lag(const Pass& pass, const PassMarks& marks, const LagLaw<double>& lag) {
    require_usable_rows(pass, marks, lag);
    const RowMotion motion(pass, marks);
    Follower follower(lag, motion.count());
    if (motion.count() == 0) return follower.rows();
    if (motion.depth(0) < 0.0) follower.lift(0, motion.tcp(0));
    walk_pass<double>(motion, follower);
    return follower.rows();
}

}  // namespace brushsvg
