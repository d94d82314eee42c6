#pragma once

#include <vector>

// Fits lag and tip gap at one depth to the angles of a brush that is dragged straight (article, Theorems 3 and 4).
// Angles are in rad, lengths in mm.
namespace brushsvg::fit {

/// One drag: after s [mm] the heading is at `alpha` from the direction of motion, and the tip has moved in the
/// direction `beta` (article (11), (12)). At s = 0 the heading is at alpha0. beta may be empty.
struct AngleSeries {
    double alpha0 = 0.0;
    std::vector<double> s_mm, alpha, beta;
};

/// The kind of line fit. `plain`: the article's least squares, in which F and I are exact. `total`: total least squares
/// over columns of equal length, in which both sides are measured.
enum class Lines { plain, total };

/// The lag r from (19) and (20) as s = -r F, and the tip gap b from (21) to (23).
struct FromAngles {
    double lag_mm, lag_rmse_mm;          ///< rmse: of s_i + r F_i
    double tip_gap_mm, tip_gap_rmse_mm;  ///< nan without beta; rmse: of s_i - mu I_i
    int left_out;                        ///< number of readings without a logarithm: alpha is not in (0, alpha0)
};

/// Fits lag and tip gap to a drag. Throws Error when no reading can be used.
FromAngles from_angles(const AngleSeries& series, Lines lines);

}  // namespace brushsvg::fit
