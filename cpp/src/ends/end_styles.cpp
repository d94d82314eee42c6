#include "ends/end_styles.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "brushsvg/footprint.hpp"
#include "brushsvg/region.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// What a style must win over a plainer one, in squares of the half width. A pointed beginning lacks 1.5, two blunt
/// corners lack 0.43, the shoulders of a blunt front 0.04.
constexpr double kWorthIt = 0.2, kWorthRound = 0.02;
/// Half widths: a line that is no longer is a dot.
constexpr double kLongestDot = 1.4;
/// Of a half width: a hole about P, where the whole footprint is ahead of it.
constexpr double kLargestHole = 0.1;
/// What counts as turned round on the spot, and how far P may creep meanwhile.
constexpr double kRoundRad = 6.0, kRestsMm = 0.02;

/// Shorter ways back that are tried where the whole one has no room.
constexpr int kShorter = 4;
/// Of the front of a footprint, and of a disc's radius, what is wide enough to hide a pointed rear.
constexpr double kHidingShare = 0.8, kHidingDisc = 0.9;
constexpr double kWithinReach = 0.999;
/// Steps of the depth and of the way in which the mark is narrowed for that, as shares of the whole.
constexpr double kNarrowingDepths = 1.0 / 64.0, kNarrowingWay = 1.0 / 12.0;
/// Steps in which a ball's middle is looked for, and how far from it the line's own mark may begin, in its half widths:
/// at 1.55 what a disc leaves of it is more than it wins.
constexpr int kSteps = 24;
constexpr double kBeforeBall = 1.3;
/// Half widths of its beginning after which a line is so much thinner where it begins in a ball.
constexpr double kOfBall = 3.0, kThinner = 0.85;
/// And how near to the line's beginning the mark is narrowed for a ball: as far behind it as a mark can be narrowed.
constexpr double kNearestHidden = 0.3;
/// In half widths: how much of the line is led anew to the middle of a cap. More would show next to the disc.
constexpr double kAnew = 0.8;
/// Of that, how far its handles reach.
constexpr double kHandles = 1.0 / 3.0;
/// A line that is not longer, in half widths, keeps its direction.
constexpr double kLongEnough = 1.0;
/// Per m, by which marks may narrow.
constexpr double kWet = 1e-3;

/// Width of the mark that runs along a cut, as shares of the stroke's: the finest of them that can be led. Its own
/// corners are as round as it is wide; finer ones leave a hole amid the end.
constexpr double kNarrowest = 0.27, kWidest = 0.6, kShareStep = 0.03;
/// Lever of a mark that is led into a corner: a widest section that hardly leads P swings about.
constexpr double kLeastLeverMm = 0.15;
/// In half widths before the cut: where the mark leaves the path at its full width, how much sooner where the cut is
/// slanted, and where it is narrow and beside the edge. Later the front sticks out of a slanted cut, sooner it leaves a
/// hole or a step.
constexpr double kLeaves = 1.15, kSlantedLeaves = 0.25, kBesideEdge = 0.5;
/// And how far before its corner it has to be there.
constexpr double kBeforeCorner = 0.2;
/// The slope from which on a cut is slanted in full.
constexpr double kSlanted = 0.6;
/// A corner beyond 90 degrees is taken in two, so many levers apart, or the mark would swing out of it.
constexpr double kChamfer = 0.3;
/// In half widths: how far a squared end goes back, where it covers what the front of the full width leaves; and a
/// stroke shorter than that has no room for an end next to its beginning.
constexpr double kBack = 0.8, kShortest = 2.0;
/// In half widths: how far a squared start comes back along the side, where it is on the path again, with all its width
/// and its pointed rear on what is painted, and how far beyond that it was set down: less leaves a notch between both.
constexpr double kAlongSide = 0.3, kJoins = 2.2, kSetDownBeyond = 0.4;

/// A hull of more corners is none of a dot with few.
constexpr Index kMostCorners = 2000;
/// Of the hull of what is drawn, what a dot with corners fills; and what of it no disc as wide paints, in squares of
/// the half width: a square has 0.86, one with round corners, as pens make them, half of that.
constexpr double kFilled = 0.92, kCorners = 0.2;
/// Of the narrow mark's half width: corners that stick out by less are none of their own.
constexpr double kCornerSticksOut = 0.1;
/// Where on a side the way begins, of its length: into a corner it would turn by more than 90 degrees, and swing out of
/// it. And what counts as a long side, of the longest.
constexpr double kOnSide = 0.7, kLongSide = 0.5;

bool can_turn(const Stroke& stroke, const Brush& brush) {
    return !stroke.closed && !brush.is_rigid() && brush.width_follows_depth();
}

/// Press depth at which a footprint that is turned on the spot reaches so far; none where that leaves a hole about P,
/// or the least depth reaches farther already; the greatest depth where none reaches so far.
std::optional<double> depth_of_turn(const Brush& brush, double radius_mm) {
    const double least = std::max(brush.depth_range_mm[0], 1e-3), most = brush.depth_range_mm[1];
    const auto too_far = [&](double depth) { return reach_of_turn_mm(brush, depth) > radius_mm; };
    if (too_far(least)) return {};
    const double depth = too_far(most) ? bisect(least, most, too_far) : most;
    if (-brush.tip_gap(depth) > kLargestHole * radius_mm) return {};
    return depth;
}

double lever_at(const Stroke& stroke, const Brush& brush, const Line& line, double s) {
    return brush.lever_to_widest(depth_of(stroke, brush, std::clamp(s / line.length(), 0.0, 1.0)));
}

/// A stroke narrowed near its beginning so that the rear of its footprint stays behind an arc length, and from where on
/// it has all its width.
struct Narrowed {
    Stroke stroke;
    double full_from_mm;
};
std::optional<Narrowed> narrowed(const Stroke& stroke, const Brush& brush, double length_mm, double from_mm) {
    const double step_mm = kNarrowingWay * brush.tip_to_widest(depth_of(stroke, brush, 0.0));
    std::vector<WidthKnot> knots;
    for (double s = 0.0; s < length_mm; s += step_mm) {
        const double at = s / length_mm, wanted = depth_of(stroke, brush, at);
        double depth = wanted;
        while (depth > 0.0 && s - brush.tip_to_widest(depth) < from_mm) depth -= kNarrowingDepths * wanted;
        if (!(depth > brush.depth_range_mm[0])) return {};
        knots.push_back({at, brush.half_width(depth)});
        if (depth < wanted) continue;
        if (knots.size() == 1) return Narrowed{stroke, s};
        Stroke out = stroke;
        knots.back().half_width_mm = half_width_at(stroke, at);
        for (const WidthKnot& knot : stroke.half_width)
            if (knot.at > at) knots.push_back(knot);
        out.half_width = std::move(knots);
        return Narrowed{std::move(out), s};
    }
    return {};
}

/// Set down heading back along the line, drawn back until the widest section is at an arc length, less than 0 before
/// the line; there turned round, or only over, and on along the line.
std::optional<BrushMoves> drawn_back(const Stroke& stroke, const Brush& brush, const Line& line, double until_mm,
                                     const Narrowed& onward, const std::optional<TurnRound>& turn) {
    const double last_mm = painted_stretch(stroke, brush, line.length())[1], lever = lever_at(stroke, brush, line, 0.0);
    // as far back as it goes on from with all its width, or what there is room for; less leaves a waist
    const double way_mm = std::max(2.0 * lever, onward.full_from_mm - until_mm);
    double from_mm = until_mm + way_mm;
    for (int tries = 0; from_mm > last_mm || !rear_lies_inside(stroke, brush, line, std::max(from_mm, 0.0)); ++tries) {
        if (tries == kShorter || turn) return {};
        from_mm -= way_mm / kShorter;
    }
    if (!(from_mm > std::max(until_mm, 0.0))) return {};
    StrokePath back;
    back.follow(stroke, line, from_mm, std::max(until_mm, 0.0));
    const PathEnd start = path_end(stroke, line, Side::start);
    if (until_mm < 0.0) back.line_to(start.place(-until_mm, 0.0), start.half_mm);
    BrushMove first{{}, back.like(stroke), 0.0, 0.0, back.length_mm()};
    for (const WidthKnot& knot : first.line->half_width)
        if (!(brush.lever_to_widest(brush.depth_for_half_width(knot.half_width_mm, stroke.id)) > 0.0)) return {};
    const double earliest_mm = turn ? 0.0 : std::max(0.0, until_mm + lever);
    BrushMove second{turn, onward.stroke, earliest_mm, std::min(until_mm + 4.0 * lever, last_mm), last_mm};
    return BrushMoves{std::move(first), std::move(second)};
}

/// Turned round where the line is widest, then on along it.
std::optional<BrushMoves> turned_on_the_spot(const Stroke& stroke, const Brush& brush, const Line& line, double at_mm,
                                             double radius_mm, double depth) {
    const double hidden_mm = at_mm > 0.0 ? std::min(at_mm - kHidingDisc * radius_mm, -kNearestHidden * radius_mm)
                                         : -kHidingDisc * radius_mm;
    auto onward = narrowed(stroke, brush, line.length(), hidden_mm);
    if (!onward) return {};
    return BrushMoves{{TurnRound{line.at(at_mm).middle, depth}, std::move(onward->stroke), at_mm,
                       std::min(at_mm + 2.0 * radius_mm, line.length()),
                       painted_stretch(stroke, brush, line.length())[1]}};
}

/// A stroke as wide as painted, led to the middle of the round cap at its end: where a line of a shape ends, it may be
/// next to that, or bend. None where the drawn end is not round, or marks narrow as paint runs out: a patch that is
/// pressed deeper for it, turned round, paints as large a disc as a wet one, a knob.
struct ToCap {
    Stroke stroke;
    Cap cap;
};
std::optional<ToCap> led_to_cap(const Stroke& stroke, const Brush& brush) {
    const Stroke painted = as_wide_as_painted(stroke, brush);
    const Line line(painted, brush);
    const double length_mm = line.length();
    if (stroke.closed || !(length_mm > 0.0) || (brush.paint && brush.paint->narrows_per_m > kWet)) return {};
    const PathEnd end = path_end(painted, line, Side::end);
    const auto cap = find_cap(stroke, end);
    if (!cap) return {};
    if (stroke.wanted_mm.empty() || !(length_mm > kLongEnough * end.half_mm)) return ToCap{painted, *cap};
    const Sample from = line.at(length_mm - kAnew * end.half_mm);
    const Vector2d to = cap->middle_mm - from.middle, leaving = line.tangent(from);
    if (!(to.dot(leaving) > 0.0)) return {};
    Cubics anew(1, 8);
    anew << from.middle.transpose(), (from.middle + kHandles * to.norm() * leaving).transpose(),
        (cap->middle_mm - kHandles * to).transpose(), cap->middle_mm.transpose();
    StrokePath path;
    path.follow(painted, line, 0.0, from.s);
    path.curve_to(anew, end.half_mm);
    return ToCap{path.like(painted), *cap};
}

Stroke reversed(const Stroke& stroke, const Brush& brush) {
    const Line line(stroke, brush);
    if (!(line.length() > 0.0)) return stroke;
    StrokePath path;
    path.follow(stroke, line, line.length(), 0.0);
    return path.like(stroke);
}

/// Arc length where the line is widest near its beginning, as amid the ball that it begins in: lines of shapes begin
/// next to its middle, and narrower.
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

bool begins_in_ball(const Stroke& stroke, double length_mm) {
    const double half_mm = half_width_at(stroke, 0.0);
    return half_width_at(stroke, std::min(1.0, kOfBall * half_mm / length_mm)) < kThinner * half_mm;
}

/// The line between two arc lengths with nothing before it.
BrushMoves led_from_tip(Stroke stroke, const Brush& brush) {
    const auto [s0, s1] = painted_stretch(stroke, brush, Line(stroke, brush).length());
    return {{{}, std::move(stroke), s0, s0, s1}};
}

/// Pointed, as a footprint is behind.
std::optional<BrushMoves> exposed_start(const Stroke& stroke, const Brush& brush, Caps) {
    return led_from_tip(stroke, brush);
}

/// Drawn back until the round front of the footprint reaches the drawn beginning.
std::optional<BrushMoves> hidden_start(const Stroke& stroke, const Brush& brush, Caps) {
    const Line line(stroke, brush);
    if (stroke.closed || brush.is_rigid() || !(line.length() > 0.0)) return {};
    const double lever = lever_at(stroke, brush, line, 0.0), half_mm = half_width_at(stroke, 0.0);
    if (!(lever > 0.0)) return {};
    const double turn_mm = reach_beyond_end_mm(brush, depth_of(stroke, brush, 0.0), half_mm);
    const auto onward = narrowed(stroke, brush, line.length(), turn_mm - kHidingShare * (turn_mm + half_mm));
    if (!onward) return {};
    // P may not rest so far before the path that its first point is out of reach
    const double reach_mm = kWithinReach * (lever + lever_at(onward->stroke, brush, line, 0.0));
    return drawn_back(stroke, brush, line, std::max(turn_mm, -reach_mm), *onward, {});
}

/// Turned round in the cap or ball in which the stroke begins. Where there is room the brush comes into a cap on a way
/// back at the full width.
std::optional<BrushMoves> turned_start(const Stroke& stroke, const Brush& brush, Caps) {
    if (!can_turn(stroke, brush)) return {};
    const Line line(stroke, brush);
    if (!(line.length() > kLongestDot * half_width_at(stroke, 0.0))) return {};
    const bool is_ball = begins_in_ball(stroke, line.length());
    if (stroke.start_covered && !is_ball) return {};
    if (!is_ball)
        if (auto to_cap = led_to_cap(reversed(stroke, brush), brush)) {
            const Stroke led = reversed(to_cap->stroke, brush);
            const Line led_line(led, brush);
            const double radius_mm = to_cap->cap.radius_mm;
            const auto depth = depth_of_turn(brush, radius_mm);
            if (!depth) return {};
            std::optional<BrushMoves> found;
            if (const auto onward = narrowed(led, brush, led_line.length(), -kHidingDisc * radius_mm);
                onward && *depth < depth_of(led, brush, 0.0) && lever_at(led, brush, led_line, 0.0) > 0.0)
                found = drawn_back(led, brush, led_line, 0.0, *onward, TurnRound{led_line.at(0.0).middle, *depth});
            return found ? found : turned_on_the_spot(led, brush, led_line, 0.0, radius_mm, *depth);
        }
    const double at_mm = ball_mm(stroke, line.length()), half_mm = half_width_at(stroke, at_mm / line.length());
    const auto depth = depth_of_turn(brush, half_mm);
    if (!depth) return {};
    return turned_on_the_spot(stroke, brush, line, at_mm, half_mm, *depth);
}

std::optional<BrushMoves> squared_start(const Stroke& stroke, const Brush& brush, Caps caps) {
    if (auto found = squared(stroke, brush, caps, Side::start)) return led_from_tip(std::move(found->stroke), brush);
    return {};
}

/// Lifted while the patch rests: as the footprint is in front.
std::optional<EndedStroke> lifted_end(const Stroke& stroke, const Brush& brush, Caps) {
    return EndedStroke{up_to_drawn_end(stroke, brush), {}};
}

std::optional<EndedStroke> squared_end(const Stroke& stroke, const Brush& brush, Caps caps) {
    if (auto found = squared(stroke, brush, caps, Side::end)) return EndedStroke{std::move(found->stroke), {}};
    return {};
}

/// Half the width of the mark that runs along a cut, none where the brush is too coarse for one.
std::optional<double> half_along_cut_mm(const Brush& brush, double half_mm) {
    for (double share = kNarrowest; share < kWidest + 0.5 * kShareStep; share += kShareStep) {
        if (share * half_mm < brush.half_width_range_mm()[0]) continue;
        const double depth = brush.depth_for_half_width(share * half_mm, "");
        if (brush.lever_to_widest(depth) > kLeastLeverMm) return share * half_mm;
    }
    return {};
}

double slant(const Cut& cut) { return std::min(1.0, std::abs(cut.slope) / kSlanted); }

/// The way of a narrow mark from where it leaves the path: beside the edge, into the corner that is farther ahead,
/// where that is blunt as a chamfer, which a lever follows, along the cut, and into the other corner.
std::vector<Vector2d> places_along(const Cut& cut, const PathEnd& end, double narrow_mm, double lever_mm) {
    const double aside = end.half_mm - narrow_mm, first = cut.slope > 0.0 ? -aside : aside;
    const auto ahead = [&](double y) { return cut.ahead_mm - cut.slope * y - narrow_mm * std::hypot(1.0, cut.slope); };
    const Vector2d a = end.place(ahead(first), first), b = end.place(ahead(-first), -first);
    const double beside =
        std::min(cut.ahead_mm - kBesideEdge * end.half_mm, ahead(first) - kBeforeCorner * end.half_mm);
    std::vector<Vector2d> way{end.place(beside, first)};
    const double chamfer = std::min(kChamfer * slant(cut) * lever_mm, 0.3 * (b - a).norm());
    if (chamfer > 0.0) way.push_back(a - chamfer * end.along);
    way.push_back(a + chamfer * (b - a).normalized());
    way.push_back(b);
    return way;
}

/// Where on the path the way back of a squared start begins: its tip is set down there, and the widest section is as
/// far before it. None where there is no room.
std::optional<double> set_down_mm(const Stroke& stroke, const Brush& brush, const Line& line, double half_mm) {
    const double length_mm = line.length(), widest_mm = (kJoins + kSetDownBeyond) * half_mm;
    if (widest_mm > length_mm || !rear_lies_inside(stroke, brush, line, widest_mm)) return {};
    const double rear_mm = brush.tip_to_widest(depth_of(stroke, brush, widest_mm / length_mm));
    const double from_mm =
        widest_mm + rear_mm - half_width_at(stroke, std::min(1.0, (widest_mm + rear_mm) / length_mm));
    if (from_mm > length_mm) return {};
    return std::max(from_mm, widest_mm);
}

Vector2d corner(const Ring& ring, Index i) { return ring.row((i + ring.rows()) % ring.rows()).transpose(); }

/// How far to the left of an edge a place is.
double left_of_mm(const Vector2d& from, const Vector2d& to, const Vector2d& at) {
    const Vector2d along = (to - from).normalized();
    return along.x() * (at - from).y() - along.y() * (at - from).x();
}

/// A convex ring without the corners that stick out by less, the least first.
Ring with_few_corners(Ring convex, double least_mm) {
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

/// The part of a convex ring, counter-clockwise, that is so far within all its edges.
Ring within_edges(const Ring& convex, double by_mm) {
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

/// Whether all corners are within a disc that moves from one place to another.
bool covered_by(const Vector2d& from, const Vector2d& to, double half_mm, const Ring& corners) {
    const Vector2d way = to - from;
    for (Index i = 0; i < corners.rows(); ++i) {
        const Vector2d off = corners.row(i).transpose() - from;
        const double along = way.squaredNorm() > 0.0 ? std::clamp(off.dot(way) / way.squaredNorm(), 0.0, 1.0) : 0.0;
        if (!((off - along * way).norm() <= half_mm)) return false;
    }
    return true;
}

/// Once round a convex ring, from a place on one of its long sides: that which is most ahead.
std::vector<Vector2d> way_round(const Ring& convex, const TurnRound& turn) {
    const auto length_mm = [&](Index i) { return (corner(convex, i + 1) - corner(convex, i)).norm(); };
    const auto place = [&](Index i) -> Vector2d {
        return (1.0 - kOnSide) * corner(convex, i) + kOnSide * corner(convex, i + 1);
    };
    double longest_mm = 0.0, most_ahead = -2.0;
    for (Index i = 0; i < convex.rows(); ++i) longest_mm = std::max(longest_mm, length_mm(i));
    Index side = 0;
    for (Index i = 0; i < convex.rows(); ++i) {
        const double ahead = (place(i) - turn.at_mm).normalized().dot(turn.ends_heading);
        if (length_mm(i) < kLongSide * longest_mm || !(ahead > most_ahead)) continue;
        side = i;
        most_ahead = ahead;
    }
    std::vector<Vector2d> out{place(side)};
    for (Index i = 1; i <= convex.rows(); ++i) out.push_back(corner(convex, side + i));
    out.push_back(out.front());
    return out;
}

Ring all_corners(const Rings& rings) {
    Index count = 0;
    for (const Ring& ring : rings) count += ring.rows();
    Ring out(count, 2);
    count = 0;
    for (const Ring& ring : rings) {
        out.middleRows(count, ring.rows()) = ring;
        count += ring.rows();
    }
    return out;
}

}  // namespace

const std::array<StartStyle, 4> kStartStyles{{{Beginning::exposed, 0.0, exposed_start},
                                              {Beginning::hidden, kWorthIt, hidden_start},
                                              {Beginning::turned, kWorthRound, turned_start},
                                              {Beginning::squared, kWorthIt, squared_start}}};
const std::array<StartStyle, 3> kDotStyles{
    {{Beginning::exposed, 0.0, exposed_start}, {Beginning::hidden, kWorthIt, turned_dot}, {Beginning::squared, kWorthIt, squared_dot}}};
const std::array<EndStyle, 3> kEndStyles{
    {{Ending::lifted, 0.0, lifted_end}, {Ending::squared, kWorthIt, squared_end}, {Ending::automatic, kWorthRound, turned_end}}};

double reach_of_turn_mm(const Brush& brush, double depth) {
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

std::optional<EndedStroke> turned_end(const Stroke& stroke, const Brush& brush, Caps) {
    if (!can_turn(stroke, brush) || stroke.end_covered) return {};
    auto to_cap = led_to_cap(stroke, brush);
    if (!to_cap) return {};
    const double full_depth = depth_of(to_cap->stroke, brush, 1.0);
    const auto depth = depth_of_turn(brush, to_cap->cap.radius_mm);
    if (!depth || *depth >= full_depth || !(brush.lever_to_widest(full_depth) > 0.0)) return {};
    return EndedStroke{std::move(to_cap->stroke), depth};
}

std::optional<Squared> squared(const Stroke& stroke, const Brush& brush, Caps caps, Side side) {
    if (!can_turn(stroke, brush)) return {};
    const bool at_start = side == Side::start;
    const Stroke drawn = as_wide_as_painted(stroke, brush);
    const Line line(drawn, brush);
    const double length_mm = line.length(), half_mm = half_width_at(drawn, at_start ? 0.0 : 1.0);
    const auto narrow = half_along_cut_mm(brush, half_mm);
    if (!narrow || !(length_mm > 0.0) || length_mm < kShortest * half_mm) return {};
    const PathEnd end = path_end(drawn, line, side);
    const auto cut = find_cut(stroke, end, half_mm - *narrow, caps);
    const auto from_mm = at_start ? set_down_mm(drawn, brush, line, half_mm) : std::optional(0.0);
    if (!cut || !from_mm) return {};

    const double lever = brush.lever_to_widest(brush.depth_for_half_width(*narrow, stroke.id));
    const double ahead_mm = cut->ahead_mm - (kLeaves + kSlantedLeaves * slant(*cut)) * half_mm;
    const double before_mm = std::max(0.0, -ahead_mm);
    const Sample leaves = line.at(at_start ? before_mm : length_mm - before_mm);
    StrokePath path;
    path.follow(drawn, line, *from_mm, leaves.s);
    if (ahead_mm > 0.0) path.line_to(end.place(ahead_mm, 0.0), half_mm);
    std::vector<Vector2d> way = places_along(*cut, end, *narrow, lever);
    const Vector2d last = way.back();
    way.push_back(at_start ? end.place(-kAlongSide * half_mm, end.left.dot(last - end.at_mm))
                           : Vector2d(last - kBack * half_mm * end.along));
    double reach_mm = before_mm;
    for (const Vector2d& place : way) {
        path.line_to(place, *narrow);
        reach_mm = std::max(reach_mm, (place - end.at_mm).norm() + lever);
    }
    Squared out{{}, end, leaves.middle, way.back(), leaves.middle, reach_mm};
    if (at_start) {
        const Sample joins = line.at(kJoins * half_mm);
        out.joins_mm = joins.middle;
        out.reach_mm = std::max(reach_mm, (joins.middle - end.at_mm).norm() + lever);
        path.line_to(joins.middle, half_width_at(drawn, joins.s / length_mm));
        path.follow(drawn, line, joins.s, length_mm);
    }
    out.stroke = path.like(drawn);
    return out;
}

std::optional<BrushMoves> turned_dot(const Stroke& stroke, const Brush& brush, Caps) {
    if (!can_turn(stroke, brush)) return {};
    const double half_mm[] = {half_width_at(stroke, 0.0), half_width_at(stroke, 1.0)};
    if (Line(stroke, brush).length() > kLongestDot * std::min(half_mm[0], half_mm[1])) return {};
    const auto from = depth_of_turn(brush, half_mm[0]), to = depth_of_turn(brush, half_mm[1]);
    if (!from || !to) return {};
    const Vector2d a = point_at(stroke.middle_mm, {0, 0.0});
    const Vector2d b = point_at(stroke.middle_mm, {stroke.middle_mm.rows() - 1, 1.0});
    if ((b - a).norm() <= 1e-6) return BrushMoves{{TurnRound{a, *from}}};
    const Vector2d along = (b - a).normalized();
    return BrushMoves{{TurnRound{a, *from, along}}, {TurnRound{b, *to, along}}};
}

std::optional<BrushMoves> squared_dot(const Stroke& stroke, const Brush& brush, Caps) {
    if (stroke.wanted_mm.empty()) return {};
    std::optional<BrushMoves> dot = turned_dot(stroke, brush);
    if (!dot) return {};
    const TurnRound &from = *dot->front().turn, &to = *dot->back().turn;
    const Ring hull = convex_hull(all_corners(stroke.wanted_mm));
    const double half_mm = std::min(half_width_at(stroke, 0.0), half_width_at(stroke, 1.0));
    const double area_mm2 = area(stroke.wanted_mm);
    if (hull.rows() > kMostCorners) return {};
    if (area_mm2 < kFilled * signed_area(hull) || area_mm2 < (EIGEN_PI + kCorners) * half_mm * half_mm) return {};
    const auto narrow = half_along_cut_mm(brush, half_mm);
    if (!narrow) return {};
    const Ring plain = with_few_corners(hull, kCornerSticksOut * *narrow);
    const Ring round = with_few_corners(within_edges(plain, *narrow), kCornerSticksOut * *narrow);
    const double painted_mm = std::min(half_mm, brush.half_width_range_mm()[1]);
    if (round.rows() < 3 || !covered_by(from.at_mm, to.at_mm, painted_mm, within_edges(plain, 2.0 * *narrow)))
        return {};
    const std::vector<Vector2d> places = way_round(round, to);
    const double lever = brush.lever_to_widest(brush.depth_for_half_width(*narrow, stroke.id));
    if (!((places[0] - to.at_mm).norm() > lever)) return {};
    Stroke way = stroke;
    way.half_width = {{0.0, *narrow}, {1.0, *narrow}};
    way.middle_mm.resize(1, 8);
    for (int i = 0; i < 4; ++i)
        way.middle_mm.row(0).segment<2>(2 * i) = to.at_mm + i / 3.0 * (places[0] - to.at_mm);
    const Line first(way, brush);
    StrokePath path;
    path.follow(way, first, 0.0, first.length());
    for (std::size_t i = 1; i < places.size(); ++i) path.line_to(places[i], *narrow);
    dot->push_back({{}, path.like(way), 0.0, first.length(), path.length_mm()});
    return dot;
}

std::vector<Turned> turned_round(const PassMarks& marks) {
    std::vector<Turned> found;
    double turned = 0.0, most = 0.0;
    std::size_t from = 0;
    for (std::size_t i = 1; i < marks.depth_mm.size(); ++i) {
        const bool rests = marks.depth_mm[i] > 0.0 && marks.depth_mm[i - 1] > 0.0 &&
                           (marks.contact_mm.row(Index(i)) - marks.contact_mm.row(Index(from))).norm() < kRestsMm;
        if (!rests) {
            from = i;
            turned = most = 0.0;
            continue;
        }
        turned += std::remainder(marks.heading_rad[i] - marks.heading_rad[i - 1], 2.0 * EIGEN_PI);
        if (!(std::abs(turned) > std::max(most, kRoundRad))) continue;
        if (most > 0.0)
            found.back().last = i;
        else
            found.push_back({from, i});
        most = std::abs(turned);
    }
    return found;
}

}  // namespace brushsvg
