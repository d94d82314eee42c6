#pragma once

#include "brushsvg/ring.hpp"

namespace brushsvg {

/// The same shape from fewer rings. Runs of neighbours that all see one point are united: their outline is the
/// outermost edge at each angle about that point. The paint of a brush over a few millimetres is such a run. Rings that
/// see no such point stay, and so do rings followed by clockwise rings, their holes. Coordinates are exact to 1e-5 mm.
/// `are_stars`: some point sees all of each ring, so no ring crosses itself or has holes.
struct StarUnion {
    Rings rings;
    bool are_stars;
};
StarUnion unite_stars(const Rings& rings);

}  // namespace brushsvg
