#pragma once

#include <optional>

#include "inverse_lag.hpp"
#include "pose_list.hpp"

namespace brushsvg {

/// A stroke that begins with a dot, as a comma or the ball of an f: turned round on the spot, lifted until it hardly
/// touches, and pressed anew in the same place, where P rests until the widest section goes on along the line. That
/// is where the line is widest, if it begins just beside that. Where the drawn end is a round cap it is the middle of
/// that, and where there is room the brush comes there on a way back at the full width.
struct TurnedBeginning {
    Samples back;           ///< none where it is set down on the spot
    Eigen::Vector2d at_mm;  ///< where P rests
    double depth_mm;        ///< while it turns
    Stroke onward;          ///< the stroke whose mark begins as narrow as the dot hides it
    double on_from_mm;      ///< arc length where the widest section goes on
    Eigen::Vector2d on_along;
};

/// Whether a line begins wider than it goes on.
bool begins_in_ball(const Stroke& stroke, double length_mm);

/// None where a dot as wide as the stroke's beginning cannot be turned, or the stroke is no longer than one.
std::optional<TurnedBeginning> turned_beginning(const Stroke& stroke, const Brush& brush, double step_tolerance);

/// The way back and the dot, the brush left on the paper. What it heads to then.
Eigen::Vector2d turn(const TurnedBeginning& beginning, const Brush& brush, PoseList& out);

}  // namespace brushsvg
