#pragma once

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Return how much more a mark's outlines turn than the target's, in full turns:
///     (sum of |turning angle| of the mark - sum of |turning angle| of the target) / (2 pi)
/// This measures waves, curls and thorns, which the overlap does not show. It is negative if the mark is rounder than
/// the target.
///
/// Each outline is replaced by a polygon within 0.1 mm of it (Douglas and Peucker), so that pixels and facets of curves
/// do not count. Rings smaller than 0.01 mm^2, which are pinholes, are left out.
double excess_turning(const Rings& mark, const Rings& target);

/// Count the corners of a mark that stick out of the target: its thorns.
///
/// Counts corners of more than 20 degrees that are more than 0.3 mm outside the target, including bends of bulges.
/// Each outline is replaced by a polygon within 0.05 mm of it.
///
/// Outer rings are counter-clockwise; the clockwise rings after an outer ring are its holes.
int thorns(const Rings& mark, const Rings& target);

}  // namespace brushsvg
