#pragma once

#include <optional>

#include "dot.hpp"
#include "middle_line.hpp"

namespace brushsvg {

/// A dot with corners, as of the i of a sans or in Arabic letters: turned round on the spot, lifted until it hardly
/// touches, and led on in the same place as a narrow mark, out to one side and round all of them.
struct SquaredDot {
    Dot dot;
    Stroke way;         ///< of the narrow mark, from where P rests
    double on_from_mm;  ///< arc length of its way where the widest section goes on
    Eigen::Vector2d on_along;
    double reach_mm;  ///< how far from the dot's first place its widest section goes
};

/// The sides are those of the drawn outline's convex hull. None for what is no dot, has no outline, fills less than
/// 0.92 of that hull or hardly more than a disc; where something would stay bare between the dot and the narrower mark;
/// and where the brush is too coarse for that.
std::optional<SquaredDot> squared_dot(const Stroke& stroke, const Brush& brush);

}  // namespace brushsvg
