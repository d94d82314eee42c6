#include "brushsvg/tracking_error.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "brushsvg/simulate.hpp"
#include "ends/end_styles.hpp"
#include "nearest_on_polyline.hpp"
#include "tolerance.hpp"

namespace brushsvg {

using Eigen::Index;

/// Where the mark is looked at between rows: it passes a corner of the line within 0.2 mm, and at 0.5 a fifth of the
/// miss there slipped through.
constexpr double kLookEveryMm = 0.1;

namespace {

/// Where the way of a squared beginning or end lies: there the mark is judged and not its middle, which swings in
/// corners.
struct Surroundings {
    Eigen::Vector2d middle_mm;
    double radius_mm;
    double distance(const Eigen::Vector2d& point) const {
        return std::max(0.0, (point - middle_mm).norm() - radius_mm);
    }
};

/// The direction in which a path begins, and not that of its first chord: half a width before it those are 0.05 mm
/// apart on an arc of 10 mm.
Eigen::RowVector2d begins_along(const Cubics& middle_mm) {
    Place first{0, 0.0};
    while (first.cubic + 1 < middle_mm.rows() && tangent_at(middle_mm, first).isZero()) ++first.cubic;
    return tangent_at(middle_mm, first).transpose();
}

/// Whether a mark was last led to where a squared end's way ends, and not to the drawn path's end.
bool ends_squared(const PassMarks& marks, const Ring& widest, const Squared& squared) {
    constexpr double kThere = 0.25;
    std::size_t end = marks.taut.size();
    while (end > 0 && !marks.taut[end - 1]) --end;
    if (end == 0) return false;
    const Eigen::Vector2d last = widest.row(Index(end) - 1).transpose();
    return (last - squared.back_mm).norm() < kThere * (last - squared.end.at_mm).norm();
}

/// The row that comes nearest to a place.
std::size_t nearest_row(const Ring& rows, std::size_t begin, std::size_t end, const Eigen::Vector2d& place_mm) {
    Index nearest = 0;
    if (begin == end) return end;
    (rows.middleRows(Index(begin), Index(end - begin)).rowwise() - place_mm.transpose())
        .rowwise()
        .squaredNorm()
        .minCoeff(&nearest);
    return begin + std::size_t(nearest);
}

/// Rows of a squared beginning: where it leaves the path on its way back, and where it is on it again.
struct WayRound {
    std::size_t leaves, joins;
};

/// None where a mark is not set down heading back, or does not come back along the side.
std::optional<WayRound> way_round(const PassMarks& marks, const Ring& widest, std::size_t begin, std::size_t end,
                                  const Squared& squared) {
    constexpr double kThere = 0.25;
    if (begin == end) return {};
    const double heading = marks.heading_rad[Index(begin)];
    if (-squared.end.along.dot(Eigen::Vector2d(std::cos(heading), std::sin(heading))) > 0.0) return {};
    const std::size_t aside = nearest_row(widest, begin, end, squared.back_mm);
    const Eigen::Vector2d on = squared.joins_mm - squared.back_mm;
    const Eigen::Vector2d off = squared.back_mm - squared.end.at_mm, along = squared.end.along;
    const double off_line_mm = std::abs(along.x() * off.y() - along.y() * off.x());
    if ((widest.row(Index(aside)).transpose() - squared.back_mm).norm() > kThere * off_line_mm) return {};
    std::size_t last = aside + 1;  // a stroke may come by again
    for (double way = 0.0; last < end && way < 2.0 * on.norm(); ++last)
        way += (widest.row(Index(last)) - widest.row(Index(last) - 1)).norm();
    return WayRound{nearest_row(widest, begin, aside, squared.leaves_mm),
                    nearest_row(widest, aside, last, squared.joins_mm)};
}

/// The last row that comes as near to a place as any.
std::size_t last_at(const Ring& rows, std::size_t begin, std::size_t end, const Eigen::Vector2d& place_mm) {
    constexpr double kHair = 0.01;
    if (begin == end) return end;
    const Eigen::VectorXd away =
        (rows.middleRows(Index(begin), Index(end - begin)).rowwise() - place_mm.transpose()).rowwise().norm();
    std::size_t last = end - 1;
    while (away[Index(last - begin)] > away.minCoeff() + kHair) --last;
    return last;
}

/// The rows about a dot in which the widest section stays in it: its mark is there in the stead of the line's.
Turned inside_of(const PassMarks& marks, const Ring& widest, const Turned& turned, const Brush& brush) {
    const Eigen::RowVector2d at = marks.contact_mm.row(Index(turned.last));
    const auto depth = marks.depth_mm.begin();
    const double reach_mm = reach_of_turn_mm(
        brush,
        *std::max_element(depth + Index(turned.first), depth + Index(turned.last) + 1));  // it is lifted in place
    const auto is_inside = [&](std::size_t row) { return (widest.row(Index(row)) - at).norm() < reach_mm; };
    Turned all = turned;
    while (all.first > 0 && is_inside(all.first - 1)) --all.first;
    while (all.last + 1 < marks.taut.size() && is_inside(all.last + 1)) ++all.last;
    return all;
}

/// all_turned: dots in the mark, of which the widest section goes round the line.
TrackingError tracking_error_of(const PassMarks& marks, const Ring& widest, const Stroke& stroke, const Brush& brush,
                                double tolerance_mm, const std::vector<Turned>& all_turned,
                                const std::optional<Squared>& beginning = {},
                                const std::optional<Squared>& squared = {},
                                const std::optional<Surroundings>& all = {}) {
    const MiddlePolyline line = flatten(stroke, std::min(0.005, 0.05 * tolerance_mm));
    // on its way back to a hidden beginning a blunt front goes beyond the path's
    MiddlePolyline longer(line.rows() + 1, 4);
    longer << line.row(0), line;
    longer.row(0).head<2>() -= line(0, 3) * begins_along(stroke.middle_mm);
    Nearest nearest(line), before_turn(longer);
    // from the first taut row to the last: the landing and a slack lift do not count, a turn in place does, and where
    // the brush turns over it hardly touches
    std::size_t begin = 0, end = marks.taut.size();
    while (begin < end && !marks.taut[begin]) ++begin;
    while (end > begin && !marks.taut[end - 1]) --end;
    TrackingError miss;
    double before = 0.0, travelled = 0.0;  // by length and not by rows, which lie closer where a tolerance asks for it
    std::optional<Eigen::Vector2d> last;
    const auto look_at = [&](std::size_t from, std::size_t to, auto& nearest) {
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
    const auto look = [&](std::size_t from, std::size_t to, auto& nearest) {
        for (const Turned& turned : all_turned) {
            const Turned inside = inside_of(marks, widest, turned, brush);
            if (inside.last <= from || inside.first >= to) continue;
            look_at(from, std::max(from, inside.first), nearest);
            from = std::min(inside.last, to);
        }
        look_at(from, to, nearest);
    };
    if (const auto round = beginning ? way_round(marks, widest, begin, end, *beginning) : std::nullopt) {
        Surroundings surroundings{beginning->end.at_mm, beginning->reach_mm};
        look(begin, round->leaves, nearest);
        look(round->leaves, round->joins, surroundings);
        begin = round->joins;
    }
    for (const TurnOver& turn : turns_over(marks)) {
        if (turn.first < begin) continue;
        look(begin, turn.first, before_turn);
        begin = turn.last;
    }
    if (squared) {
        const std::size_t leaves = last_at(widest, begin, end, squared->leaves_mm);
        Surroundings surroundings{squared->end.at_mm, squared->reach_mm};
        look(leaves, end, surroundings);
        end = leaves;
    }
    if (all) {
        Surroundings surroundings = *all;
        look(begin, end, surroundings);
    } else {
        look(begin, end, nearest);
    }
    miss.mean_mm = travelled > 0.0 ? miss.mean_mm / travelled : miss.largest_mm;
    miss.within_tolerance = miss.largest_mm <= tolerance_mm;
    return miss;
}

}  // namespace

TrackingError tracking_error_of(const Pass& pass, const Stroke& stroke, const Brush& brush, double tolerance_mm) {
    check(stroke);
    require_tolerance(tolerance_mm, stroke.id);
    const PassMarks marks = simulate(pass, brush, std::min(0.02, 0.1 * tolerance_mm), false);
    std::vector<Turned> turned = turned_round(marks);  // a dot, or a stroke that begins or ends with one
    const auto is_taut_within = [&](std::size_t from, std::size_t to) {
        return std::any_of(marks.taut.begin() + Index(from), marks.taut.begin() + Index(to),
                           [](bool taut) { return taut; });
    };
    const bool is_all = !turned.empty() && turns_over(marks).empty() && !is_taut_within(0, turned.front().first);
    const Ring widest = is_all ? marks.contact_mm : widest_points(marks, brush);
    if (is_all) turned.clear();
    // a blunt front goes beyond the path's end, and the middle of a cap may lie there
    Stroke whole = up_to_drawn_end(stroke, brush);
    if (!turned.empty() && !is_taut_within(turned.back().last + 1, marks.taut.size()))
        if (const auto end = turned_end(stroke, brush)) whole = end->stroke;
    const TrackingError miss = tracking_error_of(marks, widest, whole, brush, tolerance_mm, turned);
    if (miss.within_tolerance) return miss;
    if (!turned.empty())
        if (const auto dot = squared_dot(stroke, brush)) {
            Surroundings all{dot->front().turn->at_mm, 0.0};
            const Cubics& way = dot->back().line->middle_mm;
            const double lever = brush.lever_to_widest(depth_of(*dot->back().line, brush, 0.0));
            for (Index i = 0; i < way.rows(); ++i)
                all.radius_mm = std::max(all.radius_mm, (way.row(i).tail<2>().transpose() - all.middle_mm).norm() + lever);
            return tracking_error_of(marks, widest, whole, brush, tolerance_mm, turned, {}, {}, all);
        }
    const std::optional<Squared> beginning = squared(stroke, brush, Caps::straight, Side::start);
    std::optional<Squared> end = squared(stroke, brush, Caps::straight, Side::end);
    if (end && !ends_squared(marks, widest, *end)) end.reset();
    if (!beginning && !end) return miss;
    return tracking_error_of(marks, widest, end ? stroke : whole, brush, tolerance_mm, turned, beginning, end);
}

}  // namespace brushsvg
