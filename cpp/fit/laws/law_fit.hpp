#pragma once

#include <array>
#include <vector>

#include "brushsvg/profile.hpp"

// From measured (depth, value) pairs to a law with its intervals. Lengths in mm.
namespace brushsvg::fit {

/// What is minimised: squares, or absolute residuals (a few wild values then have no say).
enum class Norm { squares, absolute };

/// The law that is looked for. `positive` and `rising` hold on all of `range_mm`.
struct LawShape {
    std::array<double, 2> range_mm{0.0, 10.0};  ///< depths at which the brush will be used
    int degree = 1;
    bool through_zero = false;                                ///< no constant term
    bool positive = false;                                    ///< above 0
    bool rising = false;                                      ///< never falls with depth
    double floor = -std::numeric_limits<double>::infinity();  ///< law = max(floor, polynomial)
    Norm norm = Norm::squares;
    double smoothing = 0.0;  ///< weight of bends between the law's control points, relative to the data's 1; 0: none
};

struct LawFit {
    Profile law;  ///< coefficients, floor, calibrated_mm, half_interval_95 and rmse_mm where there are data to spare
    std::vector<std::vector<double>> covariance;  ///< of all coefficients, or empty
    std::vector<double> residual_mm;              ///< measured minus law, in the order of the data
    double r_squared = 0.0;                       ///< 1 - SSE / sum of squares about the mean
    double degrees_of_freedom =
        0.0;            ///< values minus free coefficients; of laws fitted together a mean, with fractions
    bool held = false;  ///< the data alone would break `positive` or `rising`: the shape is kept by constraint
};

/// Least squares, or least absolute residuals, over polynomials of the requested shape.
///
/// `scatter`: how much each value scatters, up to a common factor; empty if all scatter alike. Values are weighted by
/// 1 / scatter. rmse_mm and r_squared count all values alike.
///
/// Covariance: s^2 (J^T J)^-1 with s^2 = SSE / degrees of freedom; for absolute residuals pi/2 s^2 (J^T J)^-1 with s
/// from the median absolute residual, which holds for normal noise with outliers. Where the shape is held by
/// constraint it is that of the unconstrained law there, and so rather too wide. Half intervals: Student's t, 95 %.
/// Throws Error: numbers that are not finite, too few values or depths for the degree, a scatter that
/// is not positive.
LawFit fit_law(const std::vector<double>& depth_mm, const std::vector<double>& value_mm, const LawShape& shape,
               const std::vector<double>& scatter = {});

}  // namespace brushsvg::fit
