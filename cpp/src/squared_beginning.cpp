#include "squared_beginning.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "drawn_cut.hpp"
#include "middle_line.hpp"
#include "stroke_ends.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// In half widths: how far it comes back along the side at the width that ran along the cut, where it is on the path
/// again, with all its width and its pointed rear on what is painted, and how far beyond that it was set down: less
/// leaves a notch between both.
constexpr double kAlongSide = 0.3, kJoins = 2.2, kSetDownBeyond = 0.4;

/// Half widths along a way that runs over a line, by the way [mm].
class Widths {
 public:
    Widths(const Stroke& stroke, double length_mm) : stroke_(stroke), length_mm_(length_mm) {}
    double at(double s) const { return half_width_at(stroke_, s / length_mm_); }
    void then(double way_mm, double half_mm) { found_.emplace_back(way_mm, half_mm); }
    /// Along the line from one arc length to another, back or on.
    void along(double way_mm, double from_mm, double to_mm) {
        std::vector<double> between;
        for (const WidthKnot& knot : stroke_.half_width)
            if ((knot.at * length_mm_ - from_mm) * (knot.at * length_mm_ - to_mm) < 0.0)
                between.push_back(knot.at * length_mm_);
        if (to_mm < from_mm) std::reverse(between.begin(), between.end());
        between.insert(between.begin(), from_mm);
        between.push_back(to_mm);
        for (const double s : between) then(way_mm + std::abs(s - from_mm), at(s));
    }
    std::vector<WidthKnot> knots() const {
        std::vector<WidthKnot> out;
        for (const auto& [s, half] : found_) out.push_back({s / found_.back().first, half});
        return out;
    }

 private:
    const Stroke& stroke_;
    double length_mm_;
    std::vector<std::pair<double, double>> found_;
};

/// Where on the path the way back begins: its tip is set down there, and the widest section is as far before it. None
/// where there is no room.
std::optional<double> set_down_mm(const Stroke& stroke, const Brush& brush, const Line& line, double half_mm) {
    const double length_mm = line.length(), widest_mm = (kJoins + kSetDownBeyond) * half_mm;
    if (widest_mm > length_mm || !rear_lies_inside(stroke, brush, line, widest_mm)) return {};
    const double rear_mm = brush.tip_to_widest(depth_of(stroke, brush, widest_mm / length_mm));
    const double from_mm =
        widest_mm + rear_mm - half_width_at(stroke, std::min(1.0, (widest_mm + rear_mm) / length_mm));
    if (from_mm > length_mm) return {};
    return std::max(from_mm, widest_mm);
}

}  // namespace

std::optional<SquaredBeginning> squared_beginning(const Stroke& stroke, const Brush& brush, Caps caps) {
    if (stroke.closed || brush.is_rigid() || !brush.width_follows_depth()) return {};
    const Stroke drawn = as_wide_as_painted(stroke, brush);
    const Line line(drawn, brush);
    const double length_mm = line.length(), half_mm = half_width_at(drawn, 0.0);
    const auto narrow = half_along_cut_mm(brush, half_mm);
    if (!narrow || !(length_mm > 0.0)) return {};
    const Sample first = line.at(0.0);
    const Vector2d along = -line.tangent(first);
    const PathEnd end{first.middle, along, {-along.y(), along.x()}, half_mm};
    const auto cut = cut_of(stroke, end, half_mm - *narrow, caps);
    const auto from_mm = set_down_mm(drawn, brush, line, half_mm);
    if (!cut || !from_mm) return {};

    const double lever = brush.lever_to_widest(brush.depth_for_half_width(*narrow, stroke.id));
    const double ahead_mm = leaves_ahead_mm(*cut, end);
    const Sample set_down = line.at(*from_mm), leaves = line.at(std::max(0.0, -ahead_mm)),
                 joins = line.at(kJoins * half_mm);

    Stroke out = drawn;
    out.middle_mm = reversed(part_of(drawn.middle_mm, leaves.place, set_down.place));
    Widths widths(drawn, length_mm);
    widths.along(0.0, *from_mm, leaves.s);
    Vector2d here = leaves.middle;
    double way_mm = *from_mm - leaves.s, reach_mm = (joins.middle - end.at_mm).norm() + lever;
    if (ahead_mm > 0.0) {
        here = end.place(ahead_mm, 0.0);
        append(out.middle_mm, here);
        way_mm += ahead_mm;
        widths.then(way_mm, half_mm);
    }
    Cubics way = way_along(*cut, end, here, *narrow, lever);
    const Vector2d corner = way.row(way.rows() - 1).tail<2>();
    const Vector2d aside = end.place(-kAlongSide * half_mm, end.left.dot(corner - end.at_mm));
    append(way, aside);
    for (Index i = 0; i < way.rows(); ++i) {
        way_mm += arc_length(way, i, 0.0, 1.0);
        widths.then(way_mm, *narrow);
        reach_mm = std::max(reach_mm, (way.row(i).tail<2>().transpose() - end.at_mm).norm() + lever);
    }
    append_way(out.middle_mm, way);
    append(out.middle_mm, joins.middle);
    way_mm += (joins.middle - aside).norm();
    widths.along(way_mm, joins.s, length_mm);
    const Cubics on = part_of(drawn.middle_mm, joins.place, {drawn.middle_mm.rows() - 1, 1.0});
    append_way(out.middle_mm, on);
    out.half_width = widths.knots();
    return SquaredBeginning{std::move(out), leaves.middle, aside, joins.middle, end.at_mm, -along, reach_mm};
}

}  // namespace brushsvg
