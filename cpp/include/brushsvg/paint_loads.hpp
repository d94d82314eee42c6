#pragma once

#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

struct PaintLoadOptions {
    double first_mm = 0.0;      ///< path of the TCP on the paper that the paint on the brush still lasts
    double every_mm = 0.0;      ///< and that it lasts after each visit to the paint
    double backtrack_mm = 5.0;  ///< a part begins so far back along the path of the one before
};

/// The pass in parts between which the brush is lifted to fetch paint; one part where the paint lasts. Each part ends
/// by holding the patch where it is and begins where an earlier patch was, with its heading: from there on the mark is
/// that of the whole pass, so no gap shows. A cut is made where the brush is taut and pressed, on no arc; where that is
/// nowhere in time, the part is longer than the paint lasts. Named as the stroke, then stroke+2, stroke+3, ...,
/// and numbered as loads; one part is the pass as it was.
/// Throws Error as simulate() does, and for lengths that are not positive or do not reach beyond the backtrack.
std::vector<Pass> interrupted(const Pass& pass, const Brush& brush, const PaintLoadOptions& options);

}  // namespace brushsvg
