#pragma once

#include <Eigen/Core>
#include <vector>

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Places on the medial axis, one per row: x, y, distance to the outline [mm].
using AxisLine = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A place where branches meet or end: x, y and the distance to the outline [mm].
struct AxisNode {
    double x, y, radius_mm;
    double corner = 0.0;  ///< largest area that a branch dropped here would have added, in squares of the radius
};

/// A stretch of the axis between two nodes, given by their indices.
struct AxisBranch {
    int from, to;
    AxisLine line;
    Rings part;  ///< the part of the shape nearest to the branch, including the branches that were dropped from it
};

/// The medial axis of a shape: a graph of nodes and branches.
struct MedialAxis {
    std::vector<AxisNode> nodes;
    std::vector<AxisBranch> branches;  ///< a node without a branch is a round part of the shape, a dab
};

/// Return the medial axis: centres of discs that touch the outline twice or more.
///
/// It is the Voronoi diagram of the outline's edges, inside the shape, and exact for straight edges. `rings`: a shape
/// as fill() in region.hpp returns it.
///
/// A branch with a free end is dropped if it adds too little area to the disc where it begins. `min_share`: the least
/// area that it must add, in squares of that disc's radius. The remaining branches are then checked again.
MedialAxis medial_axis(const Rings& rings, double min_share);

/// Return the medial axis, and keep limbs that are thin relative to the shape.
///
/// A branch is also kept if the part beyond some place on it meets two conditions. It adds at least `min_share` to the
/// disc at that place, and at least `min_limb_share` to the disc where the branch begins. Both areas are in squares of
/// the disc's radius.
MedialAxis medial_axis(const Rings& rings, double min_share, double min_limb_share);

}  // namespace brushsvg
