#pragma once

#include "brushsvg/brush.hpp"
#include "inverse/pose_list.hpp"

namespace brushsvg {

/// Depth [mm] that remains while the brush turns over, and where a mark ends in a point. At this depth the footprint is
/// so small that its way round does not show, even in a mark as fine as 1 mm. A paper that is lower by half as much is
/// still touched.
inline constexpr double kTurnOverDepthMm = 0.5;

/// State of a taut brush at one instant: where a landing ends and a lift begins.
struct Stance {
    Eigen::Vector2d contact_mm;  ///< P
    Eigen::Vector2d heading;     ///< u
    double depth_mm;
};

/// Touch down over P, or start there at a given depth, and run up to P + r u while pressing. At the end the brush is
/// taut, and P has not moved.
void land(const Stance& first, const Brush& brush, PoseList& out, double from_mm = 0.0);

/// Hold P and come back along q = P + r(depth) u, slightly inside, until the depth is the requested one. Leaves no
/// tail.
void lift(const Stance& last, const Brush& brush, PoseList& out, double until_mm = 0.0);

/// Lift the brush until it hardly touches, go back over P and press again with a different heading while P rests. At
/// full depth the footprint would be swept round P, and the side on which the handle passes would decide the direction.
void turn_over(const Stance& before, const Stance& after, const Brush& brush, PoseList& out);

}  // namespace brushsvg
