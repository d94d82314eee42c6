#pragma once

#include <array>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/lag.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/plan.hpp"

namespace brushsvg {

/// How the edges of a mark go on at one instant: the ways of both ends of the widest section, left and right of the
/// heading, per mm of the TCP's.
struct Edges {
    std::array<Eigen::Vector2d, 2> way{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
    std::array<bool, 2> shows{};  ///< goes ahead; an inner edge that turns back paints over its own mark
};

/// Of a taut brush whose TCP goes along a direction, deeper by so much per mm.
Edges edges_of(const Brush& brush, const LagLaw<double>& law, const LagState<double>& state,
               const Eigen::Vector2d& along, double depth_mm, double deeper);

/// Greatest angle between two ways of an edge that shows [rad].
double corner_between(const Edges& before, const Edges& after);

/// What the brush does at every pose of a pass as it is.
struct TracedPass {
    Ring tcp, middle;
    std::vector<double> depth, along;  ///< along: path of the TCP [mm]
    double deepest = 0.0;
    std::vector<Eigen::Vector2d> contact, heading;
    std::vector<bool> taut;                ///< at the pose
    std::vector<bool> dragged;             ///< from the pose to the next: taut all the way, in a straight move
    std::vector<Eigen::Index> level;       ///< the last pose that is reached at this depth
    std::vector<Edges> reaching, leaving;  ///< at the pose; both half way between where the path only bends

    /// widest: widest_points() of the marks.
    TracedPass(const Pass& pass, const Brush& brush, const LagLaw<double>& law, const PassMarks& marks,
               const Ring& widest);

    Eigen::Vector3d pose(Eigen::Index i) const { return {tcp(i, 0), tcp(i, 1), depth[i]}; }
    /// Where the TCP was after a way: x, y, depth. `near`: a pose to look from.
    Eigen::Vector3d at(double s, Eigen::Index near) const;

 private:
    void trace(const PassMarks& marks, const Ring& widest);
    void find_edges(const Brush& brush, const LagLaw<double>& law);
};

}  // namespace brushsvg
