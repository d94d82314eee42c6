#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <vector>

#include "brushsvg/ring.hpp"

namespace brushsvg {

constexpr double kUnitsPerMm = 1e5;  // as in region.cpp, whose rings have whole numbers of these units

inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A place on the outline: the number of an edge and a fraction of it.
struct OutlinePlace {
    std::size_t edge = 0;
    double at = 0.0;
};

/// A shape's edges in whole units, ring after ring, the shape to the left of each.
class Outline {
 public:
    static constexpr double kSamePlaceUnits = 10.0;  // units: nearer places may be one place, because of rounding

    /// Rings of less than three points are left out. Rings that touch in a corner are moved apart by less than a
    /// micrometre: a middle line through the corner would have no width. Throws Error beyond 20 m.
    explicit Outline(const Rings& rings);

    std::size_t edges() const { return starts_.size(); }
    Eigen::Vector2d start(std::size_t k) const { return starts_[k].cast<double>(); }
    Eigen::Vector2d end(std::size_t k) const { return start(after(k)); }
    std::size_t before(std::size_t k) const {
        return k == rings_[ring_of_[k]].first ? rings_[ring_of_[k]].last - 1 : k - 1;
    }
    std::size_t after(std::size_t k) const {
        return k + 1 == rings_[ring_of_[k]].last ? rings_[ring_of_[k]].first : k + 1;
    }
    bool same_ring(const OutlinePlace& a, const OutlinePlace& b) const { return ring_of_[a.edge] == ring_of_[b.edge]; }
    Eigen::Vector2d at(const OutlinePlace& f) const { return start(f.edge) + f.at * (end(f.edge) - start(f.edge)); }

    /// Return twice the area between the origin and the outline from one place forward to another; 0 for an empty walk.
    double twice_area(const OutlinePlace& from, const OutlinePlace& to) const;
    /// Append the points of the outline from one place forward to another. round: the way from a place to itself is the
    /// whole ring.
    void walk(const OutlinePlace& from, const OutlinePlace& to, bool round, std::vector<Eigen::Vector2d>& out) const;
    /// Return the whole ring of an edge [mm].
    Ring ring(std::size_t k) const;

 private:
    struct Span {
        std::size_t first, last;
    };
    void separate_touching_rings();

    std::vector<Eigen::Vector2i> starts_;  // start of each edge
    std::vector<std::size_t> ring_of_;     // ring of each edge
    std::vector<Span> rings_;
    std::vector<double> twice_area_;  // twice the area, summed up to each edge
};

}  // namespace brushsvg
