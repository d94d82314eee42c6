#pragma once

#include <Eigen/Core>
#include <vector>

namespace [[gnu::visibility("default")]] brushsvg {

/// Points in the plane, one per row [mm]; as an outline unclosed.
using Ring = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// Outer rings counter-clockwise, holes clockwise.
using Rings = std::vector<Ring>;

/// Part of the paper that an image shows [mm]: lower left corner and size.
struct Window {
    double x_mm, y_mm, width_mm, height_mm;
};

/// Area [mm^2], negative for a clockwise ring.
double signed_area(const Ring& ring);

/// Length of a ring, from its last point to its first as well [mm].
double length_around(const Ring& ring);

}  // namespace brushsvg
