#pragma once

#include <optional>
#include <vector>

#include "mark_problem.hpp"

namespace brushsvg::fit {

/// Finds a start for the fit, with few points and instants.
///
/// It begins at the given laws, or at the best of many lags, constant or longer with depth, each after a few steps. The
/// footprint's shape is held constant during these steps: while the lag is wrong, marks fit best to footprints without
/// a front, and no small step leads back from there. The noise of the distances is known afterwards. Throws Error where
/// no start predicts the marks.
void find_start(MarkProblem& at, const std::optional<MarkLaws>& from, const std::vector<PaintedMark>& marks,
                const MarkOptions& options);

}  // namespace brushsvg::fit
