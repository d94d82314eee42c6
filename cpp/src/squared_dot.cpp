#include "squared_dot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "brushsvg/region.hpp"
#include "drawn_cut.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

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

Vector2d corner(const Ring& ring, Index i) { return ring.row((i + ring.rows()) % ring.rows()).transpose(); }

/// How far to the left of an edge a place lies.
double aside_mm(const Vector2d& from, const Vector2d& to, const Vector2d& at) {
    const Vector2d along = (to - from).normalized();
    return along.x() * (at - from).y() - along.y() * (at - from).x();
}

/// A convex ring without the corners that stick out by less, the least first.
Ring plainer(Ring convex, double least_mm) {
    while (convex.rows() > 3) {
        Index least = 0;
        double sticks_out_mm = least_mm;
        for (Index i = 0; i < convex.rows(); ++i) {
            const double out = -aside_mm(corner(convex, i - 1), corner(convex, i + 1), corner(convex, i));
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

/// What of a convex ring, counter-clockwise, lies so far within all its edges.
Ring within_edges(const Ring& convex, double by_mm) {
    Ring left = convex;
    for (Index i = 0; i < convex.rows(); ++i) {
        std::vector<Vector2d> kept;
        for (Index k = 0; k < left.rows(); ++k) {
            const Vector2d a = corner(left, k), b = corner(left, k + 1);
            const double at_a = aside_mm(corner(convex, i), corner(convex, i + 1), a) - by_mm,
                         at_b = aside_mm(corner(convex, i), corner(convex, i + 1), b) - by_mm;
            if (at_a >= 0.0) kept.push_back(a);
            if ((at_a < 0.0) != (at_b < 0.0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
        }
        left.resize(Index(kept.size()), 2);
        for (std::size_t k = 0; k < kept.size(); ++k) left.row(Index(k)) = kept[k].transpose();
    }
    return left;
}

/// Whether all corners lie within a disc that moves from one place to another.
bool covered_by(const Vector2d& from, const Vector2d& to, double half_mm, const Ring& corners) {
    const Vector2d way = to - from;
    for (Index i = 0; i < corners.rows(); ++i) {
        const Vector2d off = corners.row(i).transpose() - from;
        const double along = way.squaredNorm() > 0.0 ? std::clamp(off.dot(way) / way.squaredNorm(), 0.0, 1.0) : 0.0;
        if (!((off - along * way).norm() <= half_mm)) return false;
    }
    return true;
}

/// Once round a convex ring, from a place on one of its long sides: that which lies most ahead.
std::vector<Vector2d> way_round(const Ring& convex, const Dot& dot) {
    const auto length_mm = [&](Index i) { return (corner(convex, i + 1) - corner(convex, i)).norm(); };
    const auto place = [&](Index i) -> Vector2d {
        return (1.0 - kOnSide) * corner(convex, i) + kOnSide * corner(convex, i + 1);
    };
    double longest_mm = 0.0, most_ahead = -2.0;
    for (Index i = 0; i < convex.rows(); ++i) longest_mm = std::max(longest_mm, length_mm(i));
    Index side = 0;
    for (Index i = 0; i < convex.rows(); ++i) {
        const double ahead = (place(i) - dot.to_mm).normalized().dot(dot.heading);
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

std::optional<SquaredDot> squared_dot(const Stroke& stroke, const Brush& brush) {
    if (stroke.wanted_mm.empty()) return {};
    const std::optional<Dot> dot = dot_of(stroke, brush);
    if (!dot) return {};
    const Ring hull = convex_hull(all_corners(stroke.wanted_mm));
    const double half_mm = std::min(half_width_at(stroke, 0.0), half_width_at(stroke, 1.0));
    const double area_mm2 = area(stroke.wanted_mm);
    if (hull.rows() > kMostCorners) return {};
    if (area_mm2 < kFilled * signed_area(hull) || area_mm2 < (EIGEN_PI + kCorners) * half_mm * half_mm) return {};
    const auto narrow = half_along_cut_mm(brush, half_mm);
    if (!narrow) return {};
    const Ring plain = plainer(hull, kCornerSticksOut * *narrow);
    const Ring round = plainer(within_edges(plain, *narrow), kCornerSticksOut * *narrow);
    const double painted_mm = std::min(half_mm, brush.half_width_range_mm()[1]);
    if (round.rows() < 3 || !covered_by(dot->from_mm, dot->to_mm, painted_mm, within_edges(plain, 2.0 * *narrow)))
        return {};
    const Vector2d at = dot->to_mm;
    const std::vector<Vector2d> places = way_round(round, *dot);
    const double lever = brush.lever_to_widest(brush.depth_for_half_width(*narrow, stroke.id));
    SquaredDot out{*dot, stroke, lever, (places[0] - at).normalized(), 0.0};
    if (!((places[0] - at).norm() > lever)) return {};
    out.way.middle_mm.resize(0, 8);
    Vector2d here = at;
    for (const Vector2d& to : places) {
        Cubics& way = out.way.middle_mm;
        way.conservativeResize(way.rows() + 1, Eigen::NoChange);
        for (int i = 0; i < 4; ++i) way.row(way.rows() - 1).segment<2>(2 * i) = here + i / 3.0 * (to - here);
        out.reach_mm = std::max(out.reach_mm, (to - dot->from_mm).norm() + lever);
        here = to;
    }
    out.way.half_width = {{0.0, *narrow}, {1.0, *narrow}};
    return out;
}

}  // namespace brushsvg
