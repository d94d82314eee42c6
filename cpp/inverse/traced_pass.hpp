#pragma once

#include <array>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/lag.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/plan.hpp"

namespace brushsvg {

/// Directions in which the edges of a mark continue at one instant. They are the motions of both ends of the widest
/// section, left and right of the heading, per mm of the TCP's path.
struct Edges {
    std::array<Eigen::Vector2d, 2> direction{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
    /// The edge moves ahead; an inner edge that turns back paints over its own mark.
    std::array<bool, 2> is_visible{};
};

/// Return the edges of a taut brush whose TCP moves along a direction and gets deeper by `deeper` per mm.
Edges edges_of(const Brush& brush, const LagLaw<double>& law, const LagState<double>& state,
               const Eigen::Vector2d& along, double depth_mm, double deeper);

/// Return the greatest angle between the two ways of an edge that shows [rad].
double corner_between(const Edges& before, const Edges& after);

/// State of the brush at every pose of the original pass.
struct TracedPass {
    Ring tcp, middle;
    std::vector<double> depth, along;  ///< along: length of the TCP's path [mm]
    double deepest = 0.0;
    std::vector<Eigen::Vector2d> contact, heading;
    std::vector<bool> taut;           ///< whether the brush is taut at the pose
    std::vector<bool> dragged;        ///< from the pose to the next: taut all the way, in a straight move
    std::vector<Eigen::Index> level;  ///< the last pose up to which this depth is kept
    /// Before and after the pose; where the path only bends, both are the mean direction.
    std::vector<Edges> reaching, leaving;

    /// `widest`: the result of widest_points() for the marks.
    TracedPass(const Pass& pass, const Brush& brush, const LagLaw<double>& law, const PassMarks& marks,
               const Ring& widest);

    Eigen::Vector3d pose(Eigen::Index i) const { return {tcp(i, 0), tcp(i, 1), depth[i]}; }
    /// Return x, y and depth of the TCP after a path length. `near`: a pose at which the search starts.
    Eigen::Vector3d at(double s, Eigen::Index near) const;

 private:
    void trace(const PassMarks& marks, const Ring& widest);
    void find_edges(const Brush& brush, const LagLaw<double>& law);
};

}  // namespace brushsvg
