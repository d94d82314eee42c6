#include "turned_beginning.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dot.hpp"
#include "hidden_beginning.hpp"
#include "landing.hpp"

namespace brushsvg {
namespace {

using Eigen::Vector2d;

/// Of a half width: a line that is no longer is a dot.
constexpr double kShortest = 1.4;
/// Of a dot's half width, what is wide enough to hide a pointed rear.
constexpr double kHidingShare = 0.9;
constexpr int kHalvings = 40;

}  // namespace

std::optional<TurnedBeginning> turned_beginning(const Stroke& stroke, const Brush& brush, const Line& line) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    const double half_mm = half_width_at(stroke, 0.0), length_mm = line.length();
    if (!(length_mm > kShortest * half_mm)) return {};
    const auto depth = depth_of_dot(brush, half_mm);
    auto onward = narrowed(stroke, brush, length_mm, -kHidingShare * half_mm);
    if (!depth || !onward) return {};
    const Vector2d at = line.at(0.0).middle;
    const auto beyond = [&](double s) {
        return (line.at(s).middle - at).norm() -
               brush.lever_to_widest(depth_of(onward->second, brush, std::clamp(s / length_mm, 0.0, 1.0)));
    };
    double a = 0.0, b = std::min(2.0 * half_mm, length_mm);
    if (beyond(a) > 0.0 || !(beyond(b) > 0.0)) return {};
    for (int i = 0; i < kHalvings; ++i) {
        const double s = 0.5 * (a + b);
        (beyond(s) > 0.0 ? b : a) = s;
    }
    return TurnedBeginning{at, *depth, std::move(onward->second), b, (line.at(b).middle - at).normalized()};
}

void turn(const TurnedBeginning& beginning, const Brush& brush, PoseList& out) {
    const double first_rad = std::atan2(beginning.on_along.y(), beginning.on_along.x()) - kTurnRad;
    land({beginning.at_mm, Vector2d(std::cos(first_rad), std::sin(first_rad)), beginning.depth_mm}, brush, out);
    turn_round(beginning.at_mm, first_rad, beginning.depth_mm, brush, out);
}

}  // namespace brushsvg
