#pragma once

#include <Eigen/Core>
#include <vector>

namespace [[gnu::visibility("default")]] brushsvg {

/// Points in the plane, one per row [mm]; as an outline unclosed.
using Ring = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// Outer rings counter-clockwise, holes clockwise.
using Rings = std::vector<Ring>;

/// Area [mm^2], negative for a clockwise ring.
double signed_area(const Ring& ring);

}  // namespace brushsvg
