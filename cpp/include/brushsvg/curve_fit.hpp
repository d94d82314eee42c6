#pragma once

#include <Eigen/Core>
#include <vector>

#include "brushsvg/stroke.hpp"

namespace brushsvg {

/// x, y and half width [mm] per row: a middle line as it was found, with its noise.
using WideLine = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

struct FittedLine {
    Cubics middle_mm;
    std::vector<WidthKnot> half_width;
};

/// Few cubics with one tangent where they meet, no farther than the tolerance from the line's points: least squares,
/// the parameters moved to the nearest points, split at the worst point (P. J. Schneider, "An Algorithm for
/// Automatically Fitting Digitized Curves", Graphics Gems, 1990). Half widths: as few knots as keep all of them to the
/// tolerance. closed: the last point is the first again, and the tangent goes through. A line without length gives one
/// cubic that is a point.
FittedLine fit_curve(const WideLine& line, double tolerance_mm, bool closed);

}  // namespace brushsvg
