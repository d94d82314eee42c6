#pragma once

#include <optional>

#include "middle_line.hpp"
#include "pose_list.hpp"

namespace brushsvg {

/// A stroke that begins with a dot, as a comma or the ball of an f: turned round on the spot, lifted until it hardly
/// touches, and pressed anew in the same place, where P rests until the widest section goes on along the line. That
/// is where the line is widest, if it begins just beside that.
struct TurnedBeginning {
    Eigen::Vector2d at_mm;  ///< where P rests
    double depth_mm;        ///< while it turns
    Stroke onward;          ///< the stroke whose mark begins as narrow as the dot hides it
    double on_from_mm;      ///< arc length where the widest section goes on
    Eigen::Vector2d on_along;
};

/// None where a dot as wide as the stroke's beginning cannot be turned, or the stroke is no longer than one.
std::optional<TurnedBeginning> turned_beginning(const Stroke& stroke, const Brush& brush, const Line& line);

/// The dot, the brush left on the paper, heading as it goes on.
void turn(const TurnedBeginning& beginning, const Brush& brush, PoseList& out);

}  // namespace brushsvg
