#include "turned_beginning.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dot.hpp"
#include "hidden_beginning.hpp"
#include "landing.hpp"
#include "round_cap.hpp"
#include "stroke_ends.hpp"

namespace brushsvg {
namespace {

using Eigen::Vector2d;

/// Of a half width: a line that is no longer is a dot.
constexpr double kShortest = 1.4;
/// Of a dot's half width, what is wide enough to hide a pointed rear.
constexpr double kHidingShare = 0.9;
/// Steps in which a ball's middle is looked for, and how far from it the line's own mark may begin, in its half widths:
/// at 1.55 what a disc leaves of it is more than it wins.
constexpr int kSteps = 24;
constexpr double kBeforeBall = 1.3;
/// Half widths of its beginning after which a line is so much thinner where it begins in a ball.
constexpr double kOfBall = 3.0, kThinner = 0.85;
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

/// Back at the full width until the widest section is at the line's first point, amid a cap.
std::optional<TurnedBeginning> by_way_back(const Stroke& stroke, const Brush& brush, const Line& line, double radius_mm,
                                           double depth, double step_tolerance) {
    auto onward = narrowed(stroke, brush, line.length(), -kHidingShare * radius_mm);
    const double full_depth = depth_of(stroke, brush, 0.0), lever = brush.lever_to_widest(full_depth);
    if (!onward || !(lever > 0.0) || depth >= full_depth) return {};
    const double from_mm = std::max(2.0 * lever, onward->first),
                 last_mm = painted_stretch(stroke, brush, line.length())[1];
    if (from_mm > last_mm || !rear_lies_inside(stroke, brush, line, from_mm)) return {};
    auto back = way_back(brush, line, InverseLag(line, brush), from_mm, 0.0, step_tolerance);
    if (!back) return {};
    const Vector2d at = back->back().middle;
    const auto on_from_mm = goes_on_mm(onward->second, brush, line, at, {0.0, std::min(4.0 * lever, last_mm)});
    if (!on_from_mm) return {};
    return TurnedBeginning{std::move(*back),          at,          depth,
                           std::move(onward->second), *on_from_mm, (line.at(*on_from_mm).middle - at).normalized()};
}

/// Set down where the line is widest.
std::optional<TurnedBeginning> on_the_spot(const Stroke& stroke, const Brush& brush, const Line& line, double from_mm,
                                           double radius_mm, double depth) {
    const double hidden_mm =
        from_mm > 0.0 ? std::min(from_mm - kHidingShare * radius_mm, -kNearest * radius_mm) : -kHidingShare * radius_mm;
    auto onward = narrowed(stroke, brush, line.length(), hidden_mm);
    if (!onward) return {};
    const Vector2d at = line.at(from_mm).middle;
    const auto on_from_mm =
        goes_on_mm(onward->second, brush, line, at, {from_mm, std::min(from_mm + 2.0 * radius_mm, line.length())});
    if (!on_from_mm) return {};
    return TurnedBeginning{
        {}, at, depth, std::move(onward->second), *on_from_mm, (line.at(*on_from_mm).middle - at).normalized()};
}

}  // namespace

bool begins_in_ball(const Stroke& stroke, double length_mm) {
    const double half_mm = half_width_at(stroke, 0.0);
    return half_width_at(stroke, std::min(1.0, kOfBall * half_mm / length_mm)) < kThinner * half_mm;
}

std::optional<TurnedBeginning> turned_beginning(const Stroke& stroke, const Brush& brush, double step_tolerance) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    const Line line(stroke, brush);
    if (!(line.length() > kShortest * half_width_at(stroke, 0.0))) return {};
    const double from_mm = ball_mm(stroke, line.length()), half_mm = half_width_at(stroke, from_mm / line.length());
    if (!begins_in_ball(stroke, line.length()))
        if (const auto to_cap = begins_in_cap(stroke, brush)) {
            const double radius_mm = to_cap->cap.radius_mm;
            const auto depth = depth_of_dot(brush, radius_mm);
            const Line led(to_cap->stroke, brush);
            if (!depth) return {};
            auto found = by_way_back(to_cap->stroke, brush, led, radius_mm, *depth, step_tolerance);
            return found ? found : on_the_spot(to_cap->stroke, brush, led, 0.0, radius_mm, *depth);
        }
    const auto depth = depth_of_dot(brush, half_mm);
    if (!depth) return {};
    return on_the_spot(stroke, brush, line, from_mm, half_mm, *depth);
}

Vector2d turn(const TurnedBeginning& beginning, const Brush& brush, PoseList& out) {
    if (beginning.back.empty()) {
        const double first_rad = std::atan2(beginning.on_along.y(), beginning.on_along.x()) - kTurnRad;
        land({beginning.at_mm, Vector2d(std::cos(first_rad), std::sin(first_rad)), beginning.depth_mm}, brush, out);
        turn_round(beginning.at_mm, first_rad, beginning.depth_mm, brush.lag(beginning.depth_mm), out);
        return beginning.on_along;
    }
    const Sample& last = beginning.back.back();
    land({beginning.back.front().contact, beginning.back.front().heading, beginning.back.front().depth}, brush, out);
    for (const Sample& sample : beginning.back) out.add(sample.tcp, sample.depth);
    return turn_round_ahead({last.contact, last.heading, last.depth}, beginning.depth_mm, brush, out).heading;
}

}  // namespace brushsvg
