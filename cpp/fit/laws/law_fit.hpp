#pragma once

#include <array>
#include <vector>

#include "brushsvg/brush_law.hpp"

// Fits a law with its confidence intervals to measured (depth, value) pairs. Lengths are in mm.
namespace brushsvg::fit {

/// The sum that is minimised: squares, or absolute residuals, for which a few outliers have no influence.
enum class Norm { squares, absolute };

/// The shape of the law to be fitted. `positive` and `rising` hold on all of `range_mm`.
struct LawShape {
    std::array<double, 2> range_mm{0.0, 10.0};  ///< depths at which the brush will be used
    int degree = 1;
    bool through_zero = false;                                ///< no constant term
    bool positive = false;                                    ///< above 0
    bool rising = false;                                      ///< never falls with depth
    double floor = -std::numeric_limits<double>::infinity();  ///< law = max(floor, polynomial)
    Norm norm = Norm::squares;
    double smoothing = 0.0;  ///< weight of the control points' second differences, relative to 1 for the data; 0: none
};

struct LawFit {
    Profile law;  ///< coefficients, floor, calibrated_mm, half_interval_95 and rmse_mm where there are enough data
    std::vector<std::vector<double>> covariance;  ///< of all coefficients, or empty
    std::vector<double> residual_mm;              ///< measured minus law, in the order of the data
    double r_squared = 0.0;                       ///< 1 - SSE / sum of squares about the mean
    double degrees_of_freedom =
        0.0;            ///< values minus free coefficients; for laws fitted together a mean with fractions
    bool held = false;  ///< the data alone would violate `positive` or `rising`, so that a constraint keeps the shape
};

/// Fits a polynomial of the requested shape by least squares or least absolute residuals.
///
/// `scatter`: the scatter of each value, up to a common factor; empty if all values scatter alike. Values are weighted
/// by 1 / scatter. rmse_mm and r_squared count all values alike.
///
/// Covariance: s^2 (J^T J)^-1 with s^2 = SSE / degrees of freedom; for absolute residuals pi/2 s^2 (J^T J)^-1 with s
/// from the median absolute residual, which holds for normal noise with outliers. Where a constraint keeps the shape,
/// it is the covariance of the unconstrained law, which is rather too wide. Half intervals: Student's t, 95 %.
/// Throws Error for numbers that are not finite, too few values or depths for the degree, and a scatter that is not
/// positive.
LawFit fit_law(const std::vector<double>& depth_mm, const std::vector<double>& value_mm, const LawShape& shape,
               const std::vector<double>& scatter = {});

}  // namespace brushsvg::fit
