#pragma once

#include "mark_problem.hpp"

namespace brushsvg::fit {

/// How sure the distances are, from those at the solution. They err together along an outline, by an autocovariance;
/// of which the fit has followed a part, S h(k) with S the sum of the autocovariance and h the hat matrix (from noise
/// to what the fit makes of it) along its k-th diagonal, in the mean: that is added again.
Weighing weighed(const MarkProblem& at);

/// The marks' loss next to the solution, over the shared unknowns and then both displacements of every mark.
struct MarksLoss {
    VectorXd gradient;
    MatrixXd slope;  ///< second derivatives
};
MarksLoss marks_loss(const MarkProblem& at);

/// How far the shared unknowns are from where the loss and the priors would be least if the loss were a parabola.
VectorXd off_least(const MarkProblem& at);

/// Of the shared unknowns, priors included: A^-1 (M + P) A^-1 with A the slope of the loss, M the sum of
/// J_i c(|i - k|) J_k^T over points i, k of one outline, c the weighing's autocovariance, and P from the priors.
MatrixXd covariance(const MarkProblem& at);

}  // namespace brushsvg::fit
