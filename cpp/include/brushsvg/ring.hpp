#pragma once

#include <Eigen/Core>
#include <vector>

namespace [[gnu::visibility("default")]] brushsvg {

/// Points in the plane, one per row: x, y [mm]. An outline does not repeat its first point.
using Ring = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// The rings of a shape: outer rings counter-clockwise, holes clockwise.
using Rings = std::vector<Ring>;

/// The part of the paper that an image shows: its lower left corner and its size.
struct Window {
    double x_mm, y_mm, width_mm, height_mm;
};

/// Return the area of a ring [mm^2], negative if it is clockwise.
double signed_area(const Ring& ring);

/// Return the length of a ring [mm], including the edge from its last point to its first.
double length_around(const Ring& ring);

}  // namespace brushsvg
