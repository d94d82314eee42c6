#pragma once

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// The pass with fewer poses: stretches in which the brush is taut are passed in longer straight moves, as long as the
/// mark's middle and its edges stay within the tolerance of where they were. The tolerance is one of the mark and not
/// of the tool's path, which the brush smooths. Where the brush lands, is lifted, goes loose or turns on an arc nothing
/// changes, and no pose is deeper than the deepest was. Simulated before it is handed over: the pass itself where
/// nothing is won. Throws Error as simulate() does.
Pass thin_out(const Pass& pass, const Brush& brush, double tolerance_mm);

}  // namespace brushsvg
