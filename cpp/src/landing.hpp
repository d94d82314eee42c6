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

/// Touches down over P and runs up to P + r u while pressing: there the brush is taut, and P was not moved.
void land(const Stance& first, const Brush& brush, PoseList& out);

/// Holds P and comes back along q = P + r(depth) u, a little inside: no tail.
void lift(const Stance& last, const Brush& brush, PoseList& out);

}  // namespace brushsvg
