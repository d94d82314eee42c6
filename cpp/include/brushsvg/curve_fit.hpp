#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "brushsvg/stroke.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// x, y and half width [mm] per row: a middle line as it was found, with its noise.
using WideLine = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

struct FittedLine {
    Cubics middle_mm;
    std::vector<WidthKnot> half_width;
};

/// Few cubics with one tangent where they meet, no further than the tolerance from the line's points: least squares,
/// the parameters moved to the nearest points, split at the worst point (P. J. Schneider, "An Algorithm for
/// Automatically Fitting Digitized Curves", Graphics Gems, 1990). Half widths: as few knots as keep all of them to the
/// tolerance. closed: the last point is the first again, and the tangent goes through. A line without length gives one
/// cubic that is a point.
FittedLine fit_curve(const WideLine& line, double tolerance_mm, bool closed);

/// A stroke through points, in painting direction; closed where the last is the first again. Points that repeat the one
/// before them are left out. Without a tolerance straight lines from each to the next; with one, cubics that pass each
/// within it, smooth but for corners that no smooth line follows, and
/// never more of them than lines. The half width is linear between the points.
/// Throws Error, naming the stroke: fewer than two points that differ, a number that is not finite or beyond 1e6 mm, a
/// half width that is not positive.
Stroke stroke_along(const StrokeId& id, const WideLine& points, std::optional<double> tolerance_mm = std::nullopt);

}  // namespace brushsvg
