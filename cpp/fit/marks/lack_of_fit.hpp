#pragma once

#include <vector>

#include "mark_problem.hpp"

namespace brushsvg::fit {

/// Takes a solution on to laws that may depart from their few numbers: each law by further polynomials, which are known
/// beforehand to be about 0, to a share of the law that is found by evidence (largest marginal likelihood, near the
/// solution). False where the solver did not converge.
bool depart(MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options);

}  // namespace brushsvg::fit
