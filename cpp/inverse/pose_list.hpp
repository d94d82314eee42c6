#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "brushsvg/plan.hpp"

namespace brushsvg {

/// Tolerance for points on one circle [mm]: far more than rounding, far less than the resolution of a file.
inline constexpr double kCircleToleranceMm = 1e-8;

/// The poses of a pass while it is built, and the arcs through some of them.
class PoseList {
 public:
    void add(const Eigen::Vector2d& tcp_mm, double depth_mm);
    /// Note that the poses from `first` on are on an arc about a centre. It is merged with the arc before it if it
    /// continues that one.
    void arc(std::int64_t first, const Eigen::Vector2d& centre_mm, double angle_rad);
    std::int64_t last() const { return std::int64_t(poses_.size()) - 1; }
    void write_to(Pass& pass) const;

 private:
    std::vector<std::array<double, 3>> poses_;
    std::vector<Arc> arcs_;
};

}  // namespace brushsvg
