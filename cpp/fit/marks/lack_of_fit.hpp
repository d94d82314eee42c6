#pragma once

#include <vector>

#include "mark_problem.hpp"

namespace brushsvg::fit {

/// Lets laws depart from the numbers that the options give them, if the marks ask for it: by further polynomials, which
/// are known beforehand to be about 0, to a share of the law that is found by evidence (largest marginal likelihood,
/// beside the solution). Whether any may; then it must be solved again.
bool depart(MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options);

/// What variances are multiplied by: 1, or of laws that depart by Student's t, for by how much is found from few
/// numbers.
double unsurer(const MarkProblem& fit);

/// The same solution with as many numbers a law as the options say, nearest where those are fewer.
MarkProblem with_terms(const MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options);

}  // namespace brushsvg::fit
