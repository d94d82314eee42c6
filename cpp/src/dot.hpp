#pragma once

#include <optional>

#include "brushsvg/brush.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/stroke.hpp"
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

/// Whether the brush is turned round on the spot: then P follows the line, and the widest section goes round it.
bool is_dot(const PassMarks& marks);

}  // namespace brushsvg
