#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "brushsvg/plan.hpp"

namespace brushsvg {

/// What counts as one circle: far more than rounding, far less than is written to a file.
inline constexpr double kSameCircleMm = 1e-8;

/// Poses of a pass as they are found, and the circles through some of them.
class PoseList {
 public:
    void add(const Eigen::Vector2d& tcp_mm, double depth_mm);
    /// The poses from `first` on go round a centre; one arc with the one before where that goes on.
    void arc(std::int64_t first, const Eigen::Vector2d& centre_mm, double angle_rad);
    std::int64_t last() const { return std::int64_t(poses_.size()) - 1; }
    void into(Pass& pass) const;

 private:
    std::vector<std::array<double, 3>> poses_;
    std::vector<Arc> arcs_;
};

}  // namespace brushsvg
