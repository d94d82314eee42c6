#pragma once

#include <Eigen/Core>

namespace [[gnu::visibility("default")]] brushsvg {

/// The condition at the bristle's sliding end, in addition to w'(1) = 0.
enum class SlidingEnd {
    third_derivative,  ///< w'''(1) = 0, as in the article's Lemma 1
    shear_free         ///< (EI w'')'(1) = 0, no shear force
};

/// Return the four coefficients of a bristle's deflection, by Lemma 1.
///
/// The bristle is clamped at z = 0 and has EI(z) = load(z) = exp(1 - z) for z in [0, 1]. The coefficients c belong to
///     w(z) = c1 + c2 z + (c3 + c4 z) e^z + z^2 / 2
/// The article prints (3) differently. Inserted into (2), the printed form leaves a residual.
Eigen::Vector4d bristle_coefficients(SlidingEnd end);

/// Return the deflection w(z), in units of the bristle's length.
double bristle_deflection(const Eigen::Vector4d& c, double z);

}  // namespace brushsvg
