#include "turned_end.hpp"

#include <utility>

#include "dot.hpp"
#include "middle_line.hpp"
#include "round_cap.hpp"

namespace brushsvg {

std::optional<TurnedEnd> turned_end(const Stroke& stroke, const Brush& brush) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    auto to_cap = ends_in_cap(stroke, brush);
    if (!to_cap) return {};
    const double full_depth = depth_of(to_cap->stroke, brush, 1.0);
    const auto depth = depth_of_dot(brush, to_cap->cap.radius_mm);
    if (!depth || *depth >= full_depth || !(brush.lever_to_widest(full_depth) > 0.0)) return {};
    return TurnedEnd{std::move(to_cap->stroke), *depth};
}

}  // namespace brushsvg
