#pragma once

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// How much more the outlines of a mark turn than those of the target, in full turns: waves, curls and thorns, which
/// overlap does not see. Each outline is looked at as a polygon that is within 0.1 mm of it (Douglas and Peucker), so
/// that neither pixels nor facets of curves count, and rings below 0.01 mm^2, pinholes, are left out. Negative where
/// the mark is rounder than what was drawn.
double excess_turning(const Rings& mark, const Rings& wanted);

/// How many corners of a mark's outlines beyond 20 degrees, each outline as a polygon within 0.05 mm of it, stick out
/// of the target by more than 0.3 mm: thorns, and the bends of what bulges out. Outer rings run counter-clockwise,
/// the clockwise ones behind each are its holes.
int thorns(const Rings& mark, const Rings& wanted);

}  // namespace brushsvg
