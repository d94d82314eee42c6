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

/// The part of the Voronoi diagram of an outline's edges inside of the shape, as half edges; those of one undirected
/// edge are h and h ^ 1. Lengths in the outline's units.
class VoronoiAxis {
 public:
    explicit VoronoiAxis(const Outline& outline);
    static constexpr std::size_t none = std::size_t(-1);

    std::size_t to(std::size_t h) const { return from[h ^ 1]; }
    /// Where the outline is touched, on the left and on the right of a half edge, by the disc about its start.
    Foot foot(std::size_t h) const { return foot(left[h], points[from[h]]); }
    Foot foot_right(std::size_t h) const { return foot(left[h ^ 1], points[from[h]]); }
    double radius(std::size_t h) const { return (points[from[h]] - outline_.at(foot(h))).norm(); }
    /// Area that what begins with this half edge, up to its free end, adds to the disc about its start, over the
    /// disc's radius squared.
    double share(std::size_t h) const;
    /// Where the outline begins that belongs to the branch which leaves by h, what was dropped before it included.
    Foot begin(std::size_t h) const;
    AxisPoint at_start(std::size_t h) const;
    /// Points along a half edge without its first one.
    void sample(std::size_t h, std::vector<AxisPoint>& line) const;

    std::vector<Eigen::Vector2d> points;
    std::vector<std::size_t> from;              // of each half edge
    std::vector<Site> left;                     // on its left
    std::vector<std::size_t> next;              // the half edge that goes on in the same branch
    std::vector<std::vector<std::size_t>> out;  // half edges that leave each point, counter-clockwise, none dropped

 private:
    Foot foot(const Site& site, const Eigen::Vector2d& p) const;
    const Outline& outline_;
};

}  // namespace brushsvg
