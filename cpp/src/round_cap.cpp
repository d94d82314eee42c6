#include "round_cap.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "middle_line.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// In half widths: how much of the line is led anew. More would show beside the dot.
constexpr double kAnew = 0.8;
/// Of that, how far its handles reach.
constexpr double kHandles = 1.0 / 3.0;
/// A line that is not longer, in half widths, keeps its direction.
constexpr double kLongEnough = 1.0;
/// Per m, by which marks may narrow.
constexpr double kWet = 1e-3;

Stroke other_way(const Stroke& stroke) {
    Stroke out = stroke;
    out.middle_mm = reversed(stroke.middle_mm);
    std::reverse(out.half_width.begin(), out.half_width.end());
    for (WidthKnot& knot : out.half_width) knot.at = 1.0 - knot.at;
    return out;
}

}  // namespace

std::optional<ToCap> ends_in_cap(const Stroke& stroke, const Brush& brush) {
    Stroke out = as_wide_as_painted(stroke, brush);
    const Line line(out, brush);
    const double length_mm = line.length(), half_mm = half_width_at(out, 1.0);
    if (stroke.closed || !(length_mm > 0.0) || (brush.paint && brush.paint->narrows_per_m > kWet)) return {};
    const Sample last = line.at(length_mm);
    const Vector2d along = line.tangent(last);
    const auto cap = cap_of(stroke, {last.middle, along, {-along.y(), along.x()}, half_mm});
    if (!cap) return {};
    if (stroke.wanted_mm.empty() || !(length_mm > kLongEnough * half_mm)) return ToCap{std::move(out), *cap};

    const double anew_mm = kAnew * half_mm;
    const Sample from = line.at(length_mm - anew_mm);
    const Vector2d to = cap->middle_mm - from.middle, leaving = line.tangent(from);
    if (!(to.dot(leaving) > 0.0)) return {};
    const double reach_mm = kHandles * to.norm();
    Cubics anew(1, 8);
    anew << from.middle.transpose(), (from.middle + reach_mm * leaving).transpose(),
        (cap->middle_mm - kHandles * to).transpose(), cap->middle_mm.transpose();
    const double now_mm = length_mm - anew_mm + arc_length(anew, 0, 0.0, 1.0);
    out.middle_mm = part_of(out.middle_mm, {0, 0.0}, from.place);
    append_way(out.middle_mm, anew);
    std::vector<WidthKnot> widths;
    for (const WidthKnot& knot : out.half_width)
        if (knot.at * length_mm < from.s) widths.push_back({knot.at * length_mm / now_mm, knot.half_width_mm});
    widths.push_back({from.s / now_mm, half_width_at(out, from.s / length_mm)});
    widths.push_back({1.0, half_mm});
    out.half_width = std::move(widths);
    return ToCap{std::move(out), *cap};
}

std::optional<ToCap> begins_in_cap(const Stroke& stroke, const Brush& brush) {
    auto found = ends_in_cap(other_way(stroke), brush);
    if (found) found->stroke = other_way(found->stroke);
    return found;
}

}  // namespace brushsvg
