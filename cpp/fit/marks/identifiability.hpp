#pragma once

#include <string>
#include <vector>

#include "mark_problem.hpp"

namespace brushsvg::fit {

/// What marks leave open, in words: directions of the unknowns along which the Jacobian, without any prior, has so
/// small a singular value that the noise moves a law by more than a quarter of itself. With whom it is mistaken is
/// found by holding others: displacements, the height, another law.
std::vector<std::string> doubts(const MarkProblem& fit);

}  // namespace brushsvg::fit
