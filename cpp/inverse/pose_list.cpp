#include "inverse/pose_list.hpp"

#include <cmath>

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Least turn of an arc [rad]. For a lag of 20 mm, the chord of an arc this short is 0.001 mm off. Three rounded points
/// of a shorter arc may be on one line.
constexpr double kMinArcRad = 0.02;
/// Poses nearer than this [mm] are merged: the way between them is only rounding, and its direction is random.
constexpr double kMinPoseDistanceMm = 1e-3;

}  // namespace

void PoseList::add(const Vector2d& tcp_mm, double depth_mm) {
    const std::array<double, 3> pose{tcp_mm.x(), tcp_mm.y(), depth_mm > 0.0 ? -depth_mm : 0.0};
    if (!poses_.empty()) {
        const auto& last = poses_.back();
        const double way = std::hypot(pose[0] - last[0], pose[1] - last[1], pose[2] - last[2]);
        if (way < kMinPoseDistanceMm) return;
    }
    poses_.push_back(pose);
}

void PoseList::arc(std::int64_t first, const Vector2d& centre_mm, double angle_rad) {
    const auto radius_at = [&](std::int64_t i) { return (Vector2d(poses_[i][0], poses_[i][1]) - centre_mm).norm(); };
    const double radius_mm = radius_at(first);
    if (std::abs(angle_rad) < kMinArcRad || radius_mm < 2.0 * kArcRadiusRangeMm[0]) return;
    for (std::int64_t i = first + 1; i <= last(); ++i)
        if (std::abs(radius_at(i) - radius_mm) > kCircleToleranceMm || poses_[i][2] != poses_[first][2]) return;
    const Arc arc{first, last(), centre_mm, angle_rad > 0.0 ? 1 : -1};
    if (!arcs_.empty() && arcs_.back().last == first && arcs_.back().direction == arc.direction &&
        (arcs_.back().centre_mm - centre_mm).norm() < kCircleToleranceMm)
        arcs_.back().last = arc.last;
    else
        arcs_.push_back(arc);
}

void PoseList::write_to(Pass& pass) const {
    pass.poses_mm.resize(Index(poses_.size()), 3);
    for (Index i = 0; i < pass.poses_mm.rows(); ++i) pass.poses_mm.row(i) << poses_[i][0], poses_[i][1], poses_[i][2];
    pass.arcs = arcs_;
}

}  // namespace brushsvg
