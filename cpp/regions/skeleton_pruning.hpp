#pragma once

#include <tuple>
#include <utility>
#include <vector>

#include "regions/voronoi_axis.hpp"

namespace brushsvg {

/// What is dropped of an axis, and the part then between nodes.
class KeptBranches {
 public:
    explicit KeptBranches(VoronoiAxis& axis);
    /// Drops branches with a free end that add less to the disc they leave, in squares of its radius, unless they are
    /// limbs: the part beyond some place of a limb adds least_share to the disc there, and least_limb to the disc it
    /// leaves.
    void drop(double least_share, double least_limb);

    bool is_node(std::size_t p) const;
    double corner(std::size_t p) const { return corner_[p]; }
    /// Points of which everything was dropped, and the radius there.
    const std::vector<std::pair<std::size_t, double>>& dabs() const { return dabs_; }

 private:
    struct Drop {
        std::size_t junction;
        double share;
        std::size_t half;  // edge that leaves the junction
        bool is_stem;      // enough for the end of a stem, where others go on
        bool operator<(const Drop& o) const {
            return std::tie(junction, share, half) < std::tie(o.junction, o.share, o.half);
        }
        bool operator==(const Drop& o) const { return half == o.half; }
    };

    std::vector<Drop> judged(const std::vector<std::size_t>& ends, double least_share, double least_limb) const;
    bool is_blunt(std::size_t half) const;
    bool is_limb(std::size_t half, double least_share, double least_limb) const;
    /// Where a line would end, its way out to the one corner that stands out stays.
    void keep_ends(std::vector<Drop>& drops);
    void drop_late_corner(std::size_t end, double least_share, double least_limb);
    void take_out(const Drop& each);
    /// The two branches that leave p become one.
    void join(std::size_t p);

    VoronoiAxis& axis_;
    std::vector<std::size_t> mate_;  // of a half edge that leaves a branch's end: the one that leaves its other end
    std::vector<double> corner_;
    std::vector<double> radius_;  // known of junctions from which something was dropped
    std::vector<bool> closes_;    // where a ring that meets nothing begins
    std::vector<bool> is_end_;    // where a line goes on into a corner
    std::vector<std::pair<std::size_t, double>> dabs_;
};

}  // namespace brushsvg
