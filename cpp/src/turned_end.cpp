#include "turned_end.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "dot.hpp"
#include "drawn_cut.hpp"
#include "middle_line.hpp"

namespace brushsvg {

using Eigen::Vector2d;

std::optional<TurnedEnd> turned_end(const Stroke& stroke, const Brush& brush) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    Stroke out = as_wide_as_painted(stroke, brush);
    const Line line(out, brush);
    const double length_mm = line.length(), half_mm = half_width_at(out, 1.0);
    if (!(length_mm > 0.0)) return {};
    const Sample last = line.at(length_mm);
    const Vector2d along = line.tangent(last);
    const auto cap = cap_of(stroke, {last.middle, along, {-along.y(), along.x()}, half_mm});
    if (!cap) return {};
    const auto depth = depth_of_dot(brush, cap->radius_mm);
    if (!depth || *depth >= last.depth || !(brush.lever_to_widest(last.depth) > 0.0)) return {};

    const double ahead_mm = (cap->middle_mm - last.middle).dot(along), to_mm = length_mm + ahead_mm;
    if (!(to_mm > 0.0)) return {};
    std::vector<WidthKnot> widths;
    for (const WidthKnot& knot : out.half_width)
        if (knot.at * length_mm < to_mm) widths.push_back({knot.at * length_mm / to_mm, knot.half_width_mm});
    widths.push_back({1.0, half_width_at(out, std::min(1.0, to_mm / length_mm))});
    if (ahead_mm > 0.0)
        append(out.middle_mm, last.middle + ahead_mm * along);
    else
        out.middle_mm = part_of(out.middle_mm, {0, 0.0}, line.at(to_mm).place);
    out.half_width = std::move(widths);
    return TurnedEnd{std::move(out), *depth};
}

}  // namespace brushsvg
