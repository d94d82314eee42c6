#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "drop.hpp"
#include "mark_fit.hpp"
#include "run_way.hpp"

// The footprints of one pass at close instants, and the near part of their union. Inside fit_marks.
namespace brushsvg::fit {

constexpr int kMostTerms = 7;          // numbers of a law
constexpr double kLeastLagMm = 0.02;   // a pen's; at 0 the law loses its derivatives
constexpr double kLeastRatio = 0.1;    // of widest section and front to the half width
constexpr double kLeastHalfMm = 1e-4;  // at touch-down, where a drop without width would have no direction

constexpr int kWays = kMostTerms + 1 + kMachine;  // the lag's unknowns, the height of the paper, the machine

/// Derivatives of a place by the lag's unknowns, the height of the paper and the machine.
using ByLag = Eigen::Matrix<double, 2, kWays>;

/// A pass on its way, which begins and ends in the air, as these laws are painted by this machine; without one it is
/// run as commanded.
struct PassRun {
    const Poses& poses;
    const std::vector<Arc>& arcs;
    const MarkLaws& laws;
    double height_mm, deepest_mm;
    const MachineHere* machine;
};

/// The footprint at one instant. Lengths in mm, slopes by depth.
struct Instant {
    Eigen::Vector2d contact, heading;
    Drop drop;
    double place;  ///< poses, fractional in between
    double gap, depth, half_slope, gap_slope;
    double widest_ratio, widest_slope, front_ratio, front_slope;  ///< to the half width; slopes 0 at the least ratio
    bool heading_known;
    std::size_t heading_of;  ///< the instant whose heading it has: itself, or the first that knows one
    double loose_lever_mm;   ///< from where a loose brush touches to the TCP, along which it points; taut: infinite

    /// x from the tip, its first coordinate along the heading.
    Eigen::Vector2d in_frame(const Eigen::Vector2d& x) const {
        const Eigen::Vector2d from_tip = x - contact + gap * heading;
        return {from_tip.dot(heading), heading.x() * from_tip.y() - heading.y() * from_tip.x()};
    }
    /// The place on the paper of what is a place of the edge.
    Eigen::Vector2d place_of(const NearestEdge& edge) const {
        const double x = edge.by_widest * drop.widest + edge.by_front * drop.front, y = edge.by_half * drop.half;
        return contact + (x - gap) * heading + y * Eigen::Vector2d(-heading.y(), heading.x());
    }
    Eigen::Vector2d on_paper(const NearestEdge& edge) const {  ///< its normal
        return edge.nx * heading + edge.ny * Eigen::Vector2d(-heading.y(), heading.x());
    }
    /// The place of the edge that is farthest in a direction on the paper.
    NearestEdge farthest(const Eigen::Vector2d& n) const {
        return farthest_edge(drop, n.dot(heading), heading.x() * n.y() - heading.y() * n.x());
    }
};

/// Derivatives at one instant.
struct InstantBy {
    ByLag contact, heading;
    Eigen::Matrix<double, 1, 1 + kMachine> depth;  ///< by the height and the machine
};

/// A line that touches a footprint and its neighbour, or the footprint alone.
struct SweptEdge {
    double distance;         ///< of a point, negative inside
    Eigen::Vector2d normal;  ///< outwards
    NearestEdge edge;        ///< where it touches the footprint
};

class Footprints {
 public:
    /// Follows a pass; `at`: poses, fractional in between, and more are put in where the footprint turns quickly.
    /// coarse: so many times as far apart as they should be may instants be. False where these laws paint nothing, and
    /// where it needs more instants than any brush does.
    bool follow(const PassRun& pass, const std::vector<double>& at, double coarse);
    /// Derivatives at these instants, as by() then returns them, of the pass that was followed last; lag_by: of the
    /// lag's coefficients by its unknowns. They cost ten times what an instant itself does, and points need a third of
    /// them.
    void derive(const PassRun& pass, const Eigen::MatrixXd& lag_by, bool by_machine, std::vector<std::size_t> rows);
    const Instant& operator[](std::size_t i) const { return rows_[i]; }
    const InstantBy& by(std::size_t i) const { return by_[i]; }
    /// What looking for a point's nearest instant costs at most, for a checkpoint.
    int effort() const { return 5 + int(rows_.size() / 100); }
    /// How often an instant was looked at since follow() began, which itself costs more than a look for each.
    std::uint64_t looks() const { return looks_; }

    /// Edge of the footprint that comes nearest to x, and which one; the search begins at `row`. Of a point inside
    /// only that it is.
    NearestEdge nearest(const Eigen::Vector2d& x, std::size_t& row) const;
    /// How far it is from x, inside a footprint, out of all of them in direction `out`; which one is left last.
    double way_out(const Eigen::Vector2d& x, const Eigen::Vector2d& out, std::size_t& last) const;
    /// Edge of what footprint `row` and its neighbours sweep, next to a place of the footprint's own edge: instants are
    /// so far apart that footprints alone would leave scallops of 0.02 mm, and gaps where they are shorter than that.
    SweptEdge swept(const Eigen::Vector2d& x, std::size_t row, const NearestEdge& own) const;
    /// Direction in which a place of a footprint's edge passes by; none where it rests, turns back, begins or ends.
    Eigen::Vector2d passing(std::size_t row, const NearestEdge& edge) const;

 private:
    template <class Way>
    bool follow_on(const Way& way, const PassRun& pass, const std::vector<double>& at);
    template <class Way>
    void walk(const Way& way, const std::vector<double>& at, const MarkLaws& laws);
    template <class T, class Way>
    void derive_on(const Way& way, const MarkLaws& laws, const Eigen::MatrixXd& lag_by,
                   const std::vector<std::size_t>& rows);
    void enclose();
    /// From an instant on to neighbours as long as they come nearer to x, or x is deeper in them.
    std::size_t downhill(const Eigen::Vector2d& x, std::size_t row) const;
    /// Those places, and more between instants whose footprints are too far apart; as many where there are none.
    std::vector<double> closer(const std::vector<double>& at) const;

    std::vector<Instant> rows_;
    std::vector<InstantBy> by_;
    /// Round each footprint; gone: no point of the footprint has moved further than this since the first instant.
    std::vector<Eigen::Vector2d> middle_;
    std::vector<double> radius_, gone_;
    double reach_ = 0.0;  ///< the greatest depth of the pass, or of the laws
    double apart_ = 0.0;  ///< most that a point of the footprint moves from one instant to the next [mm]
    mutable std::uint64_t looks_ = 0;
};

}  // namespace brushsvg::fit
