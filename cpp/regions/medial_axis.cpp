#include "brushsvg/medial_axis.hpp"

#include <algorithm>

#include "base/run_cancellable.hpp"
#include "regions/outline.hpp"
#include "regions/skeleton_pruning.hpp"
#include "regions/voronoi_axis.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

Ring ring_of(const std::vector<Vector2d>& points) {
    Ring ring(Index(points.size()), 2);
    for (Index i = 0; i < ring.rows(); ++i) ring.row(i) = points[i].transpose() / kUnitsPerMm;
    return ring;
}

/// Return the part of the shape nearest to the branch with the given first and last half edges. It follows the outline
/// along the branch's right side forward, along its left side back, and round its free ends.
Rings nearest_part(const VoronoiAxis& axis, const Outline& outline, std::size_t first, std::size_t last) {
    const auto is_free = [&](std::size_t p) { return axis.out[p].size() == 1; };
    const std::size_t a = axis.from[first], b = axis.to(last);
    if (is_free(a) && !is_free(b)) return nearest_part(axis, outline, last ^ 1, first ^ 1);
    const OutlinePlace right = axis.begin(first), left = axis.foot(first);
    // the branch is the whole axis: return whole rings
    if ((is_free(a) && is_free(b)) || (a == b && axis.out[a].size() == 2)) {
        Rings rings{outline.ring(right.edge)};
        if (!outline.same_ring(left, right)) rings.push_back(outline.ring(left.edge));
        if (signed_area(rings[0]) < 0.0) std::reverse(rings.begin(), rings.end());
        return rings;
    }
    // a side that ends where it began has gone round a hole, unless it never left that place
    const auto moves = [&](std::size_t h, std::size_t end) {
        for (const Vector2d start = outline.at(axis.foot(h));; h = axis.next[h]) {
            if ((outline.at(axis.foot(h)) - start).norm() > Outline::kSamePlaceUnits) return true;
            if (h == end) return false;
        }
    };
    std::vector<Vector2d> points{axis.points[a]};
    if (is_free(b)) {
        outline.walk(right, left, false, points);
    } else {
        outline.walk(right, axis.foot(last ^ 1), moves(last ^ 1, first ^ 1), points);
        points.push_back(axis.points[b]);
        outline.walk(axis.begin(last ^ 1), left, moves(first, last), points);
    }
    return {ring_of(points)};
}

MedialAxis collect_axis(const VoronoiAxis& axis, const Outline& outline, const KeptBranches& branches) {
    MedialAxis result;
    std::vector<int> number(axis.points.size(), -1);
    const auto node = [&](std::size_t p, double radius) {
        if (number[p] < 0) {
            number[p] = int(result.nodes.size());
            result.nodes.push_back({axis.points[p].x() / kUnitsPerMm, axis.points[p].y() / kUnitsPerMm,
                                    radius / kUnitsPerMm, branches.corner(p)});
        }
        return number[p];
    };
    std::vector<bool> seen(axis.from.size(), false);
    for (std::size_t p = 0; p < axis.points.size(); ++p) {
        if (!branches.is_node(p)) continue;
        for (std::size_t first : axis.out[p]) {
            if (seen[first]) continue;
            AxisBranch branch;
            branch.from = node(p, axis.radius(first));
            std::vector<AxisPoint> line{axis.at_start(first)};
            std::size_t h = first;
            for (;; h = axis.next[h]) {
                axis.sample(h, line);
                if (branches.is_node(axis.to(h))) break;
            }
            seen[first] = seen[h ^ 1] = true;
            branch.to = node(axis.to(h), axis.radius(h ^ 1));
            branch.line = Eigen::Map<const AxisLine>(line[0].data(), Index(line.size()), 3);
            branch.part = nearest_part(axis, outline, first, h);
            result.branches.push_back(std::move(branch));
        }
    }
    for (const auto& [p, radius] : branches.dabs()) node(p, radius);
    return result;
}

MedialAxis compute_axis(const Rings& rings, double min_share, double min_limb_share) {
    const Outline outline(rings);
    if (outline.edges() == 0) return {};
    VoronoiAxis axis(outline);
    KeptBranches branches(axis);
    branches.drop(min_share, min_limb_share);
    return collect_axis(axis, outline, branches);
}

// The diagram checks for cancellation while it is made, but not while its builder sorts, which takes seconds for a
// million edges.
constexpr Index kMinCornersForThread = 20000;

}  // namespace

MedialAxis medial_axis(const Rings& rings, double min_share) { return medial_axis(rings, min_share, min_share); }

MedialAxis medial_axis(const Rings& rings, double min_share, double min_limb_share) {
    Index corners = 0;
    for (const Ring& ring : rings) corners += ring.rows();
    if (corners < kMinCornersForThread) return compute_axis(rings, min_share, min_limb_share);
    return run_cancellable(
        [rings, min_share, min_limb_share] { return compute_axis(rings, min_share, min_limb_share); });
}

}  // namespace brushsvg
