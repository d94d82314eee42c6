#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "brushsvg/stroke.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// A middle line as it was found, with its noise. Rows: x, y, half width [mm].
using WideLine = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// The result of fit_cubics().
struct FittedLine {
    Cubics middle_mm;
    std::vector<WidthKnot> half_width;
};

/// Fit few cubics to a line, within a tolerance [mm] of its points.
///
/// Neighbouring cubics share a tangent where they meet. The fit is by least squares, with the parameters moved to the
/// nearest points and a split at the worst point (P. J. Schneider, "An Algorithm for Automatically Fitting Digitized
/// Curves", Graphics Gems, 1990). The half widths get as few knots as keep all of them within the tolerance.
///
/// `closed`: whether the last point repeats the first one; the tangent is then continuous there. A line without length
/// gives one cubic that is a point.
FittedLine fit_cubics(const WideLine& line, double tolerance_mm, bool closed);

/// Make a stroke through points, in painting direction.
///
/// `points`: a point equal to the one before is left out. The stroke is closed if the last point repeats the first one.
/// The half width is linear between the points.
///
/// `tolerance_mm`: without it, straight lines join the points. With it, the stroke consists of cubics that pass each
/// point within the tolerance. They are smooth except at corners that no smooth line follows, and never more than the
/// straight lines would be.
///
/// Throws Error, naming the stroke, for fewer than two different points or a half width that is not positive. Also for
/// a number that is not finite or beyond 1e6 mm.
Stroke stroke_along(const StrokeId& id, const WideLine& points, std::optional<double> tolerance_mm = std::nullopt);

}  // namespace brushsvg
