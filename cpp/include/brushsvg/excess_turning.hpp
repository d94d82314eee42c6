#pragma once

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// How much more the outlines of a mark turn than those wanted, in full turns: waves, curls and thorns, which overlap
/// does not see. Each outline is looked at as a polygon that lies within 0.1 mm of it (Douglas and Peucker), so that
/// neither pixels nor facets of curves count. Negative where the mark is rounder than what was drawn.
double excess_turning(const Rings& mark, const Rings& wanted);

}  // namespace brushsvg
