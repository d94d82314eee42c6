#include "marks_way.hpp"

#include <algorithm>
#include <cmath>

#include "brushsvg/error.hpp"

namespace brushsvg {

using Eigen::Index;

ManyWays way_of(const Pass& pass, const PassMarks& marks) {
    refuse_tilted(pass, "other lags are followed on the way of a brush held upright");
    const Index rows = Index(marks.pose.size()), poses = pass.poses_mm.rows();
    if (marks.tcp_mm.rows() != rows || Index(marks.depth_mm.size()) != rows)
        throw Error("sizes-differ", "rows of marks are not parallel", marks.stroke);
    ManyWays way;
    way.x_mm = marks.tcp_mm.col(0).array();
    way.y_mm = marks.tcp_mm.col(1).array();
    way.depth_mm = Eigen::Map<const Eigen::ArrayXd>(marks.depth_mm.data(), rows);
    if (pass.arcs.empty() || rows == 0) return way;
    way.turn_rad = Lanes::Zero(rows - 1, 1);
    auto arc = pass.arcs.begin();
    for (Index i = 0; i + 1 < rows; ++i) {
        const double from = marks.pose[std::size_t(i)], to = marks.pose[std::size_t(i) + 1];
        if (!(from >= 0.0 && from <= to && to <= double(poses - 1)))
            throw Error("not-ascending", "rows of marks do not follow the poses of the pass", marks.stroke, to);
        const Index pose = std::min(Index(from), poses - 2);
        while (arc != pass.arcs.end() && arc->last <= pose) ++arc;
        if (arc == pass.arcs.end() || arc->first > pose || from == to || marks.depth_mm[std::size_t(i)] < 0.0) continue;
        const Eigen::Vector2d a = pass.poses_mm.row(pose).head<2>(), b = pass.poses_mm.row(pose + 1).head<2>();
        way.turn_rad(i, 0) = (to - from) * turn_between(*arc, a, b);
    }
    return way;
}

}  // namespace brushsvg
