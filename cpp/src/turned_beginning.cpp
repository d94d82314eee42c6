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
/// Steps in which a ball's middle is looked for, and how far from it the line's own mark may begin, in its half widths:
/// at 1.55 what a disc leaves of it is more than it wins.
constexpr int kSteps = 24;
constexpr double kBeforeBall = 1.3;
/// And how near to the line's beginning the mark is narrowed for a ball: as far behind it as a mark can be narrowed.
constexpr double kNearest = 0.3;

/// Arc length where the line is widest near its beginning, as amid the ball that it begins in: lines of shapes begin
/// beside its middle, and narrower.
double ball_mm(const Stroke& stroke, double length_mm) {
    double found_mm = 0.0, half_mm = half_width_at(stroke, 0.0);
    for (int i = 1; i <= kSteps; ++i) {
        const double s = 2.0 * half_width_at(stroke, 0.0) * i / kSteps;
        if (s > length_mm) break;
        const double half = half_width_at(stroke, s / length_mm);
        if (half <= half_mm) continue;
        half_mm = half;
        found_mm = s;
    }
    return found_mm + half_width_at(stroke, 0.0) <= kBeforeBall * half_mm ? found_mm : 0.0;
}

}  // namespace

std::optional<TurnedBeginning> turned_beginning(const Stroke& stroke, const Brush& brush, const Line& line) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    const double length_mm = line.length();
    if (!(length_mm > kShortest * half_width_at(stroke, 0.0))) return {};
    const double from_mm = ball_mm(stroke, length_mm), half_mm = half_width_at(stroke, from_mm / length_mm);
    const auto depth = depth_of_dot(brush, half_mm);
    const double hidden_mm =
        from_mm > 0.0 ? std::min(from_mm - kHidingShare * half_mm, -kNearest * half_mm) : -kHidingShare * half_mm;
    auto onward = narrowed(stroke, brush, length_mm, hidden_mm);
    if (!depth || !onward) return {};
    const Vector2d at = line.at(from_mm).middle;
    const auto beyond = [&](double s) {
        return (line.at(s).middle - at).norm() -
               brush.lever_to_widest(depth_of(onward->second, brush, std::clamp(s / length_mm, 0.0, 1.0)));
    };
    double a = from_mm, b = std::min(from_mm + 2.0 * half_mm, length_mm);
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
