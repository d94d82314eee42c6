#pragma once

#include "brushsvg/marks.hpp"
#include "brushsvg/plan.hpp"
#include "many_strokes.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// The TCP's way in a pass, one lane, from row to row of what a brush did there: so that other lags can be followed on
/// it and compared row by row. marks: simulate()'s of this pass and an upright brush; else Error.
ManyWays way_of(const Pass& pass, const PassMarks& marks);

}  // namespace brushsvg
