#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "brushsvg/ring.hpp"

namespace brushsvg {

/// A stretch of a shape's outline between two corners, the shape on its left, or a ring without corners.
struct EdgeRun {
    Ring points;                ///< of a ring the first is the last again
    std::vector<double> at_mm;  ///< arc length of each point
    bool is_ring = false;
    std::array<double, 2> turns_rad{};  ///< by how much the outline turns to the left where it begins and ends

    double length_mm() const { return at_mm.back(); }
    /// The place at an arc length and the direction there, straight on beyond the ends, round and round a ring.
    std::pair<Eigen::Vector2d, Eigen::Vector2d> at(double arc_mm) const;
    /// Distance of a place from the run, and the arc length of the nearest point.
    std::pair<double, double> nearest(const Eigen::Vector2d& place_mm) const;
};

/// A corner that points outwards, and the direction from it that bisects the shape there.
struct OuterCorner {
    Eigen::Vector2d at_mm, inwards;
};

struct OutlineEdges {
    std::vector<EdgeRun> runs;
    std::vector<OuterCorner> corners;
};

/// Outlines between their corners of more than 30 degrees.
OutlineEdges edge_runs(const Rings& rings);

}  // namespace brushsvg
