#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/stroke.hpp"
#include "middle_line.hpp"

namespace brushsvg {

enum class Side { start, end };

/// One end of a path: its place, the direction there out of the stroke and to the left of that, and half the width.
struct PathEnd {
    Eigen::Vector2d at_mm, along, left;
    double half_mm;
    Eigen::Vector2d place(double ahead_mm, double aside_mm) const { return at_mm + ahead_mm * along + aside_mm * left; }
};
PathEnd path_end(const Stroke& stroke, const Line& line, Side side);

/// A middle line with half widths that is put together from pieces.
class StrokePath {
 public:
    /// Appends the part of a stroke between two arc lengths [mm], reversed where the second is the smaller one.
    void follow(const Stroke& stroke, const Line& line, double from_mm, double to_mm);
    /// Appends a straight line. The half width changes evenly until its end.
    void line_to(const Eigen::Vector2d& to_mm, double half_mm);
    void curve_to(const Cubics& curve_mm, double half_mm);
    double length_mm() const { return half_mm_.back().first; }
    /// The path as a stroke with all other properties of a given one.
    Stroke like(const Stroke& stroke) const;

 private:
    void append(const Cubics& more_mm);
    void add_width(double at_mm, double half_mm);

    Cubics middle_mm_{0, 8};
    std::vector<std::pair<double, double>> half_mm_;  // by arc length [mm]
};

/// The stroke as wide as the brush can paint it.
Stroke as_wide_as_painted(const Stroke& stroke, const Brush& brush);

/// A round cap: a circle, half of which is drawn.
struct Cap {
    Eigen::Vector2d middle_mm;
    double radius_mm;
};
/// Find the round cap that is drawn at an end. A path without an outline has one as wide as itself. None where the
/// drawn end is not round.
std::optional<Cap> find_cap(const Stroke& stroke, const PathEnd& end);

/// A straight cut across an end: ahead of the path's end by `ahead_mm - slope * aside`.
struct Cut {
    double ahead_mm, slope;
};
/// How a path with a width alone ends: as strokes with round caps do, or cut straight, half a width beyond its end.
enum class Caps { round, straight };
/// Find the cut that is drawn across an end, looked at so far to both sides. None where the drawn end is not straight.
std::optional<Cut> find_cut(const Stroke& stroke, const PathEnd& end, double aside_mm, Caps caps);

/// How far the front of the footprint reaches beyond the drawn end of a mark [mm], which is half a width from its
/// path's, with the widest section over that. Less than 0 is what is missing. The brush is lifted while P rests, and
/// the front of a shallower footprint may be further ahead of P, so all depths down to 0 count.
double reach_beyond_end_mm(const Brush& brush, double depth, double half_width_mm);

/// Where along the line the widest section starts and stops [mm]: the tip begins the mark and the footprint's front
/// ends it, half a width beyond the path's ends.
std::array<double, 2> painted_stretch(const Stroke& stroke, const Brush& brush, double length);

/// The stroke up to where the front of the footprint reaches the drawn end, half a width beyond the path's: a blunt one
/// has to go beyond that itself.
Stroke up_to_drawn_end(const Stroke& stroke, const Brush& brush);

/// Whether the pointed rear of a footprint that is set down heading back along the line stays inside the stroke.
bool rear_lies_inside(const Stroke& stroke, const Brush& brush, const Line& line, double widest_mm);

/// The least value for which `holds` is true, between one where it is not and one where it is.
template <class Holds>
double bisect(double lo, double hi, Holds&& holds) {
    for (int i = 0; i < 50; ++i) {  // to rounding
        const double middle = 0.5 * (lo + hi);
        (holds(middle) ? hi : lo) = middle;
    }
    return hi;
}

}  // namespace brushsvg
