#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/stroke.hpp"
#include "inverse/middle_line.hpp"

namespace brushsvg {

/// Tuning of the end styles. Lengths are in half widths of the stroke at its end unless a unit is in the name.
struct EndTuning {
    /// Half the side of the square about an end in which trials are compared. A pointed footprint reaches back by 2.
    double view_half_side = 3.0;
    double min_view_half_width_mm = 1e-5;  ///< half width of a finer end in that square: no picture is finer
    double flattening_tolerance = 0.1;  ///< tolerance of the flattened path that shows which parts are near the square
    /// No footprint further from the square paints in it: a pointed one reaches back by 2.
    double footprint_reach = 3.0;
    double pixels_per_half_width = 8.0;  ///< pixels per half width in the picture of a trial
    /// How much less error a style needs than a plainer one, in squares of the half width. A pointed start lacks 1.5,
    /// two blunt corners lack 0.4, the shoulders of a blunt front 0.04. A larger value leaves blunt ends, a smaller one
    /// costs poses that nobody sees.
    double min_gain = 0.02;
    /// Like `min_gain`, where other strokes cover the end: less costs a quarter more poses.
    double min_gain_covered = 0.2;
    double max_end_gap = 0.05;  ///< how far a blunt front may stop short of the drawn end: less costs a pose

    double max_dot_length = 1.4;  ///< length of the longest dot: turned on the spot, a longer line shows a waist
    double max_hole = 0.1;        ///< largest hole about P, where the whole footprint is ahead of P
    /// Share of the radius of a front or a disc that hides a pointed rear. A larger value shows thorns, a smaller one a
    /// waist.
    double hiding_share = 0.8;
    /// Step between the knots of a narrowing, in lengths of the footprint's rear.
    double narrowing_step = 1.0 / 12.0;
    double min_narrowing_step_mm = 1e-3;  ///< where that length is 0: no finer change of a width is visible
    /// Largest distance from a line's start to the middle of the ball in which it begins.
    double max_ball_distance = 2.0;
    /// Where marks narrow faster, the brush is pressed deeper: a disc would be a knob.
    double max_wet_narrowing_per_m = 1e-3;

    double max_cap_distance = 0.2;  ///< largest distance of a path's end from the middle of its cap
    /// How far a cut may stray from its chord, and how far ahead it may be.
    double max_cut_deviation = 0.12, max_cut_distance = 2.5;
    /// Least and greatest half width of the mark along a cut. Its corners are as round as it is wide; a finer mark
    /// leaves a hole.
    double min_cut_half_width = 0.27, max_cut_half_width = 0.6;
    /// Least lever of the mark along a cut: a shorter one hardly pulls P, and the mark swings.
    double min_lever_mm = 0.15;
    /// Where the path leaves its line, before the cut: later the front sticks out, sooner it leaves a hole.
    double departure_before_cut = 1.15;
    double slant_lead = 0.25;  ///< how much sooner the path leaves its line where a cut is slanted by 45 degrees
    double min_set_down_cosine = 0.5;  ///< least cosine of the bend between the set-down of a butt start and its end
    /// Before the corner, the narrow mark reaches the edge here: later it leaves a step.
    double edge_before_corner = 0.45;
    /// End of the way back, before the path's end: covers the gap left by the front of the full width.
    double return_length = 0.3;
    double rejoin_distance = 2.2;  ///< where a butt start joins the path again, its rear on painted paper
    /// Where a butt start is set down, inside the stroke: less leaves a notch between both marks.
    double set_down_distance = 2.6;

    /// In half widths of the narrow mark: a corner of a dot sticks out by at least this much.
    double min_corner_protrusion = 0.1;
    /// Share of a dot's side, where the way round begins: in a corner it would swing out.
    double start_on_side = 0.7;
};
inline constexpr EndTuning kEndTuning;

enum class Side { start, end };

/// One end of a path: its place, the outward direction there, the direction to the left of that, and half the width.
struct PathEnd {
    Eigen::Vector2d at_mm, along, left;
    double half_mm;
    Eigen::Vector2d place(double ahead_mm, double left_mm) const { return at_mm + ahead_mm * along + left_mm * left; }
};
PathEnd path_end(const Stroke& stroke, const Line& line, Side side);

/// A middle line with half widths that is put together from pieces.
class StrokePath {
 public:
    StrokePath() = default;
    StrokePath(const Eigen::Vector2d& from_mm, double half_mm) : end_mm_(from_mm), half_mm_{{0.0, half_mm}} {}
    /// Append the part of a stroke between two arc lengths [mm], reversed if the second is the smaller one.
    void follow(const Stroke& stroke, const Line& line, double from_mm, double to_mm);
    /// Append a straight line. The half width changes evenly until its end.
    void line_to(const Eigen::Vector2d& to_mm, double half_mm);
    double length_mm() const { return half_mm_.back().first; }
    /// Return the path as a stroke with all other properties of a given one.
    Stroke with_properties_of(const Stroke& stroke) const;

 private:
    void append(const Cubics& more_mm);
    void add_width(double at_mm, double half_mm);

    Cubics middle_mm_{0, 8};
    Eigen::Vector2d end_mm_;
    std::vector<std::pair<double, double>> half_mm_;  // half widths by arc length [mm]
};

/// Return the stroke with its widths limited to the range that the brush can paint.
Stroke clamp_widths(const Stroke& stroke, const Brush& brush);

/// Return how far ahead of the end a ray first leaves the outline, at a distance to the left of the end [mm]. Infinite
/// if it does not.
double distance_to_outline_mm(const Rings& rings, const PathEnd& end, double left_mm);

/// A straight cut across an end. It is ahead of the path's end by `ahead_mm - slope * aside`.
struct Cut {
    double ahead_mm, slope;
};
/// How a path without an outline ends: with a round cap, or cut straight, half a width beyond its end.
enum class Caps { round, straight };
/// Find the cut that is drawn across an end, within a distance to both sides. None if the drawn end is not straight.
std::optional<Cut> find_cut(const Stroke& stroke, const PathEnd& end, double left_mm, Caps caps);

/// Return how far the front of the footprint reaches beyond the drawn end of a mark [mm]. The drawn end is half a width
/// beyond the path's end, where the widest section is. A negative value is the gap. The brush is lifted while P rests.
/// The front of a shallower footprint may be further ahead of P, so all depths down to 0 count.
double reach_beyond_end_mm(const Brush& brush, double depth, double half_width_mm);

/// Return where along the line the widest section starts and stops [mm]. The tip begins the mark and the footprint's
/// front ends it, half a width beyond the path's ends.
std::array<double, 2> painted_stretch(const Stroke& stroke, const Brush& brush, double length);

/// Return the stroke up to where the front of the footprint reaches the drawn end, half a width beyond the path's end.
/// With a blunt front, the path has to go beyond its own end.
Stroke extend_to_drawn_end(const Stroke& stroke, const Brush& brush);

/// Return the least value for which `holds` is true, between one where it is not and one where it is.
template <class Holds>
double bisect(double lo, double hi, Holds&& holds) {
    for (int i = 0; i < 50; ++i) {  // enough for double precision
        const double middle = 0.5 * (lo + hi);
        (holds(middle) ? hi : lo) = middle;
    }
    return hi;
}

}  // namespace brushsvg
