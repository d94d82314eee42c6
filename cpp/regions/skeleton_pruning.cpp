#include "regions/skeleton_pruning.hpp"

#include <algorithm>
#include <iterator>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg {
namespace {

// Least area over r^2 that an outer corner adds to a disc in it: tan(a/2) - a/2 for a turn by a, here 45 degrees.
constexpr double kMinCornerArea = 0.02;
// A line ends in a corner that adds kMinEndArea to the disc at the line's end, if no other corner adds nearly as much.
// Such a corner turns by 68 degrees or more. Lines to blunter corners end in hooks, which are more visible than the
// area that is left blank.
constexpr double kMinEndArea = 0.5, kMinEndRatio = 1.4;
// Area that the end of a stem must add if other branches leave the stem there, as a share of min_share. The stem's
// two corners add 0.43 together if they are right-angled: too much to be left blank. A line to where the corners part
// leaves little of them blank.
constexpr double kMinStemShare = 0.5;

bool stands_out(double share, double other) { return share > kMinEndArea && share > kMinEndRatio * other; }

template <typename T>
void sort_unique(std::vector<T>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

KeptBranches::KeptBranches(VoronoiAxis& axis)
    : axis_(axis),
      opposite_end_(axis.from.size()),
      corner_(axis.points.size(), 0.0),
      radius_(corner_),
      is_ring_start_(axis.points.size(), false),
      is_end_(is_ring_start_) {
    for (std::size_t h = 0; h < opposite_end_.size(); ++h) opposite_end_[h] = h ^ 1;
    for (std::size_t p = 0; p < axis_.points.size(); ++p)
        if (axis_.out[p].size() == 2) join(p);
}

bool KeptBranches::is_node(std::size_t p) const {
    const std::size_t n = axis_.out[p].size();
    return n > 2 || n == 1 || is_ring_start_[p] || (n == 2 && corner_[p] >= kMinCornerArea && !is_end_[p]);
}

void KeptBranches::drop(double min_share, double min_limb_share) {
    std::vector<std::size_t> pending(axis_.points.size());
    for (std::size_t p = 0; p < pending.size(); ++p) pending[p] = p;
    while (!pending.empty()) {
        checkpoint(int(pending.size()));
        // judge all branches before any is dropped
        std::vector<DroppedBranch> drops = find_droppable(pending, min_share, min_limb_share);
        keep_ends(drops);
        std::vector<std::size_t> junctions;
        for (const DroppedBranch& each : drops) {
            remove_branch(each);
            junctions.push_back(each.junction);
        }
        sort_unique(junctions);
        pending.clear();
        for (std::size_t p : junctions) {
            pending.push_back(p);
            if (axis_.out[p].empty()) dabs_.emplace_back(p, radius_[p]);
            if (axis_.out[p].size() != 2) continue;
            join(p);
            for (std::size_t h : axis_.out[p]) pending.push_back(axis_.from[opposite_end_[h]]);
        }
    }
    for (std::size_t p = 0; p < axis_.points.size(); ++p)
        if (axis_.out[p].size() == 1) drop_late_corner(p, min_share, min_limb_share);
}

/// Drop a corner near a line's end that could not be dropped before. A corner with bent sides has branches of its own,
/// which are dropped first. Meanwhile the other corner of the cut may have been dropped. Then the way to this corner
/// counts as part of the line.
void KeptBranches::drop_late_corner(std::size_t end, double min_share, double min_limb_share) {
    for (std::size_t h = axis_.out[end][0]; h != VoronoiAxis::none; h = axis_.next[h]) {
        const std::size_t p = axis_.to(h), back = h ^ 1;
        if (axis_.out[p].size() != 2 || is_ring_start_[p]) return;
        if (corner_[p] < kMinCornerArea || is_end_[p]) continue;
        const double share = axis_.share(back);
        if (share >= min_share || is_limb(back, min_share, min_limb_share) || stands_out(share, corner_[p])) return;
        remove_branch({p, share, back, false});
        return drop_late_corner(p, min_share, min_limb_share);
    }
}

std::vector<KeptBranches::DroppedBranch> KeptBranches::find_droppable(const std::vector<std::size_t>& ends,
                                                                      double min_share, double min_limb_share) const {
    std::vector<DroppedBranch> drops;
    for (std::size_t p : ends) {
        if (axis_.out[p].size() != 1) continue;
        const std::size_t h = opposite_end_[axis_.out[p][0]], junction = axis_.from[h];
        if (axis_.out[junction].size() < 3) continue;
        const double share = axis_.share(h);
        if (share < min_share && !is_limb(h, min_share, min_limb_share))
            drops.push_back({junction, share, h, share >= kMinStemShare * min_share && is_blunt(h)});
    }
    sort_unique(drops);
    return drops;
}

/// Return whether a corner was dropped at the end of a branch: both corners of a square end, or the one that stands out
/// less.
bool KeptBranches::is_blunt(std::size_t half) const {
    for (std::size_t h = half; h != VoronoiAxis::none; h = axis_.next[h]) {
        const std::size_t p = axis_.to(h);
        if (is_end_[p] || (axis_.next[h] == VoronoiAxis::none && corner_[p] >= kMinCornerArea)) return true;
    }
    return false;
}

/// Return whether a branch is a limb. A corner looks the same from all places on its branch. A bar on a thick stem adds
/// little to the stem's disc, but much to a disc of its own width.
bool KeptBranches::is_limb(std::size_t half, double min_share, double min_limb_share) const {
    if (axis_.share(half) < min_limb_share) return false;
    const double least_area = min_limb_share * axis_.radius(half) * axis_.radius(half);
    for (std::size_t h = axis_.next[half]; h != VoronoiAxis::none; h = axis_.next[h]) {
        const double share = axis_.share(h), area = share * axis_.radius(h) * axis_.radius(h);
        if (area < least_area) return false;  // the area only decreases along the branch
        if (share >= min_share) return true;
    }
    return false;
}

void KeptBranches::keep_ends(std::vector<DroppedBranch>& drops) {
    std::vector<DroppedBranch> kept;
    for (std::size_t i = 0; i < drops.size();) {
        std::size_t j = i;
        while (j < drops.size() && drops[j].junction == drops[i].junction) ++j;
        const std::size_t p = drops[i].junction;
        if (axis_.out[p].size() > j - i + 1) {
            std::copy_if(drops.begin() + std::ptrdiff_t(i), drops.begin() + std::ptrdiff_t(j), std::back_inserter(kept),
                         [](const DroppedBranch& each) { return !each.is_stem; });
            i = j;
            continue;
        }
        const double most = drops[j - 1].share, next = j - i > 1 ? drops[j - 2].share : 0.0;
        const bool is_end = axis_.out[p].size() == j - i + 1 && stands_out(most, next);
        if (is_end) is_end_[p] = true;
        kept.insert(kept.end(), drops.begin() + std::ptrdiff_t(i), drops.begin() + std::ptrdiff_t(is_end ? j - 1 : j));
        i = j;
    }
    drops = std::move(kept);
}

void KeptBranches::remove_branch(const DroppedBranch& each) {
    corner_[each.junction] = std::max(corner_[each.junction], each.share);
    radius_[each.junction] = axis_.radius(each.half);
    auto& leaving = axis_.out[each.junction];
    leaving.erase(std::find(leaving.begin(), leaving.end(), each.half));
    for (std::size_t k = each.half; k != VoronoiAxis::none; k = axis_.next[k]) axis_.out[axis_.to(k)].clear();
}

void KeptBranches::join(std::size_t p) {
    const std::size_t a = axis_.out[p][0], b = axis_.out[p][1], far_a = opposite_end_[a], far_b = opposite_end_[b];
    if (far_a == b) {
        is_ring_start_[p] = true;
        return;
    }
    axis_.next[a ^ 1] = b;
    axis_.next[b ^ 1] = a;
    opposite_end_[far_a] = far_b;
    opposite_end_[far_b] = far_a;
}

}  // namespace brushsvg
