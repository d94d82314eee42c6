#pragma once

#include <Eigen/Core>
#include <vector>

#include "brushsvg/brush.hpp"
#include "patch_path.hpp"

namespace brushsvg::fit {

/// Where a point lies to what a brush paints on its way.
struct EdgePoint {
    std::size_t sample = 0;    ///< whose footprint is nearest, or holds the point deepest
    Eigen::Index edge = 0;     ///< of that footprint's outline, the nearest one,
    double t = 0.0;            ///< and where on it, in [0, 1]
    double distance_mm = 0.0;  ///< to it, negative inside
};

/// How the distance grows when the patch is moved, turned, pressed.
struct EdgeSlope {
    double x, y;     ///< per mm
    double heading;  ///< mm per rad
    double depth;    ///< per mm
};

/// What the brush paints on its way, as footprints side by side: the signed distance from their union.
///
/// A union's distance is the least of its parts' (outside exactly, inside near its edge), and its derivative is that of
/// the part alone: which part it is changes with the unknowns, but where it changes both are equally near (envelope
/// theorem).
class PaintedEdge {
 public:
    /// Outlines are used with fewer corners, at most `tolerance_mm` off.
    PaintedEdge(const Brush& brush, double tolerance_mm);

    void place(const PatchSamples& samples);
    /// `near`: a sample to begin with, the nearest known.
    EdgePoint nearest(const Eigen::Vector2d& point_mm, std::size_t near) const;
    EdgeSlope slope(const Eigen::Vector2d& point_mm, const EdgePoint& found) const;

 private:
    /// An outline on the paper, edge by edge, as rows that are worked on at once.
    struct Outline {
        Eigen::ArrayXd ax, ay, bx, by, over_length2, x_per_y;
        Eigen::Vector2d centre;
        double radius;
    };
    double to_outline(const Outline& outline, const Eigen::Vector2d& point_mm, EdgePoint& found) const;

    const Brush& brush_;
    FootprintTable few_;
    PatchSamples samples_;
    std::vector<Outline> outlines_;
};

}  // namespace brushsvg::fit
