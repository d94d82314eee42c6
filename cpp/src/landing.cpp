#include "landing.hpp"

#include <algorithm>
#include <cmath>

#include "brushsvg/lag.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// How far inside q = P + r u a lift stays: 0 slips on straight moves (0.25 mm from depth 10), much more lets the patch
/// relax towards its pressed shape.
constexpr double kLiftSlackMm = 0.05;
/// How far from there straight moves may stray: not so far that the patch slips, or relaxes.
constexpr double kLiftBandMm = 0.8 * kLiftSlackMm;
/// Steps of the depth, 128 in all, in which a lift comes as far inside: sooner it would need a move of its own.
constexpr double kLiftEases = 8.0;
/// An arc turns the heading by no less: smaller ones say no more than their chord.
constexpr double kLeastArcRad = 1e-3;
/// Poses nearer than this are one: the way between them is rounding, and points anywhere.
constexpr double kSamePoseMm = 1e-6;

/// While the TCP runs up from P to P + r u the patch rests as long as r(d)/d falls with depth; else press down first.
bool may_press_while_running(const Brush& brush, double depth) {
    const double reach = brush.lag(depth);
    for (int i = 1; i < 64; ++i) {
        const double t = i / 64.0;
        if (t * reach > brush.lag(t * depth) + 1e-12) return false;
    }
    return true;
}

}  // namespace

void PoseList::add(const Vector2d& tcp_mm, double depth_mm) {
    const std::array<double, 3> pose{tcp_mm.x(), tcp_mm.y(), depth_mm > 0.0 ? -depth_mm : 0.0};
    if (!poses_.empty()) {
        const auto& last = poses_.back();
        const double way = std::hypot(pose[0] - last[0], pose[1] - last[1], pose[2] - last[2]);
        if (way < kSamePoseMm) return;
    }
    poses_.push_back(pose);
}

void PoseList::arc(std::int64_t first, const Vector2d& centre_mm, double angle_rad) {
    const auto radius_at = [&](std::int64_t i) { return (Vector2d(poses_[i][0], poses_[i][1]) - centre_mm).norm(); };
    const double radius_mm = radius_at(first);
    if (std::abs(angle_rad) < kLeastArcRad || radius_mm < 2.0 * kArcRadiusMm[0]) return;
    for (std::int64_t i = first + 1; i <= last(); ++i)
        if (std::abs(radius_at(i) - radius_mm) > kSameCircleMm || poses_[i][2] != poses_[first][2]) return;
    const Arc arc{first, last(), centre_mm, angle_rad > 0.0 ? 1 : -1};
    if (!arcs_.empty() && arcs_.back().last == first && arcs_.back().direction == arc.direction &&
        (arcs_.back().centre_mm - centre_mm).norm() < kSameCircleMm)
        arcs_.back().last = arc.last;
    else
        arcs_.push_back(arc);
}

void PoseList::into(Pass& pass) const {
    pass.poses_mm.resize(Index(poses_.size()), 3);
    for (Index i = 0; i < pass.poses_mm.rows(); ++i) pass.poses_mm.row(i) << poses_[i][0], poses_[i][1], poses_[i][2];
    pass.arcs = arcs_;
}

void land(const Stance& first, const Brush& brush, PoseList& out) {
    out.add(first.contact_mm, 0.0);
    if (!may_press_while_running(brush, first.depth_mm)) out.add(first.contact_mm, first.depth_mm);
    out.add(first.contact_mm + brush.lag(first.depth_mm) * first.heading, first.depth_mm);
}

void lift(const Stance& last, const Brush& brush, PoseList& out) {
    if (brush.is_rigid()) {
        out.add(last.contact_mm, 0.0);
        return;
    }
    const auto add = [&](double reach_mm, double depth) {
        out.add(last.contact_mm + std::max(0.0, reach_mm) * last.heading, depth);
    };
    const auto reach = [&](double depth) { return brush.lag(depth) - kLiftSlackMm; };
    // straight moves that stay inside the curve, but not far: each as long as some straight line does; the first begins
    // where the brush is taut, and comes inside on its way
    constexpr int n = 128;
    const auto depth_at = [&](int k) { return last.depth_mm * (n - k) / n; };
    int from = 0;
    double at = brush.lag(last.depth_mm);
    while (from < n) {
        double least = -1e300, most = 1e300;
        int to = from;
        double slope = 0.0;
        for (int k = from + 1; k <= n; ++k) {
            const double by = depth_at(from) - depth_at(k), wanted = reach(depth_at(k));
            const double inside = from > 0 ? 1.0 : std::min(1.0, double(k) / kLiftEases);
            least = std::max(least, (wanted - kLiftBandMm - at) / by);
            most = std::min(most, (wanted + kLiftSlackMm - inside * (kLiftSlackMm - kLiftBandMm) - at) / by);
            if (least > most) break;
            slope = 0.5 * (least + most);
            to = k;
        }
        if (to == from) {
            ++to;
            slope = (reach(depth_at(to)) - at) / (depth_at(from) - depth_at(to));
        }
        at += slope * (depth_at(from) - depth_at(to));
        add(at, depth_at(to));
        from = to;
    }
}

}  // namespace brushsvg
