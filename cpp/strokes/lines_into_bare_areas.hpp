#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "brushsvg/cubic_fit.hpp"
#include "regions/nearest_on_polyline.hpp"
#include "strokes/canvas.hpp"
#include "strokes/edge_runs.hpp"

namespace brushsvg {

/// A connected unpainted area of a shape, without a rim as wide as `seen_mm`. places: the middles of its pixels.
struct BareArea {
    std::vector<Eigen::Vector2d> places;
    Eigen::Vector2d deepest;  ///< the place farthest from the area's edge
};

/// The outline of a shape, with the distances that candidates need.
class ShapeOutline {
 public:
    ShapeOutline(const Rings& rings, const Canvas& canvas);

    const OutlineEdges& edges() const { return edges_; }
    /// Return the distance from the outline; 0 outside of the shape.
    double room_mm(const Eigen::Vector2d& at_mm);
    /// Return the distance from the outline, inside and outside of the shape.
    double edge_mm(const Eigen::Vector2d& at_mm);
    /// Return whether the straight way between two places stays in the shape.
    bool is_clear(const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm) const;

 private:
    const Canvas& canvas_;
    Rings closed_;
    std::vector<NearestOnPolyline<Ring>> nearest_;
    OutlineEdges edges_;
};

/// Return a stroke that is nowhere wider than the room of the shape about its middle line, within a tolerance.
Stroke within_room(Stroke stroke, ShapeOutline& outline, double tolerance_mm);

/// Lines with half widths [mm] that may paint a bare area. The search decides whether they do.
using Candidates = std::vector<WideLine>;

/// Return lines straight out from the nearest place on a middle line, to the middle of the area and to its farthest
/// place. They stay in the shape and are as wide as it has room. half_mm: the brush's least and greatest half width.
Candidates lines_straight_out(const BareArea& area, const std::vector<MiddlePolyline>& middles, ShapeOutline& outline,
                              const std::array<double, 2>& half_mm);

/// Return lines along the middle lines of strokes that have another path now: the stretch that meets the area, as wide
/// as the stroke was there, in both directions.
Candidates lines_along_middles(const BareArea& area, const std::vector<MiddlePolyline>& former,
                               const std::array<double, 2>& half_mm);

/// Return lines along each stretch of the outline that the area touches, in both directions and in several widths.
Candidates lines_along_edges(const BareArea& area, ShapeOutline& outline, const std::array<double, 2>& half_mm);

/// Return lines inwards from each corner that the area touches. They are as wide as the shape has room, up to a width.
Candidates lines_from_corners(const BareArea& area, ShapeOutline& outline, const std::array<double, 2>& half_mm);

/// Return lines along and across an area that is surrounded by paint.
Candidates lines_across(const BareArea& area, ShapeOutline& outline, const std::array<double, 2>& half_mm);

}  // namespace brushsvg
