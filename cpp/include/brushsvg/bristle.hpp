#pragma once

#include <Eigen/Core>

namespace [[gnu::visibility("default")]] brushsvg {

/// The condition at the bristle's sliding end, in addition to w'(1) = 0.
enum class SlidingEnd {
    third_derivative,  ///< w'''(1) = 0, as the article's Lemma 1 has it
    shear_free         ///< (EI w'')'(1) = 0, no shear force
};

/// Lemma 1 for EI(z) = load(z) = exp(1 - z), z in [0, 1], clamped at 0: the four c of
///     w(z) = c1 + c2 z + (c3 + c4 z) e^z + z^2 / 2
/// (the article prints (3) otherwise; put into (2) the printed form leaves a residual).
Eigen::Vector4d bristle_coefficients(SlidingEnd end);

/// w(z) for these coefficients, in units of the bristle's length.
double bristle_deflection(const Eigen::Vector4d& c, double z);

}  // namespace brushsvg
