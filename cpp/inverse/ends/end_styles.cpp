#include "inverse/ends/end_styles.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/footprint.hpp"
#include "brushsvg/region.hpp"
#include "inverse/landing.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Return the depth at which a footprint that is turned on the spot reaches a radius, or the greatest depth if none
/// reaches it. None if a hole would be left about P, or if the least depth already reaches further.
std::optional<double> depth_reaching_radius(const Stroke& stroke, const Brush& brush, double radius_mm) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    const double least = std::max(brush.depth_range_mm[0], 1e-3), most = brush.depth_range_mm[1];
    const auto too_far = [&](double depth) { return turn_radius_mm(brush, depth) > radius_mm; };
    if (too_far(least)) return {};
    const double depth = too_far(most) ? bisect(least, most, too_far) : most;
    if (-brush.tip_gap(depth) > kEndTuning.max_hole * radius_mm) return {};
    return depth;
}

/// Return the depth of a disc in the middle of a round cap, which is less than the stroke's own depth. None if marks
/// narrow as paint runs out. A patch that is pressed deeper to correct for that still paints a disc as large as a wet
/// one does: a knob.
std::optional<double> depth_in_cap(const Stroke& stroke, const Brush& brush, double at) {
    const double full = depth_of(stroke, brush, at);
    if (!(brush.lever_to_widest(full) > 0.0)) return {};
    if (brush.paint && brush.paint->narrows_per_m > kEndTuning.max_wet_narrowing_per_m) return {};
    const auto depth = depth_reaching_radius(stroke, brush, half_width_at(stroke, at));
    return depth && *depth < full ? depth : std::nullopt;
}

/// Return the stroke moved to the middle of the cap in which it is drawn at one side. A line of a shape may end next to
/// that middle.
Stroke move_end_to_cap(const Stroke& stroke, const Brush& brush, Side side) {
    const Line line(stroke, brush);
    const PathEnd end = path_end(stroke, line, side);
    const double ahead_mm = distance_to_outline_mm(stroke.target_mm, end, 0.0) - end.half_mm;
    if (!(std::abs(ahead_mm) < kEndTuning.max_cap_distance * end.half_mm) || !(line.length() > end.half_mm))
        return stroke;
    const double inside_mm = std::max(0.0, -ahead_mm);
    const Vector2d middle = end.place(std::max(0.0, ahead_mm), 0.0);
    StrokePath path(middle, end.half_mm);
    if (side == Side::start) {
        if (ahead_mm > 0.0) path.line_to(end.at_mm, end.half_mm);
        path.follow(stroke, line, inside_mm, line.length());
        return path.with_properties_of(stroke);
    }
    path = {};
    path.follow(stroke, line, 0.0, line.length() - inside_mm);
    if (ahead_mm > 0.0) path.line_to(middle, end.half_mm);
    return path.with_properties_of(stroke);
}

/// A stroke that is narrowed from an arc length on so that the rear of its footprint stays ahead of a limit. It reaches
/// its full width at `full_from_mm`. None if no depth keeps the rear ahead of the limit.
struct NarrowedStroke {
    Stroke stroke;
    double full_from_mm;
};
std::optional<NarrowedStroke> narrow_start(const Stroke& stroke, const Brush& brush, double length_mm, double from_mm,
                                           double rear_mm) {
    Stroke out = stroke;
    out.half_width.clear();
    const double step_mm = std::max(kEndTuning.min_narrowing_step_mm,
                                    kEndTuning.narrowing_step * brush.tip_to_widest(depth_of(stroke, brush, 0.0)));
    for (double s = from_mm; s < length_mm; s += step_mm) {
        checkpoint();
        const double at = s / length_mm, full = depth_of(stroke, brush, at), least = brush.depth_range_mm[0];
        const auto sticks_out = [&](double depth) { return s - brush.tip_to_widest(depth) < rear_mm; };
        if (sticks_out(full)) {
            if (sticks_out(least)) return {};
            out.half_width.push_back({at, brush.half_width(bisect(least, full, sticks_out))});
            continue;
        }
        out.half_width.push_back({at, half_width_at(stroke, at)});
        for (const WidthKnot& knot : stroke.half_width)
            if (knot.at > at) out.half_width.push_back(knot);
        return NarrowedStroke{std::move(out), s};
    }
    return {};
}

/// Set the brush down heading back along the line. Draw it back until the widest section is at an arc length, negative
/// before the line. There turn it over, or turn it round at a depth. Continue along the line with the rear of the mark
/// ahead of `rear_mm`.
std::optional<BrushMoves> start_drawn_back(const Stroke& stroke, const Brush& brush, double until_mm, double rear_mm,
                                           std::optional<double> turn_depth_mm = {}) {
    const Line line(stroke, brush);
    const auto onward = narrow_start(stroke, brush, line.length(), std::max(until_mm, 0.0), rear_mm);
    if (!onward) return {};
    const double last_mm = painted_stretch(stroke, brush, line.length())[1];
    const double lever = brush.lever_to_widest(depth_of(stroke, brush, 0.0));
    const double narrow_lever = brush.lever_to_widest(depth_of(onward->stroke, brush, 0.0));
    // otherwise the line's first point is out of reach of P
    until_mm = std::max(until_mm, -0.999 * (lever + narrow_lever));
    const double from_mm = std::min(std::max(until_mm + 2.0 * lever, onward->full_from_mm), last_mm);
    if (!(from_mm > std::max(until_mm, 0.0))) return {};
    StrokePath path;
    path.follow(stroke, line, from_mm, std::max(until_mm, 0.0));
    const PathEnd start = path_end(stroke, line, Side::start);
    if (until_mm < 0.0) path.line_to(start.place(-until_mm, 0.0), start.half_mm);
    const Stroke back = path.with_properties_of(stroke);
    for (const WidthKnot& knot : back.half_width)
        if (!(brush.lever_to_widest(brush.depth_for_half_width(knot.half_width_mm, stroke.id)) > 0.0)) return {};
    std::optional<TurnRound> turn;
    if (turn_depth_mm) turn = TurnRound{start.at_mm, *turn_depth_mm};
    return BrushMoves{{{}, back, 0.0, 0.0, path.length_mm()},
                      {turn, onward->stroke, turn ? 0.0 : std::max(0.0, until_mm + lever),
                       std::min(until_mm + 4.0 * lever, last_mm), last_mm}};
}

/// Return the moves along the line with nothing before it.
BrushMoves start_at_tip(Stroke stroke, const Brush& brush) {
    const auto [s0, s1] = painted_stretch(stroke, brush, Line(stroke, brush).length());
    return {{{}, std::move(stroke), s0, s0, s1}};
}

/// Begin pointed, with the shape of the footprint's rear.
std::optional<BrushMoves> pointed_start(const Stroke& stroke, const Brush& brush, Caps) {
    return start_at_tip(stroke, brush);
}

/// Draw back until the round front of the footprint reaches the drawn start.
std::optional<BrushMoves> round_start(const Stroke& stroke, const Brush& brush, Caps) {
    const double depth = depth_of(stroke, brush, 0.0), half_mm = half_width_at(stroke, 0.0);
    if (stroke.closed || brush.is_rigid() || !(brush.lever_to_widest(depth) > 0.0)) return {};
    const double until_mm = reach_beyond_end_mm(brush, depth, half_mm);
    return start_drawn_back(stroke, brush, until_mm, until_mm - kEndTuning.hiding_share * (until_mm + half_mm));
}

/// Draw back at the full width into a round cap, and turn round in it.
std::optional<BrushMoves> cap_start(const Stroke& stroke, const Brush& brush, Caps) {
    const auto depth = depth_in_cap(stroke, brush, 0.0);
    if (!depth) return {};
    return start_drawn_back(move_end_to_cap(stroke, brush, Side::start), brush, 0.0,
                            -kEndTuning.hiding_share * half_width_at(stroke, 0.0), depth);
}

/// Set down and turn round where the line is widest near its start, as in the middle of the ball of an f, or in a
/// comma.
std::optional<BrushMoves> ball_start(const Stroke& stroke, const Brush& brush, Caps) {
    const Line line(stroke, brush);
    const double length_mm = line.length();
    double at_mm = 0.0, radius_mm = half_width_at(stroke, 0.0);
    const double within = kEndTuning.max_ball_distance * radius_mm / length_mm;
    for (const WidthKnot& knot : stroke.half_width)
        if (knot.at > 0.0 && knot.at <= within && knot.half_width_mm > radius_mm) {
            at_mm = knot.at * length_mm;
            radius_mm = knot.half_width_mm;
        }
    const auto depth = depth_reaching_radius(stroke, brush, radius_mm);
    if (!depth) return {};
    const auto onward = narrow_start(stroke, brush, length_mm, at_mm, at_mm - kEndTuning.hiding_share * radius_mm);
    if (!onward) return {};
    return BrushMoves{{TurnRound{line.at(at_mm).middle, *depth}, onward->stroke, at_mm,
                       std::min(at_mm + 2.0 * radius_mm, length_mm), painted_stretch(stroke, brush, length_mm)[1]}};
}

std::optional<BrushMoves> butt_start(const Stroke& stroke, const Brush& brush, Caps caps) {
    if (auto found = make_butt_end(stroke, brush, caps, Side::start))
        return start_at_tip(std::move(found->stroke), brush);
    return {};
}

/// Lift while the patch rests: the end has the shape of the footprint's front.
std::optional<StrokeWithEnd> lifted_end(const Stroke& stroke, const Brush& brush, Caps) {
    return StrokeWithEnd{extend_to_drawn_end(stroke, brush), {}};
}

/// Return half the extent of an outline across its axis, at a place along it.
double half_across_mm(const Ring& outline, double x) {
    double low = 0.0, high = 0.0;
    for (Index i = 0, n = outline.rows(); i < n; ++i) {
        const Vector2d a = outline.row(i), b = outline.row((i + 1) % n);
        if ((a.x() > x) == (b.x() > x)) continue;
        const double y = a.y() + (b.y() - a.y()) * (x - a.x()) / (b.x() - a.x());
        low = std::min(low, y), high = std::max(high, y);
    }
    return 0.5 * (high - low);
}

std::optional<StrokeWithEnd> butt_end(const Stroke& stroke, const Brush& brush, Caps caps) {
    if (auto found = make_butt_end(stroke, brush, caps, Side::end)) return StrokeWithEnd{std::move(found->stroke), {}};
    return {};
}

std::optional<StrokeWithEnd> turned_end(const Stroke& stroke, const Brush& brush, Caps) {
    if (const auto depth = depth_in_cap(stroke, brush, 1.0))
        return StrokeWithEnd{move_end_to_cap(stroke, brush, Side::end), depth};
    return {};
}

/// Return half the width of the mark along a cut. None if the brush is too coarse for one.
std::optional<double> half_along_cut_mm(const Brush& brush, double half_mm) {
    const double least = std::max(kEndTuning.min_cut_half_width * half_mm, brush.half_width_range_mm()[0]),
                 most = std::min(kEndTuning.max_cut_half_width * half_mm, brush.half_width_range_mm()[1]);
    const auto pulls = [&](double half) {
        return brush.lever_to_widest(brush.depth_for_half_width(half, "")) > kEndTuning.min_lever_mm;
    };
    if (least > most || !pulls(most)) return {};
    return pulls(least) ? least : bisect(least, most, pulls);
}

Vector2d corner(const Ring& ring, Index i) { return ring.row((i + ring.rows()) % ring.rows()).transpose(); }

/// Return how far a place is to the left of an edge.
double left_of_mm(const Vector2d& from, const Vector2d& to, const Vector2d& at) {
    const Vector2d along = (to - from).normalized();
    return along.x() * (at - from).y() - along.y() * (at - from).x();
}

/// Return a convex ring without the corners that stick out by less than a limit. The least one is removed first.
Ring remove_small_corners(Ring convex, double least_mm) {
    while (convex.rows() > 3) {
        Index least = 0;
        double sticks_out_mm = least_mm;
        for (Index i = 0; i < convex.rows(); ++i) {
            const double out = -left_of_mm(corner(convex, i - 1), corner(convex, i + 1), corner(convex, i));
            if (out < sticks_out_mm) {
                sticks_out_mm = out;
                least = i;
            }
        }
        if (!(sticks_out_mm < least_mm)) break;
        const Index after = convex.rows() - least - 1;
        convex.middleRows(least, after) = convex.bottomRows(after).eval();
        convex.conservativeResize(convex.rows() - 1, Eigen::NoChange);
    }
    return convex;
}

/// Return the part of a convex ring, counter-clockwise, that is at least `by_mm` inside all its edges.
Ring shrink_convex(const Ring& convex, double by_mm) {
    Ring left = convex;
    for (Index i = 0; i < convex.rows(); ++i) {
        std::vector<Vector2d> kept;
        for (Index k = 0; k < left.rows(); ++k) {
            const Vector2d a = corner(left, k), b = corner(left, k + 1);
            const double at_a = left_of_mm(corner(convex, i), corner(convex, i + 1), a) - by_mm,
                         at_b = left_of_mm(corner(convex, i), corner(convex, i + 1), b) - by_mm;
            if (at_a >= 0.0) kept.push_back(a);
            if ((at_a < 0.0) != (at_b < 0.0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
        }
        left.resize(Index(kept.size()), 2);
        for (std::size_t k = 0; k < kept.size(); ++k) left.row(Index(k)) = kept[k].transpose();
    }
    return left;
}

/// Return whether all corners are within a disc that moves from one place to another.
bool is_covered_by_moving_disc(const Vector2d& from, const Vector2d& to, double radius_mm, const Ring& corners) {
    const Vector2d way = to - from;
    for (Index i = 0; i < corners.rows(); ++i) {
        const Vector2d off = corners.row(i).transpose() - from;
        const double along = std::clamp(off.dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
        if (!((off - along * way).norm() <= radius_mm)) return false;
    }
    return true;
}

}  // namespace

const std::array<StartStyle, 5> kStartStyles{{{Terminal::pointed, pointed_start},
                                              {Terminal::round, round_start},
                                              {Terminal::round, cap_start},
                                              {Terminal::round, ball_start},
                                              {Terminal::butt, butt_start}}};
const std::array<StartStyle, 3> kDotStyles{
    {{Terminal::pointed, pointed_start}, {Terminal::round, turned_dot}, {Terminal::butt, dot_with_corners}}};
const std::array<EndStyle, 4> kEndStyles{{{Terminal::round, lifted_end},
                                          {Terminal::pointed, pointed_end},
                                          {Terminal::butt, butt_end},
                                          {Terminal::automatic, turned_end}}};

double turn_radius_mm(const Brush& brush, double depth) {
    const auto at = [&](double d) {
        Ring outline = footprint_at(brush.footprints, d, 1.0);
        outline.col(0).array() -= brush.tip_gap(d);
        return outline.rowwise().norm().maxCoeff();
    };
    double farthest = at(depth);
    for (const Footprint& measured : brush.footprints.dragged)
        if (measured.depth_mm < depth) farthest = std::max(farthest, at(measured.depth_mm));
    return farthest;
}

std::optional<ButtEnd> make_butt_end(const Stroke& stroke, const Brush& brush, Caps caps, Side side) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    const bool at_start = side == Side::start;
    const Line line(stroke, brush);
    const double length_mm = line.length();
    const PathEnd end = path_end(stroke, line, side);
    const double half_mm = end.half_mm, set_down_mm = kEndTuning.set_down_distance * half_mm;
    const auto narrow = half_along_cut_mm(brush, half_mm);
    if (!narrow || length_mm < kEndTuning.rejoin_distance * half_mm) return {};
    const auto cut = find_cut(stroke, end, half_mm - *narrow, caps);
    double from_mm = 0.0;
    if (at_start) {  // the widest section is set down at set_down_mm, and the tip trails it at tip_mm
        const double tip_mm = set_down_mm + brush.tip_to_widest(depth_of(stroke, brush, set_down_mm / length_mm));
        from_mm = std::max(set_down_mm, tip_mm - half_width_at(stroke, std::min(1.0, tip_mm / length_mm)));
    }
    if (!cut || from_mm > length_mm) return {};
    const Vector2d set_down_along = line.tangent(line.at(from_mm));
    if (at_start && -set_down_along.dot(end.along) < kEndTuning.min_set_down_cosine)
        return {};  // otherwise P would be dragged past a corner

    const double slant = std::min(1.0, std::abs(cut->slope)),
                 leaves = kEndTuning.departure_before_cut + kEndTuning.slant_lead * slant;
    const double ahead_mm = cut->ahead_mm - leaves * half_mm, inside_mm = std::max(0.0, -ahead_mm);
    StrokePath path;
    path.follow(stroke, line, from_mm, at_start ? inside_mm : length_mm - inside_mm);
    if (ahead_mm > 0.0) path.line_to(end.place(ahead_mm, 0.0), half_mm);
    // start with the corner that is further ahead
    const double aside = std::copysign(half_mm - *narrow, -cut->slope);
    const double steep_mm = *narrow * std::hypot(1.0, cut->slope);
    const double first_mm = cut->ahead_mm - cut->slope * aside - steep_mm,
                 second_mm = cut->ahead_mm + cut->slope * aside - steep_mm;
    ButtEnd out{{}, end, end.place(-kEndTuning.return_length * half_mm, -aside), 0.0};
    const double lever = brush.lever_to_widest(brush.depth_for_half_width(*narrow, stroke.id));
    for (const Vector2d& place : {end.place(first_mm - kEndTuning.edge_before_corner * half_mm, aside),
                                  end.place(first_mm, aside), end.place(second_mm, -aside), out.back_mm}) {
        path.line_to(place, *narrow);
        out.reach_mm = std::max(out.reach_mm, (place - end.at_mm).norm() + lever);
    }
    if (at_start) {
        const Sample joins = line.at(kEndTuning.rejoin_distance * half_mm);
        out.reach_mm = std::max(out.reach_mm, (joins.middle - end.at_mm).norm() + lever);
        path.line_to(joins.middle, half_width_at(stroke, joins.s / length_mm));
        path.follow(stroke, line, joins.s, length_mm);
    }
    out.stroke = path.with_properties_of(stroke);
    return out;
}

std::optional<StrokeWithEnd> pointed_end(const Stroke& stroke, const Brush& brush, Caps) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    const Line line(stroke, brush);
    const double length_mm = line.length(), depth = depth_of(stroke, brush, 1.0);
    const PathEnd end = path_end(stroke, line, Side::end);
    const double finest = std::max(brush.depth_range_mm[0], kTurnOverDepthMm), finest_mm = brush.half_width(finest);
    const double rear_mm = brush.tip_to_widest(depth);
    const double tip_mm = length_mm + end.half_mm, from_mm = tip_mm - rear_mm;
    const double last_mm = tip_mm - std::max(0.0, reach_beyond_end_mm(brush, finest, 0.0));
    if (!(length_mm > 0.0 && depth > finest && from_mm > 0.0 && last_mm > from_mm)) return {};
    StrokePath path;
    path.follow(stroke, line, 0.0, std::min(length_mm, last_mm));
    if (last_mm > length_mm) path.line_to(end.place(last_mm - length_mm, 0.0), end.half_mm);
    Stroke out = path.with_properties_of(stroke);
    const Stroke whole = out;
    const auto narrows = [&](const WidthKnot& knot) { return knot.at * last_mm > from_mm; };
    out.half_width.erase(std::find_if(out.half_width.begin(), out.half_width.end(), narrows), out.half_width.end());
    const Ring outline = footprint_at(brush.footprints, depth, 1.0);
    const auto n = Index(std::ceil(1.0 / kEndTuning.narrowing_step));
    for (Index k = 0; k <= n; ++k) {
        const double s = from_mm + (last_mm - from_mm) * double(k) / double(n), at = s / last_mm;
        const double half_mm = std::min(half_width_at(whole, at), half_across_mm(outline, tip_mm - s));
        out.half_width.push_back({at, std::max(finest_mm, half_mm)});
    }
    return StrokeWithEnd{std::move(out), {}};
}

std::optional<BrushMoves> turned_dot(const Stroke& stroke, const Brush& brush, Caps) {
    const double half_mm[] = {half_width_at(stroke, 0.0), half_width_at(stroke, 1.0)};
    if (Line(stroke, brush).length() > kEndTuning.max_dot_length * std::min(half_mm[0], half_mm[1])) return {};
    const auto from = depth_reaching_radius(stroke, brush, half_mm[0]),
               to = depth_reaching_radius(stroke, brush, half_mm[1]);
    if (!from || !to) return {};
    const Vector2d a = point_at(stroke.middle_mm, {0, 0.0});
    const Vector2d b = point_at(stroke.middle_mm, {stroke.middle_mm.rows() - 1, 1.0});
    if ((b - a).norm() <= 1e-6) return BrushMoves{{TurnRound{a, *from}}};
    const Vector2d along = (b - a).normalized();
    return BrushMoves{{TurnRound{a, *from, along}}, {TurnRound{b, *to, along}}};
}

std::optional<BrushMoves> dot_with_corners(const Stroke& stroke, const Brush& brush, Caps) {
    std::optional<BrushMoves> dot = turned_dot(stroke, brush);
    const double half_mm = std::min(half_width_at(stroke, 0.0), half_width_at(stroke, 1.0));
    const auto narrow = half_along_cut_mm(brush, half_mm);
    if (stroke.target_mm.empty() || !dot || !narrow) return {};
    Ring points(0, 2);
    for (const Ring& ring : stroke.target_mm) {
        points.conservativeResize(points.rows() + ring.rows(), Eigen::NoChange);
        points.bottomRows(ring.rows()) = ring;
    }
    const double least_mm = kEndTuning.min_corner_protrusion * *narrow;
    const Ring plain = remove_small_corners(convex_hull(points), least_mm);
    const Ring round = remove_small_corners(shrink_convex(plain, *narrow), least_mm);
    const Vector2d at = dot->back().turn->at_mm;
    const double radius_mm = std::min(half_mm, brush.half_width_range_mm()[1]);
    // otherwise a gap would stay bare between the disc and the narrow mark
    if (round.rows() < 3 ||
        !is_covered_by_moving_disc(dot->front().turn->at_mm, at, radius_mm, shrink_convex(plain, 2.0 * *narrow)))
        return {};
    const auto length_mm = [&](Index i) { return (corner(round, i + 1) - corner(round, i)).norm(); };
    Index longest = 0;
    for (Index i = 1; i < round.rows(); ++i)
        if (length_mm(i) > length_mm(longest)) longest = i;
    const Vector2d first =
        corner(round, longest) + kEndTuning.start_on_side * (corner(round, longest + 1) - corner(round, longest));
    StrokePath path(at, *narrow);
    path.line_to(first, *narrow);
    for (Index i = 1; i <= round.rows(); ++i) path.line_to(corner(round, longest + i), *narrow);
    path.line_to(first, *narrow);
    dot->push_back({{}, path.with_properties_of(stroke), 0.0, (first - at).norm(), path.length_mm()});
    return dot;
}

std::vector<FullTurn> find_full_turns(const PassMarks& marks) {
    // least angle of a full turn, and largest distance that P may creep during the turn
    constexpr double min_turn_rad = 6.0, max_creep_mm = 0.1;
    std::vector<FullTurn> found;
    double turned = 0.0, most = 0.0;
    std::size_t from = 0;
    for (std::size_t i = 1; i < marks.depth_mm.size(); ++i) {
        const bool rests = marks.depth_mm[i] > 0.0 && marks.depth_mm[i - 1] > 0.0 &&
                           (marks.contact_mm.row(Index(i)) - marks.contact_mm.row(Index(from))).norm() < max_creep_mm;
        if (!rests) {
            from = i;
            turned = most = 0.0;
            continue;
        }
        turned += std::remainder(marks.heading_rad[i] - marks.heading_rad[i - 1], 2.0 * EIGEN_PI);
        if (!(std::abs(turned) > std::max(most, min_turn_rad))) continue;
        if (most > 0.0)
            found.back().last = i;
        else
            found.push_back({from, i});
        most = std::abs(turned);
    }
    return found;
}

}  // namespace brushsvg
