#pragma once

#include "brushsvg/brush.hpp"
#include "inverse/pose_list.hpp"

namespace brushsvg {

/// What is left of the depth while the brush turns over, and where a mark ends in a point. Its footprint is so small
/// then that the way it goes round does not show, in a mark as fine as 1 mm; a paper that is lower by half as much is
/// touched still.
inline constexpr double kTurnOverDepthMm = 0.5;

/// A taut brush at one instant: all that a landing leads to and a lift begins with.
struct Stance {
    Eigen::Vector2d contact_mm;  ///< P
    Eigen::Vector2d heading;     ///< u
    double depth_mm;
};

/// Touches down over P, or is there already at a depth, and runs up to P + r u while pressing: there the brush is taut,
/// and P was not moved.
void land(const Stance& first, const Brush& brush, PoseList& out, double from_mm = 0.0);

/// Holds P and comes back along q = P + r(depth) u, a little inside, until the depth is the requested one: no tail.
void lift(const Stance& last, const Brush& brush, PoseList& out, double until_mm = 0.0);

/// Lifts the brush until it hardly touches, goes back over P and presses anew, heading elsewhere: P rests. At full
/// depth the footprint would be swept round P, and where the handle passes it says which way.
void turn_over(const Stance& before, const Stance& after, const Brush& brush, PoseList& out);

}  // namespace brushsvg
