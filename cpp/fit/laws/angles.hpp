#pragma once

#include <vector>

// Lag and tip gap at one depth from angles seen while the brush is dragged straight (article, Theorems 3 and 4).
// Angles in rad, lengths in mm.
namespace brushsvg::fit {

/// One drag: after s [mm] the heading is at `alpha` from the direction of motion, and the tip has moved in the
/// direction `beta` (article (11), (12)). At s = 0 the heading is at alpha0. beta may be empty.
struct AngleSeries {
    double alpha0 = 0.0;
    std::vector<double> s_mm, alpha, beta;
};

/// What counts as known. `plain`: the article's least squares, F and I as exact. `total`: both sides as measured, by
/// total least squares over columns of equal length.
enum class Lines { plain, total };

/// r from (19) and (20) as s = -r F, and b from (21) to (23).
struct FromAngles {
    double lag_mm, lag_rmse_mm;          ///< rmse: of s_i + r F_i
    double tip_gap_mm, tip_gap_rmse_mm;  ///< nan without beta; rmse: of s_i - mu I_i
    int left_out;                        ///< readings that have no logarithm: alpha not in (0, alpha0)
};

/// Throws Error when fewer than one reading can be used.
FromAngles from_angles(const AngleSeries& series, Lines lines);

}  // namespace brushsvg::fit
