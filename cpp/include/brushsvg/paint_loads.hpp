#pragma once

#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Options of split_into_loads(). Lengths [mm] are measured along the path of the TCP on the paper.
struct PaintLoadOptions {
    double first_mm = 0.0;      ///< length that the paint on the brush lasts at the start
    double every_mm = 0.0;      ///< length that the paint lasts after each refill
    double backtrack_mm = 5.0;  ///< each part begins this far back along the path of the part before
};

/// Split a pass into parts, between which the brush is lifted and dipped into paint.
///
/// Each part ends with the patch at rest. The next part begins at an earlier place of the patch, with the heading that
/// the patch had there. From there on, its mark equals the mark of the whole pass, so no gap is visible.
///
/// The pass is cut only where the brush is taut and pressed, and not where it turns in place. If there is no such place
/// before the paint runs out, the part is longer than the paint lasts.
///
/// The parts are called stroke, stroke+2, stroke+3, ... and numbered as loads. If the paint lasts, the only part is the
/// original pass. Throws Error as simulate() does, for a tilted pass, for negative lengths, and if a load does not
/// last for more than twice the backtrack.
std::vector<Pass> split_into_loads(const Pass& pass, const Brush& brush, const PaintLoadOptions& options);

}  // namespace brushsvg
