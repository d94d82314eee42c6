#pragma once

#include <cmath>
#include <vector>

// What a distance from the predicted edge costs. Inside fit_marks.
namespace brushsvg::fit {

constexpr double kCauchy = 2.385, kTukey = 4.685;  // each 95 % as sharp as least squares on normal noise

/// What a distance costs, in standard deviations z: rho(z), psi = rho'/2, its slope.
struct Cost {
    double rho, psi, slope;
};

enum class Loss { cauchy, tukey };  // from afar wild points pull, less the further it is; in the end not at all

inline Cost cost(Loss loss, double z) {
    if (loss == Loss::tukey) {
        const double c2 = kTukey * kTukey, t = 1.0 - z * z / c2;
        if (t <= 0.0) return {c2 / 3.0, 0.0, 0.0};
        return {c2 / 3.0 * (1.0 - t * t * t), z * t * t, t * (t - 4.0 * z * z / c2)};
    }
    const double c2 = kCauchy * kCauchy, t = 1.0 + z * z / c2;
    return {c2 * std::log(t), z / t, (2.0 - t) / (t * t)};
}

/// How sure distances are and what wild ones cost. Neighbours along an outline err together.
struct Weighing {
    double noise_mm = 0.5;              ///< while nothing is known: a brush's hairs
    double repeats = 1.0;               ///< what squares are divided by: so many neighbours count as one
    std::vector<double> together{1.0};  ///< autocovariance of psi along an outline: at 0, 1, 2 ... points
    double slope = 1.0;                 ///< mean slope of psi
    Loss loss = Loss::cauchy;
    bool is_asked = false;  ///< for edges with these errors, not for the given ones
};

}  // namespace brushsvg::fit
