#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/stroke.hpp"
#include "landing.hpp"
#include "pose_list.hpp"

namespace brushsvg {

/// A mark that is painted by turning the brush on the spot: P rests in its middle, and the footprint goes round it.
/// A short bar is turned at both of its ends.
struct Dot {
    Eigen::Vector2d from_mm, to_mm;  ///< where P rests
    double from_depth_mm, to_depth_mm;
    Eigen::Vector2d heading;  ///< from one to the other
};

/// None for a stroke longer than 1.4 half widths, a ring, a rigid brush, and where a footprint of no depth reaches as
/// far from P as the drawn edge, or leaves a hole about it.
std::optional<Dot> dot_of(const Stroke& stroke, const Brush& brush);

PoseList poses_of(const Dot& dot, const Brush& brush);

/// The same, the brush left on the paper.
Stance turn(const Dot& dot, const Brush& brush, PoseList& out);

/// How far from P the paint reaches when the brush is pressed to a depth and turned there [mm].
double reach_of_dot_mm(const Brush& brush, double depth);

/// Press depth at which a footprint that is turned on the spot reaches so far; none where that leaves a hole about P,
/// or the least depth reaches farther already; the greatest depth where none reaches so far.
std::optional<double> depth_of_dot(const Brush& brush, double half_width_mm);

/// The TCP led round a place, at a reach from it, the heading from `first_rad` on by a little less than all round.
void turn_round(const Eigen::Vector2d& about_mm, double first_rad, double depth, double reach_mm, PoseList& out);
inline constexpr double kTurnRad = 356.0 * EIGEN_PI / 180.0;  ///< an arc that ends where it began would say nothing

/// The brush that comes dragged is lifted to a depth, drawn on until P rests where the widest section was, and turned
/// round there.
Stance turn_round_ahead(const Stance& before, double depth, const Brush& brush, PoseList& out);

/// Rows of a mark, both included, in which the brush is turned round on the spot: then P follows the line, and the
/// widest section goes round it.
struct Turned {
    std::size_t first, last;
};
std::vector<Turned> turned_round(const PassMarks& marks);

}  // namespace brushsvg
