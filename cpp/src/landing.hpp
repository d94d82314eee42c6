#pragma once

#include "brushsvg/brush.hpp"
#include "pose_list.hpp"

namespace brushsvg {

/// A taut brush at one instant: all that a landing leads to and a lift begins with.
struct Stance {
    Eigen::Vector2d contact_mm;  ///< P
    Eigen::Vector2d heading;     ///< u
    double depth_mm;
};

/// Touches down over P, or is there already at a depth, and runs up to P + r u while pressing: there the brush is taut,
/// and P was not moved.
void land(const Stance& first, const Brush& brush, PoseList& out, double from_mm = 0.0);

/// Holds P and comes back along q = P + r(depth) u, a little inside, until the depth is what is asked for: no tail.
void lift(const Stance& last, const Brush& brush, PoseList& out, double until_mm = 0.0);

/// Lifts the brush until it hardly touches, goes back over P and presses anew, heading elsewhere: P rests. At full
/// depth the footprint would be swept round P, and where the handle passes beside it says which way.
void turn_over(const Stance& before, const Stance& after, const Brush& brush, PoseList& out);

}  // namespace brushsvg
