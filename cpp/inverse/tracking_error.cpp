#include "brushsvg/tracking_error.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/tolerance.hpp"
#include "brushsvg/simulate.hpp"
#include "inverse/ends/end_styles.hpp"
#include "regions/nearest_on_polyline.hpp"

namespace brushsvg {

using Eigen::Index;

/// Largest distance between checked points of the mark [mm]. The mark passes a corner of the line within 0.2 mm. At
/// 0.5, a fifth of the error at the corner was not seen.
constexpr double kCheckSpacingMm = 0.1;

namespace {

/// A disc about a place where the brush turns round, or about a butt end. There the middle of the mark does not count,
/// because it swings in corners.
struct ExcludedDisc {
    Eigen::Vector2d middle_mm;
    double radius_mm;
    double distance(const Eigen::Vector2d& point) const {
        return std::max(0.0, (point - middle_mm).norm() - radius_mm);
    }
};

/// Return the tangent at the start of a path, not the direction of the first chord. Half a width before the start,
/// these two are 0.05 mm apart on an arc of 10 mm.
Eigen::RowVector2d start_tangent(const Cubics& middle_mm) {
    Place first{0, 0.0};
    while (first.cubic + 1 < middle_mm.rows() && tangent_at(middle_mm, first).isZero()) ++first.cubic;
    return tangent_at(middle_mm, first).transpose();
}

/// Return whether a mark comes near the place where a butt end's way back along the side ends. A mark on the path is as
/// far from that place as the path is.
bool ends_butt(const Ring& widest, const ButtEnd& end) {
    constexpr double kMaxEndDistanceShare = 0.25;
    const double off_path_mm = std::abs(end.end.left.dot(end.back_mm - end.end.at_mm));
    return (widest.rowwise() - end.back_mm.transpose()).rowwise().norm().minCoeff() <
           kMaxEndDistanceShare * off_path_mm;
}

TrackingError tracking_error_of(const PassMarks& marks, const Ring& widest, const Stroke& stroke, double tolerance_mm,
                                const std::vector<ExcludedDisc>& discs) {
    const MiddlePolyline line = flatten(stroke, std::min(0.005, 0.05 * tolerance_mm));
    // on its way back to a round start, a blunt front goes beyond the start of the path
    MiddlePolyline longer(line.rows() + 1, 4);
    longer << line.row(0), line;
    longer.row(0).head<2>() -= line(0, 3) * start_tangent(stroke.middle_mm);
    NearestOnPolyline nearest(line), before_turn(longer);
    // check from the first taut row to the last: the landing and a slack lift do not count, a turn in place does, and
    // where the brush turns over it hardly touches
    std::size_t begin = 0, end = marks.taut.size();
    while (begin < end && !marks.taut[begin]) ++begin;
    while (end > begin && !marks.taut[end - 1]) --end;
    TrackingError error;
    double before = 0.0, travelled = 0.0;  // weighted by length: rows are closer where a tolerance needs it
    const auto check_rows = [&](std::size_t from, std::size_t to, auto& path) {
        std::optional<Eigen::Vector2d> last;
        visit_along(widest, Index(from), Index(to), kCheckSpacingMm, [&](const Eigen::Vector2d& point) {
            double d = path.distance(point);
            for (const ExcludedDisc& disc : discs) d = std::min(d, disc.distance(point));
            if (d > error.largest_mm) {
                error.largest_mm = d;
                error.at_mm = {point.x(), point.y()};
            }
            const double step = last ? (point - *last).norm() : 0.0;
            error.mean_mm += 0.5 * (before + d) * step;
            travelled += step;
            before = d;
            last = point;
        });
    };
    for (const TurnOver& turn : find_turn_overs(marks)) {
        check_rows(begin, turn.first, before_turn);
        begin = turn.last;
    }
    check_rows(begin, end, nearest);
    error.mean_mm = travelled > 0.0 ? error.mean_mm / travelled : error.largest_mm;
    error.within_tolerance = error.largest_mm <= tolerance_mm;
    return error;
}

}  // namespace

TrackingError tracking_error_of(const Pass& pass, const Stroke& stroke, const Brush& brush, double tolerance_mm) {
    check(stroke);
    require_tolerance(tolerance_mm, stroke.id);
    const PassMarks marks = simulate(pass, brush, std::min(0.02, 0.1 * tolerance_mm), false);
    // a dot, or a stroke that begins or ends with a turn
    const std::vector<FullTurn> all_turned = find_full_turns(marks);
    const auto is_taut_within = [&](std::size_t from, std::size_t to) {
        return std::any_of(marks.taut.begin() + Index(from), marks.taut.begin() + Index(to),
                           [](bool taut) { return taut; });
    };
    const bool is_dot =
        !all_turned.empty() && find_turn_overs(marks).empty() && !is_taut_within(0, all_turned.front().first);
    const Ring widest = is_dot ? marks.contact_mm : widest_points(marks, brush);
    std::vector<ExcludedDisc> discs;
    if (!is_dot)
        for (const FullTurn& turned : all_turned) {
            const auto depth = marks.depth_mm.begin();
            discs.push_back({marks.contact_mm.row(Index(turned.last)).transpose(),
                             turn_radius_mm(brush, *std::max_element(depth + Index(turned.first),
                                                                     depth + Index(turned.last) + 1))});
        }
    const Stroke painted = clamp_widths(stroke, brush);
    // a blunt front goes beyond the path's end, and so does a point
    Stroke whole = extend_to_drawn_end(painted, brush);
    if (stroke.settings.end == "pointed")
        if (auto pointed = pointed_end(painted, brush, Caps::round)) whole = std::move(pointed->stroke);
    const TrackingError error = tracking_error_of(marks, widest, whole, tolerance_mm, discs);
    if (error.within_tolerance) return error;
    if (const auto dot = discs.empty() ? std::nullopt : dot_with_corners(painted, brush)) {
        const Stroke& way = *dot->back().line;
        for (Index i = 0; i < way.middle_mm.rows(); ++i)
            discs[0].radius_mm =
                std::max(discs[0].radius_mm, (way.middle_mm.row(i).tail<2>().transpose() - discs[0].middle_mm).norm() +
                                                 brush.lever_to_widest(depth_of(way, brush, 0.0)));
        return tracking_error_of(marks, widest, whole, tolerance_mm, discs);
    }
    const std::size_t before = discs.size();
    for (const Side side : {Side::start, Side::end})
        if (const auto found = make_butt_end(painted, brush, Caps::straight, side); found && ends_butt(widest, *found))
            discs.push_back({found->end.at_mm, found->reach_mm});
    return discs.size() == before ? error : tracking_error_of(marks, widest, whole, tolerance_mm, discs);
}

}  // namespace brushsvg
