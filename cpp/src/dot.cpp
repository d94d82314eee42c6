#include "dot.hpp"

#include <algorithm>
#include <cmath>

#include "brushsvg/footprint.hpp"
#include "middle_line.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Of a half width: no longer a line is a dot.
constexpr double kLongest = 1.4;
/// Of a half width: a hole about P, where the whole footprint lies ahead of it.
constexpr double kLargestHole = 0.1;
/// What counts as turned round on the spot, and how far P may creep meanwhile.
constexpr double kRoundRad = 6.0, kRestsMm = 0.02;
constexpr int kHalvings = 40;

/// None where the least depth reaches farther already; the greatest where none reaches so far.
std::optional<double> depth_of_reach(const Brush& brush, double half_width_mm) {
    auto [lo, hi] = brush.depth_range_mm;
    lo = std::max(lo, 1e-3);
    if (reach_of_dot_mm(brush, lo) > half_width_mm) return {};
    if (reach_of_dot_mm(brush, hi) <= half_width_mm) return hi;
    for (int i = 0; i < kHalvings; ++i) {
        const double depth = 0.5 * (lo + hi);
        (reach_of_dot_mm(brush, depth) > half_width_mm ? hi : lo) = depth;
    }
    return lo;
}

}  // namespace

double reach_of_dot_mm(const Brush& brush, double depth) {
    const auto at = [&](double d) {
        Ring outline = footprint_at(brush.footprints, d, 1.0);
        outline.col(0).array() -= brush.tip_gap(d);
        return outline.rowwise().norm().maxCoeff();
    };
    double farthest = at(depth);
    for (const Footprint& measured : brush.footprints.dragged)
        if (measured.depth_mm < depth) farthest = std::max(farthest, at(measured.depth_mm));
    return farthest;
}

std::optional<double> depth_of_dot(const Brush& brush, double half_width_mm) {
    const auto depth = depth_of_reach(brush, half_width_mm);
    if (!depth || -brush.tip_gap(*depth) > kLargestHole * half_width_mm) return {};
    return depth;
}

void turn_round(const Vector2d& about_mm, double first_rad, double depth, double reach_mm, PoseList& out) {
    const int n = int(std::ceil(kTurnRad / kTurnChordRad));
    const std::int64_t before = out.last();
    for (int k = 1; k <= n; ++k) {
        const double angle = first_rad + kTurnRad * k / n;
        out.add(about_mm + reach_mm * Vector2d(std::cos(angle), std::sin(angle)), depth);
    }
    out.arc(before, about_mm, kTurnRad);
}

std::optional<Dot> dot_of(const Stroke& stroke, const Brush& brush) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    const double length_mm = Line(stroke, brush).length();
    const double from_half_mm = half_width_at(stroke, 0.0), to_half_mm = half_width_at(stroke, 1.0);
    if (length_mm > kLongest * std::min(from_half_mm, to_half_mm)) return {};
    const auto from = depth_of_dot(brush, from_half_mm), to = depth_of_dot(brush, to_half_mm);
    if (!from || !to) return {};
    const Vector2d a = point_at(stroke.middle_mm, {0, 0.0});
    const Vector2d b = point_at(stroke.middle_mm, {stroke.middle_mm.rows() - 1, 1.0});
    const bool is_point = (b - a).norm() <= 1e-6;
    return Dot{a, b, *from, *to, is_point ? Vector2d(1.0, 0.0) : (b - a).normalized()};
}

Stance turn(const Dot& dot, const Brush& brush, PoseList& out) {
    const double along_rad = std::atan2(dot.heading.y(), dot.heading.x());
    const double first_rad = along_rad - kTurnRad;
    land({dot.from_mm, Vector2d(std::cos(first_rad), std::sin(first_rad)), dot.from_depth_mm}, brush, out);
    turn_round(dot.from_mm, first_rad, dot.from_depth_mm, brush.lag(dot.from_depth_mm), out);
    Vector2d last = dot.heading;
    if ((dot.to_mm - dot.from_mm).norm() > 1e-6) {
        out.add(dot.to_mm + brush.lag(dot.to_depth_mm) * dot.heading, dot.to_depth_mm);
        turn_round(dot.to_mm, along_rad, dot.to_depth_mm, brush.lag(dot.to_depth_mm), out);
        last = {std::cos(along_rad + kTurnRad), std::sin(along_rad + kTurnRad)};
    }
    return {dot.to_mm, last, dot.to_depth_mm};
}

PoseList poses_of(const Dot& dot, const Brush& brush) {
    PoseList out;
    lift(turn(dot, brush, out), brush, out);
    return out;
}

Stance turn_round_ahead(const Stance& before, double depth, const Brush& brush, PoseList& out) {
    const Vector2d &u = before.heading, at = before.contact_mm + brush.lever_to_widest(before.depth_mm) * u;
    out.add(at + brush.lag(depth) * u, depth);
    const double first_rad = std::atan2(u.y(), u.x());
    turn_round(at, first_rad, depth, brush.lag(depth), out);
    const double last_rad = first_rad + kTurnRad;
    return {at, {std::cos(last_rad), std::sin(last_rad)}, depth};
}

std::vector<Turned> turned_round(const PassMarks& marks) {
    std::vector<Turned> found;
    double turned = 0.0, most = 0.0;
    std::size_t from = 0;
    for (std::size_t i = 1; i < marks.depth_mm.size(); ++i) {
        const bool rests = marks.depth_mm[i] > 0.0 && marks.depth_mm[i - 1] > 0.0 &&
                           (marks.contact_mm.row(Index(i)) - marks.contact_mm.row(Index(from))).norm() < kRestsMm;
        if (!rests) {
            from = i;
            turned = most = 0.0;
            continue;
        }
        turned += std::remainder(marks.heading_rad[i] - marks.heading_rad[i - 1], 2.0 * EIGEN_PI);
        if (!(std::abs(turned) > std::max(most, kRoundRad))) continue;
        if (most > 0.0)
            found.back().last = i;
        else
            found.push_back({from, i});
        most = std::abs(turned);
    }
    return found;
}

}  // namespace brushsvg
