#pragma once

#include "mark_problem.hpp"

namespace brushsvg::fit {

/// To the best of starts with lags of many lengths, the same at all depths or longer with depth, each followed a
/// little. The footprint's shape is held meanwhile: while the lag is wrong, marks look best on footprints without a
/// front, and from there no small step leads back. Throws Error where no start predicts the marks.
void start(MarkProblem& at, const std::vector<PaintedMark>& marks, const MarkOptions& options);

}  // namespace brushsvg::fit
