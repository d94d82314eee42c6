#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"

namespace brushsvg {

/// What counts as one circle: far more than rounding, far less than is written to a file.
inline constexpr double kSameCircleMm = 1e-8;

/// Poses of a pass as they are found, and the circles that some of them lie on.
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

/// A taut brush at one instant: all that a landing leads to and a lift begins with.
struct Stance {
    Eigen::Vector2d contact_mm;  ///< P
    Eigen::Vector2d heading;     ///< u
    double depth_mm;
};

/// Touches down over P and runs up to P + r u while pressing: there the brush is taut, and P was not moved.
void land(const Stance& first, const Brush& brush, PoseList& out);

/// Holds P and comes back along q = P + r(depth) u, a little inside: no tail.
void lift(const Stance& last, const Brush& brush, PoseList& out);

}  // namespace brushsvg
