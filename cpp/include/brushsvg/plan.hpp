#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace brushsvg {

/// TCP poses, one per row: x, y, z [mm] in the paper frame; z = -depth while painting.
using Poses = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// No table is larger: a coordinate beyond it is damage, and squares of it still add up.
inline constexpr double kLargestMm = 1e6;

/// One stroke's motion: straight moves between poses, depth linear along each.
struct Pass {
    std::string stroke;  ///< id of the stroke it paints
    Poses poses_mm;
    double speed_mm_s = 20.0;
    std::string layer;
    std::string colour;
    std::string settings = "{}";  ///< JSON object
    std::string extra = "{}";     ///< JSON object of unknown keys, written back as read
};

struct Plan {
    std::string brush;
    std::string brush_sha256;
    std::array<double, 2> sheet_mm{0.0, 0.0};
    std::vector<Pass> passes;
    std::string extra = "{}";
};

}  // namespace brushsvg
