#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "brushsvg/brush.hpp"
#include "patch_path.hpp"

namespace brushsvg::fit {

/// Position of a point relative to rings, or to the area that a brush paints on its way.
struct EdgePoint {
    std::size_t sample = 0;    ///< the sample whose footprint is nearest, or holds the point deepest
    Eigen::Index edge = 0;     ///< nearest edge of that footprint's outline
    double t = 0.0;            ///< position on the edge, in [0, 1]
    double distance_mm = 0.0;  ///< distance to the edge, negative inside
};

/// Filled rings, stored edge by edge in columns for vectorised code.
class FilledRings {
 public:
    FilledRings() = default;
    explicit FilledRings(const Rings& rings);
    void set(const Ring& ring);

    EdgePoint nearest(const Eigen::Vector2d& point_mm) const;
    Eigen::Index size() const { return ax_.size(); }
    Eigen::Vector2d place(Eigen::Index edge, double t) const {
        return {ax_[edge] + t * bx_[edge], ay_[edge] + t * by_[edge]};
    }
    /// Return the unit vector from the inside to the outside where a point was found.
    Eigen::Vector2d outwards(const Eigen::Vector2d& point_mm, const EdgePoint& found) const;

 private:
    /// Some consecutive edges, within a box.
    struct EdgeBox {
        Eigen::Index first, last;
        double left, bottom, right, top;
    };

    void resize(Eigen::Index n);
    void store_ring(const Ring& ring, Eigen::Index first);
    void update_derived();

    Eigen::ArrayXd ax_, ay_, bx_, by_, over_length2_, x_per_y_;
    std::vector<EdgeBox> parts_;
};

/// Derivatives of a sum by a sample's x, y, heading and depth: per mm, per rad.
using SampleSlope = Eigen::Vector4d;

/// The area that the brush paints on its way, as footprints side by side, with the signed distance from their union.
///
/// A union's distance is the least of its parts' distances (exact outside, and inside near its edge). Its derivative is
/// the derivative of the nearest part alone. Which part is nearest changes with the unknowns, but where it changes both
/// are equally near (envelope theorem).
class PaintedEdge {
 public:
    /// `tolerance_mm`: how far the simplified footprint outlines may be off.
    PaintedEdge(const Brush& brush, double tolerance_mm);

    void place_footprints(const PatchSamples& samples);
    /// Find the nearest edge to a point. `near`: sample with which the search begins, the nearest known one.
    EdgePoint nearest(const Eigen::Vector2d& point_mm, std::size_t near) const;
    /// Return the derivatives of the distance of a point that was found.
    SampleSlope slope(const Eigen::Vector2d& point_mm, const EdgePoint& found) const;
    /// Return the derivatives of how far a place on a footprint's outline moves in a direction.
    SampleSlope motion_slope(const EdgePoint& place, const Eigen::Vector2d& direction) const;
    Eigen::Vector2d place_of(const EdgePoint& place) const;
    Eigen::Index corners() const { return simplified_.vertex_count(); }

 private:
    static constexpr int kAxisCount = 8;
    /// A footprint about its contact, heading along +x, and its extent along axes in both directions.
    struct Placed {
        Eigen::Vector2d contact, heading;
        FilledRings outline;
        std::array<double, kAxisCount> ahead, behind;
        double depth, reach;
        mutable Ring by_depth;  ///< derivative of the outline by depth, computed when first needed

        Eigen::Vector2d in_footprint_frame(const Eigen::Vector2d& p) const {
            const Eigen::Vector2d from = p - contact;
            return {from.dot(heading), heading.x() * from.y() - heading.y() * from.x()};
        }
        Eigen::Vector2d on_paper(const Eigen::Vector2d& v) const {
            return {heading.x() * v.x() - heading.y() * v.y(), heading.y() * v.x() + heading.x() * v.y()};
        }
        /// Return a lower bound of the point's signed distance: no place of the footprint is nearer, and no edge is
        /// deeper.
        double distance_bound_mm(const Eigen::Vector2d& seen) const;
    };
    /// Neighbouring footprints, within a circle.
    struct SampleGroup {
        std::size_t first, last;
        Eigen::Vector2d middle;
        double radius;
    };

    const Brush& brush_;
    FootprintTable simplified_;
    std::vector<Placed> placed_;
    std::vector<SampleGroup> groups_;
};

}  // namespace brushsvg::fit
