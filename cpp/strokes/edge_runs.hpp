#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "brushsvg/ring.hpp"

namespace brushsvg {

/// A stretch of a shape's outline between two corners, the shape on its left, or a ring without corners.
struct EdgeRun {
    Ring points;                ///< for a ring, the first point is repeated at the end
    std::vector<double> at_mm;  ///< arc length of each point
    bool is_ring = false;
    std::array<double, 2> turns_rad{};  ///< by how much the outline turns to the left at its start and its end

    double length_mm() const { return at_mm.back(); }
    /// Return the place at an arc length and the direction there. Beyond its ends the run continues straight; a ring is
    /// periodic.
    std::pair<Eigen::Vector2d, Eigen::Vector2d> at(double arc_mm) const;
    /// Return the distance of a place from the run, and the arc length of the nearest point.
    std::pair<double, double> nearest(const Eigen::Vector2d& place_mm) const;
};

/// A corner that points outwards, and the direction that bisects the shape there.
struct OuterCorner {
    Eigen::Vector2d at_mm, inwards;
};

struct OutlineEdges {
    std::vector<EdgeRun> runs;
    std::vector<OuterCorner> corners;
};

/// Split outlines at their corners of more than 30 degrees.
OutlineEdges find_edge_runs(const Rings& rings);

}  // namespace brushsvg
