#pragma once

#include <Eigen/Core>
#include <vector>

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Places on the medial axis, one per row: x, y and distance to the outline [mm].
using AxisLine = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Where branches meet or end.
struct AxisNode {
    double x, y, radius_mm;
    double corner = 0.0;  ///< largest area that a branch dropped here would have added, in squares of the radius
};

/// A stretch of the axis between two nodes.
struct AxisBranch {
    int from, to;
    AxisLine line;
    Rings part;  ///< the part of the shape nearest to it, what was dropped along it included
};

struct MedialAxis {
    std::vector<AxisNode> nodes;
    std::vector<AxisBranch> branches;  ///< a node without a branch is a part of the shape that is but a dab
};

/// Centres of the discs that touch the outline at two places or more, exact for the rings' straight edges: the Voronoi
/// diagram of the edges, inside. A branch with a free end is dropped, and what remains looked at again, when it adds
/// less than `least_share` squares of the radius where it leaves: area that the disc there does not cover.
/// rings: as `fill` returns them.
MedialAxis medial_axis(const Rings& rings, double least_share);

/// The same, with limbs kept that are thin relative to what they leave: a branch stays when the part beyond some place
/// on it adds `least_share` squares of the radius there to the disc there, and at least `least_limb` squares of the
/// radius where the branch leaves.
MedialAxis medial_axis(const Rings& rings, double least_share, double least_limb);

}  // namespace brushsvg
