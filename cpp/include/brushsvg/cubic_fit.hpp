#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "brushsvg/stroke.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Points of a middle line, possibly noisy. Rows: x, y, half width [mm].
using WideLine = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// The result of fit_cubics().
struct FittedLine {
    Cubics middle_mm;
    std::vector<WidthKnot> half_width;
};

/// Fit few cubics to a line, within a tolerance [mm] of its points.
///
/// Adjacent cubics share a tangent where they meet. Each cubic is fitted by least squares. Its parameters are then
/// moved to the nearest points, and it is split at the point with the largest distance (P. J. Schneider, "An Algorithm
/// for Automatically Fitting Digitized Curves", Graphics Gems, 1990). The half widths get as few knots as keep all of
/// them within half the tolerance.
///
/// `closed`: whether the last point repeats the first one; the tangent is then continuous there. A line without length
/// gives one cubic that is a point.
FittedLine fit_cubics(const WideLine& line, double tolerance_mm, bool closed);

/// Make a stroke through points, in painting direction.
///
/// `points`: a point equal to the previous one is left out. The stroke is closed if the last point repeats the first
/// one. The half width is linear between the points.
///
/// `tolerance_mm`: without it, straight lines connect the points. With it, the stroke consists of cubics that pass each
/// point within the tolerance. They are smooth, except at corners. There are never more cubics than straight
/// lines between the points.
///
/// Throws Error, naming the stroke, for fewer than two different points, a half width that is not positive, or a number
/// that is not finite or beyond 1e6 mm.
Stroke stroke_along(const StrokeId& id, const WideLine& points, std::optional<double> tolerance_mm = std::nullopt);

}  // namespace brushsvg
