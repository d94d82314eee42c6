#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "drop.hpp"
#include "mark_fit.hpp"
#include "realised_path.hpp"

// Computes the footprints of one pass at close instants, and the edge of their union near a point. Internal to
// fit_marks.
namespace brushsvg::fit {

constexpr int kMaxTerms = 7;              // largest number of a law's coefficients
constexpr double kMinLagMm = 0.02;        // lag of a pen; at 0 the law has no derivatives
constexpr double kMinRatio = 0.1;         // smallest ratio of widest section and front to the half width
constexpr double kMinHalfWidthMm = 1e-4;  // at touch-down, because a drop without width has no direction

constexpr int kPathUnknowns = kMaxTerms + 1 + kMachineErrors;  // unknowns of the lag, height of the paper, machine

/// Derivatives of a place by the unknowns of the lag, the height of the paper and the machine.
using PathDerivatives = Eigen::Matrix<double, 2, kPathUnknowns>;

/// A pass that begins and ends in the air, with the laws and the machine that paint it. Without a machine, it runs as
/// commanded.
struct PassSetup {
    const Poses& poses;
    const std::vector<Arc>& arcs;
    const MarkLaws& laws;
    double height_mm, deepest_mm;
    const MachineState* machine;
};

/// The footprint at one instant. Lengths are in mm, slopes are derivatives by depth.
struct Instant {
    Eigen::Vector2d contact, heading;
    Drop drop;
    double place;  ///< index of the pose, fractional between poses
    double gap, depth, half_slope, gap_slope;
    double widest_ratio, widest_slope, front_ratio,
        front_slope;  ///< to the half width; slopes are 0 at the least ratio
    bool heading_known;
    std::size_t heading_source;  ///< the instant that determines its heading: itself, or the first with a known one
    double loose_lever_mm;       ///< distance from the contact of a loose brush to the TCP; infinite for a taut brush

    /// Returns x relative to the tip, with the first coordinate along the heading.
    Eigen::Vector2d in_frame(const Eigen::Vector2d& x) const {
        const Eigen::Vector2d from_tip = x - contact + gap * heading;
        return {from_tip.dot(heading), heading.x() * from_tip.y() - heading.y() * from_tip.x()};
    }
    /// Returns the place of an edge on the paper.
    Eigen::Vector2d place_of(const NearestEdge& edge) const {
        const double x = edge.by_widest * drop.widest + edge.by_front * drop.front, y = edge.by_half * drop.half;
        return contact + (x - gap) * heading + y * Eigen::Vector2d(-heading.y(), heading.x());
    }
    Eigen::Vector2d on_paper(const NearestEdge& edge) const {  ///< returns the normal of an edge on the paper
        return edge.nx * heading + edge.ny * Eigen::Vector2d(-heading.y(), heading.x());
    }
    /// Returns the place of the edge that is farthest in a direction on the paper.
    NearestEdge farthest(const Eigen::Vector2d& n) const {
        return farthest_edge(drop, n.dot(heading), heading.x() * n.y() - heading.y() * n.x());
    }
};

/// Derivatives at one instant.
struct InstantDerivatives {
    PathDerivatives contact, heading;
    Eigen::Matrix<double, 1, 1 + kMachineErrors> depth;  ///< derivatives by the height and the machine
};

/// A tangent of a footprint and its neighbour, or of the footprint alone.
struct SweptEdge {
    double distance;         ///< distance of a point, negative inside
    Eigen::Vector2d normal;  ///< outwards
    NearestEdge edge;        ///< where it touches the footprint
};

class Footprints {
 public:
    /// Computes the footprints of a pass. `at`: indices of poses, fractional between poses; more instants are added
    /// where the footprint turns quickly. coarse: factor on the distance between instants. Returns false where the laws
    /// paint nothing, and where more instants are needed than for any brush.
    bool follow(const PassSetup& pass, const std::vector<double>& at, double coarse);
    /// Computes the derivatives at some instants of the pass that was followed last, for by(). lag_by: derivatives of
    /// the lag's coefficients by its unknowns. Derivatives cost ten times as much as the instant, and points need only
    /// a third of them.
    void derive(const PassSetup& pass, const Eigen::MatrixXd& lag_by, bool by_machine, std::vector<std::size_t> rows);
    const Instant& operator[](std::size_t i) const { return rows_[i]; }
    const InstantDerivatives& derivatives(std::size_t i) const { return derivatives_[i]; }
    /// Returns the largest cost of finding the instant nearest to a point, for a checkpoint.
    int search_cost() const { return 5 + int(rows_.size() / 100); }
    /// Returns the number of evaluations of instants since follow() began, including the cost of follow() itself.
    std::uint64_t evaluations() const { return evaluations_; }

    /// Finds the edge of the footprint nearest to x, and its row; the search begins at `row`. For a point inside a
    /// footprint, the result only shows that it is inside.
    NearestEdge nearest(const Eigen::Vector2d& x, std::size_t& row) const;
    /// Returns the distance from x, inside a footprint, to the outside of all footprints in direction `out`. last: the
    /// footprint that is left last.
    double distance_to_outside(const Eigen::Vector2d& x, const Eigen::Vector2d& out, std::size_t& last) const;
    /// Returns the edge of the area that footprint `row` and its neighbours sweep, next to a place of the footprint's
    /// edge. Footprints alone would leave scallops of 0.02 mm between instants, and gaps where footprints are shorter.
    SweptEdge swept_edge(const Eigen::Vector2d& x, std::size_t row, const NearestEdge& own) const;
    /// Returns the direction of motion of a place of a footprint's edge, 0 where it rests, reverses, begins or ends.
    Eigen::Vector2d motion_direction(std::size_t row, const NearestEdge& edge) const;

 private:
    template <class Way>
    bool follow_path(const Way& way, const PassSetup& pass, const std::vector<double>& at);
    template <class Way>
    void walk(const Way& way, const std::vector<double>& at, const MarkLaws& laws);
    template <class T, class Way>
    void derive_path(const Way& way, const MarkLaws& laws, const Eigen::MatrixXd& lag_by,
                     const std::vector<std::size_t>& rows);
    void bound_footprints();
    /// Moves from an instant to its neighbours as long as they are nearer to x, or x is deeper inside them.
    std::size_t descend_to_nearest(const Eigen::Vector2d& x, std::size_t row) const;
    /// Returns these places and more between instants whose footprints are too far apart; the same number where none
    /// are.
    std::vector<double> refine_places(const std::vector<double>& at) const;

    std::vector<Instant> rows_;
    std::vector<InstantDerivatives> derivatives_;
    /// A circle around each footprint, and an upper bound of the distance that its points have moved since the first
    /// instant.
    std::vector<Eigen::Vector2d> middle_;
    std::vector<double> radius_, travelled_;
    double reach_ = 0.0;        ///< greatest depth of the pass, or of the laws
    double max_step_mm_ = 0.0;  ///< largest movement of a footprint's point from one instant to the next [mm]
    mutable std::uint64_t evaluations_ = 0;
};

}  // namespace brushsvg::fit
