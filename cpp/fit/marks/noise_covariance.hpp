#pragma once

#include <vector>

#include "mark_problem.hpp"

namespace brushsvg::fit {

/// Estimates the noise of the distances from the distances at the solution.
///
/// The errors along an outline have an autocovariance. The fit has followed a part of them, S h(k), which is added
/// again. S is the sum of the autocovariance, and h(k) the mean of the k-th diagonal of the hat matrix, which maps
/// noise to the change of the fit.
Weighing estimate_weighing(const MarkProblem& at);

/// Returns the autocovariance of a moving average of independent errors that is near the given one, with its sum.
///
/// An estimated autocovariance that is cut off has negative power at some frequencies, and gives negative variances.
/// The transform of the average's weights is the square root of the power, where that is positive. The result has
/// 2 n - 1 values for n given ones, whose sum with both neighbours must be positive.
std::vector<double> as_moving_average(const std::vector<double>& autocovariance);

/// The loss of the marks near the solution, over the shared unknowns and then both displacements of every mark.
struct LossDerivatives {
    VectorXd gradient;
    MatrixXd hessian;  ///< second derivatives
};
LossDerivatives loss_derivatives(const MarkProblem& at);

/// Returns the distance of the shared unknowns from the minimum of loss and priors if the loss were quadratic.
VectorXd distance_from_minimum(const MarkProblem& at);

/// Returns the covariance of the shared unknowns, with priors: A^-1 (M + P) A^-1.
///
/// A holds the second derivatives of the loss, M is the sum of J_i c(|i - k|) J_k^T over points i, k of one outline, c
/// is the autocovariance of the weighing, and P comes from the priors.
MatrixXd covariance(const MarkProblem& at);

}  // namespace brushsvg::fit
