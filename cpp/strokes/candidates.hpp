#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "brushsvg/curve_fit.hpp"
#include "regions/nearest_on_polyline.hpp"
#include "strokes/canvas.hpp"
#include "strokes/edge_runs.hpp"

namespace brushsvg {

/// A connected area of a shape without paint, as deep as it is seen. places: the middles of its pixels.
struct BareArea {
    std::vector<Eigen::Vector2d> places;
    Eigen::Vector2d deepest;  ///< farthest from its own edge
};

/// A shape as candidates see it.
class Outline {
 public:
    Outline(const Rings& rings, const Canvas& canvas);

    const OutlineEdges& edges() const { return edges_; }
    /// Distance from the outline; 0 outside of the shape.
    double room_mm(const Eigen::Vector2d& at_mm);
    /// Distance from the outline, on whichever side.
    double edge_mm(const Eigen::Vector2d& at_mm);

 private:
    const Canvas& canvas_;
    Rings closed_;
    std::vector<Nearest<Ring>> nearest_;
    OutlineEdges edges_;
};

/// Lines with half widths [mm] that may paint a bare area: none decides whether it does.
using Candidates = std::vector<WideLine>;

/// Straight out from the nearest place on a middle line to the middle of the area, and to its farthest place, as wide
/// as the shape has room. half_mm: the brush's least and greatest.
Candidates straight_out(const BareArea& area, const std::vector<MiddlePolyline>& middles, Outline& outline,
                        const std::array<double, 2>& half_mm);

/// Along the middle lines of strokes that were given another path: the stretch that meets the area, as wide as it was,
/// both ways.
Candidates along_middles(const BareArea& area, const std::vector<MiddlePolyline>& former,
                         const std::array<double, 2>& half_mm);

/// Along each stretch of the outline that the area touches, both ways, in several widths.
Candidates along_edges(const BareArea& area, Outline& outline, const std::array<double, 2>& half_mm);

/// From each corner that the area touches inwards, as wide as the shape has room up to a width.
Candidates from_corners(const BareArea& area, Outline& outline, const std::array<double, 2>& half_mm);

/// Along and across an area amid paint.
Candidates across(const BareArea& area, Outline& outline, const std::array<double, 2>& half_mm);

}  // namespace brushsvg
