#pragma once

#include "brushsvg/ring.hpp"

namespace brushsvg {

/// The same shape from fewer rings: runs of neighbours that all see one point are united, which is the outermost edge
/// at each angle about it. What a brush paints on the next few millimetres is such a run. Rings that see none stay, as
/// do rings with clockwise ones behind them, their holes. Coordinates are right to 1e-5 mm. `are_stars`: a point sees
/// all of each, so that none crosses itself or has holes.
struct InSight {
    Rings rings;
    bool are_stars;
};
InSight united_in_sight(const Rings& rings);

}  // namespace brushsvg
