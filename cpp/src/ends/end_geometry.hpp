#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/stroke.hpp"
#include "middle_line.hpp"

namespace brushsvg {

/// What the end styles are tuned by. Lengths are in half widths of the stroke at its end unless a unit is in the name.
struct EndTuning {
    /// Half a side of the square about an end that trials look at. A pointed footprint reaches back by 2.
    double looked_at = 3.0;
    double flat = 0.1;       ///< a path is flattened so to find what is near the square
    double footprint = 3.0;  ///< further from the square no footprint paints in it: a pointed one reaches back by 2
    double pixels = 8.0;     ///< of a trial's picture on one half width
    /// What a style must win over a plainer one, in squares of the half width. A pointed start lacks 1.5, two blunt
    /// corners lack 0.4, the shoulders of a blunt front 0.04. More leaves blunt ends, less costs poses that nobody
    /// sees.
    double worth = 0.02;
    double worth_covered = 0.2;  ///< the same where other strokes cover the end: less costs a quarter more poses
    double short_of_end = 0.05;  ///< what a blunt front may stay short of the drawn end: less costs a pose

    double longest_dot = 1.4;   ///< a longer line is no dot: turned on the spot it shows a waist
    double largest_hole = 0.1;  ///< about P, where the whole footprint is ahead of it
    /// Of a front or a disc, what is wide enough to hide a pointed rear: more shows thorns, less a waist.
    double hiding = 0.8;
    double narrowing_step = 1.0 / 12.0;  ///< in lengths of the footprint's rear
    double ball_within = 2.0;            ///< where a line begins in a ball, the middle of the ball is so near
    double wet_narrows_per_m = 1e-3;     ///< paint that runs out faster is pressed deeper: a disc would be a knob

    double cap_off = 0.2;  ///< a path that ends further from the middle of its cap ends in no cap
    double cut_straight = 0.12, cut_farthest = 2.5;  ///< how far a cut may stray from its chord, and be ahead
    /// Half width of the mark that runs along a cut. Its corners are as round as it is wide; a finer one leaves a hole.
    double narrowest = 0.27, widest_narrow = 0.6;
    double least_lever_mm = 0.15;        ///< of that mark: a shorter one hardly pulls P, and the mark swings
    double leaves_before_cut = 1.15;     ///< later the front sticks out, sooner it leaves a hole
    double slanted = 0.25;               ///< and so much sooner where a cut is slanted by 45 degrees
    double straight_back = 0.5;          ///< cosine by which a way back may bend
    double beside_before_corner = 0.45;  ///< where the narrow mark has come to the edge: later it leaves a step
    double back = 0.3;                   ///< before the path's end: covers what the front of the full width leaves
    double joins = 2.2;                  ///< a butt start is on the path again, its rear on what is painted
    double set_down = 2.6;               ///< and was set down so far inside: less leaves a notch between both

    double corner_sticks_out = 0.1;  ///< of the narrow mark's half width: less is no corner of a dot
    double on_side = 0.7;            ///< of a dot's side, where the way round begins: in a corner it would swing out
};
inline constexpr EndTuning kTuning;

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
    StrokePath() = default;
    StrokePath(const Eigen::Vector2d& from_mm, double half_mm) : here_mm_(from_mm), half_mm_{{0.0, half_mm}} {}
    /// Appends the part of a stroke between two arc lengths [mm], reversed where the second is the smaller one.
    void follow(const Stroke& stroke, const Line& line, double from_mm, double to_mm);
    /// Appends a straight line. The half width changes evenly until its end.
    void line_to(const Eigen::Vector2d& to_mm, double half_mm);
    double length_mm() const { return half_mm_.back().first; }
    /// The path as a stroke with all other properties of a given one.
    Stroke like(const Stroke& stroke) const;

 private:
    void append(const Cubics& more_mm);
    void add_width(double at_mm, double half_mm);

    Cubics middle_mm_{0, 8};
    Eigen::Vector2d here_mm_;
    std::vector<std::pair<double, double>> half_mm_;  // by arc length [mm]
};

/// The stroke as wide as the brush can paint it.
Stroke as_wide_as_painted(const Stroke& stroke, const Brush& brush);

/// How far ahead of the end the outline is first left, at a distance to its left; infinite where it is not.
double outline_ahead_mm(const Rings& rings, const PathEnd& end, double aside_mm);

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
