#pragma once

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Simplify a pass: paint nearly the same mark with fewer poses.
///
/// Where the brush is taut, longer straight moves and arcs replace stretches of the pass. The mark's middle and its
/// edges stay within the tolerance of where they were. The tolerance [mm] is for the mark, not for the tool's path,
/// which the brush smooths.
///
/// Nothing changes where the brush lands, is lifted, goes loose, or turns on an arc. No pose gets deeper than the
/// deepest pose of the original. The result is simulated before it is returned. If no simplified pass is within the
/// tolerance, the original pass is returned. Throws Error as simulate() does.
Pass simplify_pass(const Pass& pass, const Brush& brush, double tolerance_mm);

}  // namespace brushsvg
