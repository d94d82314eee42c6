#include "squared_end.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "drawn_cut.hpp"
#include "middle_line.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// In half widths: how far it goes back in the end, where it covers what the front of the full width leaves.
constexpr double kBack = 0.8;
/// A stroke shorter than that, in half widths, has no room for an end beside its beginning.
constexpr double kShortest = 2.0;

}  // namespace

std::optional<SquaredEnd> squared_end(const Stroke& stroke, const Brush& brush, Caps caps) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    Stroke out = as_wide_as_painted(stroke, brush);
    const Line line(out, brush);
    const double length_mm = line.length(), half_mm = half_width_at(out, 1.0);
    const auto narrow = half_along_cut_mm(brush, half_mm);
    if (!narrow || length_mm < kShortest * half_mm) return {};
    const Sample last = line.at(length_mm);
    const Vector2d along = line.tangent(last);
    const PathEnd end{last.middle, along, {-along.y(), along.x()}, half_mm};
    const auto cut = cut_of(stroke, end, half_mm - *narrow, caps);
    if (!cut) return {};

    const double ahead_mm = leaves_ahead_mm(*cut, end);
    const Sample leaves = line.at(length_mm + std::min(0.0, ahead_mm));
    const double at = leaves.s / length_mm, leaving_half_mm = half_width_at(out, at);
    out.middle_mm = part_of(out.middle_mm, {0, 0.0}, leaves.place);
    std::vector<std::pair<double, double>> widths;  // by the way [mm]
    for (const WidthKnot& knot : out.half_width)
        if (knot.at < at) widths.emplace_back(knot.at * length_mm, knot.half_width_mm);
    widths.emplace_back(leaves.s, leaving_half_mm);
    const double lever = brush.lever_to_widest(brush.depth_for_half_width(*narrow, stroke.id));
    Vector2d here = leaves.middle;
    double way_mm = leaves.s, reach_mm = std::abs(ahead_mm);
    if (ahead_mm > 0.0) {
        here = end.place(ahead_mm, 0.0);
        append(out.middle_mm, here);
        way_mm += ahead_mm;
        widths.emplace_back(way_mm, leaving_half_mm);
    }
    Cubics way = way_along(*cut, end, here, *narrow, lever);
    append(way, way.row(way.rows() - 1).tail<2>().transpose() - kBack * half_mm * along);
    for (Index i = 0; i < way.rows(); ++i) {
        way_mm += arc_length(way, i, 0.0, 1.0);
        if (widths.back().second > *narrow) widths.emplace_back(way_mm, *narrow);
        reach_mm = std::max(reach_mm, (way.row(i).tail<2>().transpose() - end.at_mm).norm() + lever);
    }
    append_way(out.middle_mm, way);
    out.half_width.clear();
    for (const auto& [s, half] : widths) out.half_width.push_back({s / way_mm, half});
    return SquaredEnd{std::move(out), leaves.middle, end.at_mm, reach_mm};
}

}  // namespace brushsvg
