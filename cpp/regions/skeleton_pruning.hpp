#pragma once

#include <tuple>
#include <utility>
#include <vector>

#include "regions/voronoi_axis.hpp"

namespace brushsvg {

/// The branches of an axis that are kept, and the parts of the axis between nodes.
class KeptBranches {
 public:
    explicit KeptBranches(VoronoiAxis& axis);
    /// Drop branches with a free end that add less than min_share to the disc that they leave, unless they are limbs.
    /// Areas are in squares of the disc's radius. A limb adds min_limb_share to the disc that it leaves. Beyond some
    /// place it also adds min_share to the disc there.
    void drop(double min_share, double min_limb_share);

    bool is_node(std::size_t p) const;
    double corner(std::size_t p) const { return corner_[p]; }
    /// Return the points at which everything was dropped, and the radius there.
    const std::vector<std::pair<std::size_t, double>>& dabs() const { return dabs_; }

 private:
    struct DroppedBranch {
        std::size_t junction;
        double share;
        std::size_t half;  // half edge that leaves the junction
        bool is_stem;      // adds enough for the end of a stem, where other branches continue
        bool operator<(const DroppedBranch& o) const {
            return std::tie(junction, share, half) < std::tie(o.junction, o.share, o.half);
        }
        bool operator==(const DroppedBranch& o) const { return half == o.half; }
    };

    std::vector<DroppedBranch> find_droppable(const std::vector<std::size_t>& ends, double min_share,
                                              double min_limb_share) const;
    bool is_blunt(std::size_t half) const;
    bool is_limb(std::size_t half, double min_share, double min_limb_share) const;
    /// Keep the way to the one corner that stands out where a line would end.
    void keep_ends(std::vector<DroppedBranch>& drops);
    void drop_late_corner(std::size_t end, double min_share, double min_limb_share);
    void remove_branch(const DroppedBranch& each);
    /// Join the two branches that leave p.
    void join(std::size_t p);

    VoronoiAxis& axis_;
    // for a half edge that leaves a branch's end: the half edge that leaves its other end
    std::vector<std::size_t> opposite_end_;
    std::vector<double> corner_;
    std::vector<double> radius_;       // known at junctions from which something was dropped
    std::vector<bool> is_ring_start_;  // where a ring that meets nothing begins
    std::vector<bool> is_end_;         // where a line continues into a corner
    std::vector<std::pair<std::size_t, double>> dabs_;
};

}  // namespace brushsvg
