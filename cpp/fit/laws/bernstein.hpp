#pragma once

#include <Eigen/Core>

namespace brushsvg::fit {

/// Returns the matrix from a polynomial's Bernstein control values on [lo, hi] to its coefficients (ascending powers).
/// The polynomial is positive if all control values are, and rises if they rise.
Eigen::MatrixXd powers_from_controls(int degree, double lo, double hi);

/// Returns the matrix from factors of the Legendre polynomials over [0, hi], each 1 at hi, to coefficients (ascending
/// powers).
Eigen::MatrixXd powers_from_legendre(int degree, double hi);

}  // namespace brushsvg::fit
