#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "brushsvg/ring.hpp"
#include "brushsvg/settings.hpp"
#include "brushsvg/stroke_id.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Cubic Bezier segments, one per row: x0 y0 x1 y1 x2 y2 x3 y3 [mm], end to end.
using Cubics = Eigen::Matrix<double, Eigen::Dynamic, 8, Eigen::RowMajor>;

/// Half width at a fraction of the middle line's arc length; linear in between, constant beyond.
struct WidthKnot {
    double at;  ///< 0 at the start, 1 at the end
    double half_width_mm;
};

/// What the designer drew: a middle line with a width along it, in painting direction.
struct Stroke {
    StrokeId id;
    Cubics middle_mm;
    bool closed = false;
    std::vector<WidthKnot> half_width;
    Rings wanted_mm;  ///< the drawn outline where there is one; empty: the path with its width and round caps
    std::string layer;
    std::string colour;
    Settings settings;
    bool start_covered = false, end_covered = false;  ///< where it meets others, whose paint covers that end
};

/// A place on the middle line: cubic number and its parameter in [0, 1].
struct Place {
    Eigen::Index cubic;
    double t;
};

Eigen::Vector2d point_at(const Cubics& middle_mm, const Place& place);
/// Unit tangent; where the derivative vanishes (a handle of no length) its limit from inside the cubic. Zero for a
/// cubic that is a single point.
Eigen::Vector2d tangent_at(const Cubics& middle_mm, const Place& place);
/// Arc length [mm] of one cubic between two parameters.
double arc_length(const Cubics& middle_mm, Eigen::Index cubic, double t0, double t1);
/// Parameter at an arc length [mm] from the beginning of one cubic; 0 or 1 for lengths before or behind it.
double parameter_at(const Cubics& middle_mm, Eigen::Index cubic, double length_mm);
/// Half width [mm] at a fraction of the middle line's arc length.
double half_width_at(const Stroke& stroke, double fraction);
/// Throws Error when the stroke has no cubic, no width, or a number that is not finite.
void check(const Stroke& stroke);

/// The middle line as points: no point of the curve is further than the tolerance [mm] from the polyline.
/// Rows: x, y [mm], arc length [mm], half width [mm]. One row when the line is a single point.
using MiddlePolyline = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
MiddlePolyline flatten(const Stroke& stroke, double tolerance_mm);

}  // namespace brushsvg
