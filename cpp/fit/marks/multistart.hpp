#pragma once

#include <optional>
#include <vector>

#include "mark_problem.hpp"

namespace brushsvg::fit {

/// Moves to the places of the marks as far as few points and instants show them, from these laws, or from the best of
/// lags of many lengths, the same at all depths or longer with depth, each followed a little. The footprint's shape is
/// held meanwhile: while the lag is wrong, marks look best on footprints without a front, and from there no small step
/// leads back. How sure the distances are is known then. Throws Error where no start predicts the marks.
void start(MarkProblem& at, const std::optional<MarkLaws>& from, const std::vector<PaintedMark>& marks,
           const MarkOptions& options);

}  // namespace brushsvg::fit
