#pragma once

#include <Eigen/Core>

namespace brushsvg::fit {

/// Coefficients (ascending) from the values of a polynomial's control points on [lo, hi]: Bernstein to powers. The law
/// is above 0 where they are, and rises where they do.
Eigen::MatrixXd powers_from_controls(int degree, double lo, double hi);

/// Coefficients (ascending) from factors of the Legendre polynomials over [0, hi], each 1 at hi.
Eigen::MatrixXd powers_from_legendre(int degree, double hi);

}  // namespace brushsvg::fit
