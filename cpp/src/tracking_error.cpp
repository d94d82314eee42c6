#include "brushsvg/tracking_error.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "brushsvg/simulate.hpp"
#include "dot.hpp"
#include "nearest_on_polyline.hpp"
#include "stroke_ends.hpp"
#include "tolerance.hpp"

namespace brushsvg {

using Eigen::Index;

/// Where the mark is looked at between rows: it passes a corner of the line within 0.2 mm, and at 0.5 a fifth of the
/// miss there slipped through.
constexpr double kLookEveryMm = 0.1;

TrackingError tracking_error_of(const Pass& pass, const Stroke& stroke, const Brush& brush, double tolerance_mm) {
    check(stroke);
    require_tolerance(tolerance_mm, stroke.id);
    const PassMarks marks = simulate(pass, brush, std::min(0.02, 0.1 * tolerance_mm), false);
    const Ring widest = is_dot(marks) ? marks.contact_mm : widest_points(marks, brush);
    // a blunt front goes beyond the path's end, and on its way back to a hidden beginning beyond that
    const MiddlePolyline line = flatten(up_to_its_end(stroke, brush), std::min(0.005, 0.05 * tolerance_mm));
    MiddlePolyline longer(line.rows() + 1, 4);
    longer << line.row(0), line;
    if (line.rows() > 1) longer.row(0).head<2>() -= line(0, 3) * (line.row(1) - line.row(0)).head<2>().normalized();
    Nearest nearest(line), before_turn(longer);
    // from the first taut row to the last: the landing and a slack lift do not count, a turn in place does, and where
    // the brush turns over it hardly touches
    std::size_t begin = 0, end = marks.taut.size();
    while (begin < end && !marks.taut[begin]) ++begin;
    while (end > begin && !marks.taut[end - 1]) --end;
    TrackingError miss;
    double before = 0.0, travelled = 0.0;  // by length and not by rows, which lie closer where a tolerance asks for it
    std::optional<Eigen::Vector2d> last;
    const auto look = [&](std::size_t from, std::size_t to, auto& nearest) {
        last.reset();
        along(widest, Index(from), Index(to), kLookEveryMm, [&](const Eigen::Vector2d& point) {
            const double d = nearest.distance(point);
            if (d > miss.largest_mm) {
                miss.largest_mm = d;
                miss.at_mm = {point.x(), point.y()};
            }
            const double step = last ? (point - *last).norm() : 0.0;
            miss.mean_mm += 0.5 * (before + d) * step;
            travelled += step;
            before = d;
            last = point;
        });
    };
    for (const TurnOver& turn : turns_over(marks)) {
        look(begin, turn.first, before_turn);
        begin = turn.last;
    }
    look(begin, end, nearest);
    miss.mean_mm = travelled > 0.0 ? miss.mean_mm / travelled : miss.largest_mm;
    miss.within_tolerance = miss.largest_mm <= tolerance_mm;
    return miss;
}

}  // namespace brushsvg
