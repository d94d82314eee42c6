#include "squared_end.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "middle_line.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Width of the mark that runs along the cut, as shares of the stroke's: the finest of them that can be led. Its own
/// corners are as round as it is wide; finer ones leave a hole amid the end.
constexpr double kNarrowest = 0.27, kWidest = 0.6, kShareStep = 0.03;
/// Lever of a mark that is led into a corner: a widest section that hardly leads P swings about.
constexpr double kLeastLeverMm = 0.15;
/// In half widths: how far before the path's end it leaves that where the cut is slanted, and how far it goes back in
/// the end, where it covers what the front of the full width leaves.
constexpr double kLeavesBefore = 0.5, kBack = 0.8;
/// The slope from which on a cut is slanted in full, and the steepest that is a cut: beyond it is a side.
constexpr double kSlanted = 0.6, kSteepest = 1.3;
/// How far from its chord a cut may stray, and within what it is looked for, both in half widths.
constexpr double kStraight = 0.12, kNearest = 0.2, kFarthest = 2.5;
/// A stroke shorter than that, in half widths, has no room for an end beside its beginning.
constexpr double kShortest = 2.0;
/// A corner beyond 90 degrees is taken in two, so many levers apart, or the mark would swing out of it.
constexpr double kChamfer = 0.5;

/// The end of a path: its last point, the direction there and to the left of it, half the width.
struct PathEnd {
    Vector2d at_mm, along, left;
    double half_mm;
    Vector2d place(double ahead_mm, double aside_mm) const { return at_mm + ahead_mm * along + aside_mm * left; }
};

/// A straight cut across an end: ahead of the path's last point by `ahead_mm - slope * aside`.
struct Cut {
    double ahead_mm, slope;
};

/// How far ahead of the end the outline is first left, beside it by so much.
std::optional<double> left_ahead(const Rings& rings, const PathEnd& end, double aside_mm) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Ring& ring : rings)
        for (Index i = 0, n = ring.rows(); i < n; ++i) {
            const Vector2d a = ring.row(i).transpose() - end.at_mm, b = ring.row((i + 1) % n).transpose() - end.at_mm;
            const double ya = a.dot(end.left) - aside_mm, yb = b.dot(end.left) - aside_mm;
            if ((ya > 0.0) == (yb > 0.0)) continue;
            const double x = a.dot(end.along) + (b - a).dot(end.along) * ya / (ya - yb);
            if (x > 0.0) nearest = std::min(nearest, x);
        }
    if (!std::isfinite(nearest)) return {};
    return nearest;
}

std::optional<Cut> cut_of(const Stroke& stroke, const PathEnd& end, double aside_mm) {
    if (stroke.wanted_mm.empty()) return Cut{end.half_mm, 0.0};
    const auto right = left_ahead(stroke.wanted_mm, end, -aside_mm), left = left_ahead(stroke.wanted_mm, end, aside_mm);
    if (!right || !left) return {};
    const Cut cut{0.5 * (*right + *left), 0.5 * (*right - *left) / aside_mm};
    if (std::abs(cut.slope) > kSteepest) return {};
    for (const double share : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        const auto ahead = left_ahead(stroke.wanted_mm, end, share * aside_mm);
        if (!ahead || *ahead < kNearest * end.half_mm || *ahead > kFarthest * end.half_mm ||
            std::abs(*ahead - (cut.ahead_mm - cut.slope * share * aside_mm)) > kStraight * end.half_mm)
            return {};
    }
    return cut;
}

/// Half the width of the mark that runs along the cut.
std::optional<double> narrow_mm(const Brush& brush, double half_mm) {
    for (double share = kNarrowest; share < kWidest + 0.5 * kShareStep; share += kShareStep) {
        if (share * half_mm < brush.half_width_range_mm()[0]) continue;
        const double depth = brush.depth_for_half_width(share * half_mm, "");
        if (brush.lever_to_widest(depth) > kLeastLeverMm) return share * half_mm;
    }
    return {};
}

/// The path up to a place on it.
Cubics up_to(const Cubics& middle_mm, const Place& place) {
    Cubics out = middle_mm.topRows(place.cubic + 1);
    Vector2d p[4];
    for (int i = 0; i < 4; ++i) p[i] = middle_mm.row(place.cubic).segment<2>(2 * i);
    for (int i = 0; i < 4; ++i) {  // de Casteljau: the first of each round
        out.row(place.cubic).segment<2>(2 * i) = p[0];
        for (int k = 0; k + 1 < 4 - i; ++k) p[k] += place.t * (p[k + 1] - p[k]);
    }
    return out;
}

/// Goes on straight to a place.
void append(Cubics& middle_mm, const Vector2d& to) {
    const Index last = middle_mm.rows();
    const Vector2d from = middle_mm.row(last - 1).tail<2>();
    middle_mm.conservativeResize(last + 1, Eigen::NoChange);
    for (int i = 0; i < 4; ++i) middle_mm.row(last).segment<2>(2 * i) = from + i / 3.0 * (to - from);
}

/// Corners of the way beyond the path: the first as a chamfer, which a lever follows.
std::vector<Vector2d> way_along(const Cut& cut, const PathEnd& end, const Vector2d& from, double narrow_mm,
                                double lever_mm) {
    const double steep = std::hypot(1.0, cut.slope), aside = end.half_mm - narrow_mm;
    const double first = cut.slope > 0.0 ? -aside : aside;
    const auto corner = [&](double y) { return end.place(cut.ahead_mm - cut.slope * y - narrow_mm * steep, y); };
    const Vector2d a = corner(first), b = corner(-first);
    const double chamfer = std::min(kChamfer * lever_mm, 0.3 * (b - a).norm());
    return {a - chamfer * (a - from).normalized(), a + chamfer * (b - a).normalized(), b,
            b - kBack * end.half_mm * end.along};
}

}  // namespace

std::optional<SquaredEnd> squared_end(const Stroke& stroke, const Brush& brush) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    Stroke out = stroke;  // what is wider than the brush is painted as wide as that
    const auto [least, greatest] = brush.half_width_range_mm();
    for (WidthKnot& knot : out.half_width) knot.half_width_mm = std::clamp(knot.half_width_mm, least, greatest);
    const Line line(out, brush);
    const double length_mm = line.length(), half_mm = half_width_at(out, 1.0);
    const auto narrow = narrow_mm(brush, half_mm);
    if (!narrow || length_mm < kShortest * half_mm) return {};
    const Sample last = line.at(length_mm);
    const Vector2d along = line.tangent(last);
    const PathEnd end{last.middle, along, {-along.y(), along.x()}, half_mm};
    const auto cut = cut_of(stroke, end, half_mm - *narrow);
    if (!cut) return {};

    const double before_mm = kLeavesBefore * half_mm * std::min(1.0, std::abs(cut->slope) / kSlanted);
    const Sample leaves = line.at(length_mm - before_mm);
    const double at = leaves.s / length_mm, leaving_half_mm = half_width_at(out, at);
    out.middle_mm = up_to(out.middle_mm, leaves.place);
    std::vector<std::pair<double, double>> widths;  // by the way [mm]
    for (const WidthKnot& knot : out.half_width)
        if (knot.at < at) widths.emplace_back(knot.at * length_mm, knot.half_width_mm);
    widths.emplace_back(leaves.s, leaving_half_mm);
    const double lever = brush.lever_to_widest(brush.depth_for_half_width(*narrow, stroke.id));
    Vector2d here = leaves.middle;
    double way_mm = leaves.s, reach_mm = before_mm;
    for (const Vector2d& to : way_along(*cut, end, leaves.middle, *narrow, lever)) {
        append(out.middle_mm, to);
        way_mm += (to - here).norm();
        if (widths.back().second > *narrow) widths.emplace_back(way_mm, *narrow);
        reach_mm = std::max(reach_mm, (to - end.at_mm).norm() + lever);
        here = to;
    }
    out.half_width.clear();
    for (const auto& [s, half] : widths) out.half_width.push_back({s / way_mm, half});
    return SquaredEnd{std::move(out), leaves.middle, end.at_mm, reach_mm};
}

}  // namespace brushsvg
