#pragma once

#include <cmath>
#include <vector>

// The cost of a distance from the predicted edge. Internal to fit_marks.
namespace brushsvg::fit {

constexpr double kCauchySigmas = 2.385,
                 kTukeySigmas = 4.685;  // each with 95 % of the efficiency of least squares on normal noise

/// The cost of a distance of z standard deviations: rho(z), psi = rho'/2 and the slope of psi.
struct Cost {
    double rho, psi, slope;
};

/// cauchy: an outlier pulls less the further away it is. tukey, used at the end: an outlier does not pull at all.
enum class Loss { cauchy, tukey };

inline Cost cost(Loss loss, double z) {
    if (loss == Loss::tukey) {
        const double c2 = kTukeySigmas * kTukeySigmas, t = 1.0 - z * z / c2;
        if (t <= 0.0) return {c2 / 3.0, 0.0, 0.0};
        return {c2 / 3.0 * (1.0 - t * t * t), z * t * t, t * (t - 4.0 * z * z / c2)};
    }
    const double c2 = kCauchySigmas * kCauchySigmas, t = 1.0 + z * z / c2;
    return {c2 * std::log(t), z / t, (2.0 - t) / (t * t)};
}

/// The noise of distances and the cost of outliers. The errors of neighbours along an outline are correlated.
struct Weighing {
    double noise_mm = 0.5;                    ///< before it is estimated: the thickness of a brush's hairs
    double points_per_independent = 1.0;      ///< divisor of squares: number of neighbours that count as one
    std::vector<double> autocovariance{1.0};  ///< autocovariance of psi along an outline, at 0, 1, 2 ... points
    double slope = 1.0;                       ///< mean slope of psi
    Loss loss = Loss::cauchy;
    bool is_given = false;  ///< the errors of the edges are given, not estimated
};

}  // namespace brushsvg::fit
