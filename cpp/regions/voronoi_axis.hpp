#pragma once

#include <array>
#include <vector>

#include "regions/outline.hpp"

namespace brushsvg {

/// The part of the outline that is nearest on one side of the axis: an edge, or the corner at which it starts.
struct Site {
    std::size_t edge;
    bool is_corner;
};

/// A point of a sampled axis: x, y and distance to the outline [mm].
using AxisPoint = std::array<double, 3>;

/// The part of the Voronoi diagram of an outline's edges that is inside of the shape, as half edges. The half edges of
/// one undirected edge are h and h ^ 1. Lengths are in the outline's units.
class VoronoiAxis {
 public:
    explicit VoronoiAxis(const Outline& outline);
    static constexpr std::size_t none = std::size_t(-1);

    std::size_t to(std::size_t h) const { return from[h ^ 1]; }
    /// Return where the disc about a half edge's start touches the outline: on the left, and on the right of the half
    /// edge.
    OutlinePlace foot(std::size_t h) const { return foot(left[h], points[from[h]]); }
    OutlinePlace foot_right(std::size_t h) const { return foot(left[h ^ 1], points[from[h]]); }
    double radius(std::size_t h) const { return (points[from[h]] - outline_.at(foot(h))).norm(); }
    /// Return the area that the branch beginning with this half edge adds to the disc about its start, up to its free
    /// end. The area is in squares of the disc's radius.
    double share(std::size_t h) const;
    /// Return where the outline begins that belongs to the branch which leaves by h. It includes branches dropped
    /// before h.
    OutlinePlace begin(std::size_t h) const;
    AxisPoint at_start(std::size_t h) const;
    /// Append points along a half edge, without its first one.
    void sample(std::size_t h, std::vector<AxisPoint>& line) const;

    std::vector<Eigen::Vector2d> points;
    std::vector<std::size_t> from;  // start point of each half edge
    std::vector<Site> left;         // site on the left of each half edge
    std::vector<std::size_t> next;  // the half edge that continues the same branch
    // half edges that leave each point, counter-clockwise, without dropped ones
    std::vector<std::vector<std::size_t>> out;

 private:
    OutlinePlace foot(const Site& site, const Eigen::Vector2d& p) const;
    const Outline& outline_;
};

}  // namespace brushsvg
