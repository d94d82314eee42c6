#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "brushsvg/brush.hpp"
#include "patch_path.hpp"

namespace brushsvg::fit {

/// Where a point lies to rings, or to what a brush paints on its way.
struct EdgePoint {
    std::size_t sample = 0;    ///< whose footprint is nearest, or holds the point deepest
    Eigen::Index edge = 0;     ///< of that footprint's outline, the nearest one,
    double t = 0.0;            ///< and where on it, in [0, 1]
    double distance_mm = 0.0;  ///< to it, negative inside
};

/// Filled rings, edge by edge, as columns that are worked on at once.
class Edges {
 public:
    Edges() = default;
    explicit Edges(const Rings& rings);

    EdgePoint nearest(const Eigen::Vector2d& point_mm) const;
    Eigen::Index size() const { return ax_.size(); }
    Eigen::Vector2d place(Eigen::Index edge, double t) const {
        return {ax_[edge] + t * bx_[edge], ay_[edge] + t * by_[edge]};
    }
    /// Unit vector from the inside to the outside where a point was found to lie.
    Eigen::Vector2d outwards(const Eigen::Vector2d& point_mm, const EdgePoint& found) const;

 private:
    Eigen::ArrayXd ax_, ay_, bx_, by_, over_length2_, x_per_y_;
};

/// A box along the heading, about what a footprint paints.
struct HeadedBox {
    Eigen::Vector2d contact_mm, heading;
    double back_mm, front_mm, right_mm, left_mm;  ///< from the contact, along the heading and across

    /// No place in the box is nearer to the point; where the point is inside, none of its edge deeper.
    double at_least_mm(const Eigen::Vector2d& point_mm) const {
        const Eigen::Vector2d from = point_mm - contact_mm;
        const double along = from.dot(heading), across = heading.x() * from.y() - heading.y() * from.x();
        return std::max(std::max(back_mm - along, along - front_mm), std::max(right_mm - across, across - left_mm));
    }
};

/// How a distance grows when the patch is moved, turned, pressed.
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
    /// How far a place on a footprint's outline moves in a direction.
    EdgeSlope moves(const EdgePoint& place, const Eigen::Vector2d& direction) const;
    const Edges& footprint(std::size_t sample) const { return footprints_[sample]; }

 private:
    const Brush& brush_;
    FootprintTable few_;
    PatchSamples samples_;
    std::vector<Edges> footprints_;
    std::vector<HeadedBox> boxes_;  ///< about each
};

}  // namespace brushsvg::fit
