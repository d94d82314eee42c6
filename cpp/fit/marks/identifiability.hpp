#pragma once

#include <string>
#include <vector>

#include "mark_problem.hpp"

namespace brushsvg::fit {

/// Returns, in words, which unknowns the marks leave open.
///
/// Along an open direction, the Jacobian without priors has such a small singular value that the noise changes a law by
/// more than a quarter of itself. Holding other unknowns shows what the law is confused with: displacements, the height
/// or another law.
std::vector<std::string> describe_open_unknowns(const MarkProblem& fit);

}  // namespace brushsvg::fit
