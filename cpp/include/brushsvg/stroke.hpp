#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "brushsvg/ring.hpp"
#include "brushsvg/settings.hpp"
#include "brushsvg/stroke_id.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Cubic Bezier segments joined end to end, one per row, in the paper frame.
///
/// Columns: x0 y0 x1 y1 x2 y2 x3 y3 [mm].
using Cubics = Eigen::Matrix<double, Eigen::Dynamic, 8, Eigen::RowMajor>;

/// Half width at a fraction of the middle line's arc length. It is linear between knots and constant beyond them.
struct WidthKnot {
    double at;  ///< 0 at the start, 1 at the end
    double half_width_mm;
};

/// A stroke as drawn: a middle line in painting direction, with a width along it.
struct Stroke {
    StrokeId id;
    Cubics middle_mm;
    bool closed = false;  ///< whether the middle line ends where it begins
    std::vector<WidthKnot> half_width;
    Rings target_mm;  ///< target outline as drawn; empty: the path with its width and round caps
    std::string layer;
    std::string colour;
    Settings settings;
    bool start_covered = false, end_covered = false;  ///< true if the paint of an adjoining stroke covers that end
};

/// A place on the middle line: the index of a cubic, and a parameter in [0, 1] on it.
struct Place {
    Eigen::Index cubic;
    double t;
};

/// Return the point at a place [mm].
Eigen::Vector2d point_at(const Cubics& middle_mm, const Place& place);
/// Return the unit tangent at a place.
///
/// Where the derivative vanishes (a handle of zero length), returns its limit from inside the cubic. Zero for a cubic
/// that is a single point.
Eigen::Vector2d tangent_at(const Cubics& middle_mm, const Place& place);
/// Return the arc length [mm] of one cubic between two parameters.
double arc_length(const Cubics& middle_mm, Eigen::Index cubic, double t0, double t1);
/// Return the parameter at an arc length [mm] from the beginning of one cubic.
///
/// 0 for lengths before the cubic, 1 for lengths beyond it.
double parameter_at(const Cubics& middle_mm, Eigen::Index cubic, double length_mm);
/// Return the half width [mm] at a fraction of the middle line's arc length.
double half_width_at(const Stroke& stroke, double fraction);
/// Throw Error if the stroke has no cubic, no width, or a number that is not finite.
///
/// Also throws if cubics do not join, or if half widths are negative or not in ascending order of their places.
void check(const Stroke& stroke);

/// The middle line as points. No point of the curve is further than the tolerance from the polyline.
///
/// Rows: x, y [mm], arc length [mm], half width [mm]. One row if the line is a single point.
using MiddlePolyline = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
/// Return the middle line of a stroke as a polyline within a tolerance [mm].
///
/// Throws Error as check() does, and for a tolerance out of range.
MiddlePolyline flatten(const Stroke& stroke, double tolerance_mm);

}  // namespace brushsvg
