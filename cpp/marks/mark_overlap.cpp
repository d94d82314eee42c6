#include "brushsvg/mark_overlap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "base/parallel.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/target_mark.hpp"

namespace brushsvg {
namespace {

constexpr double kMinPxPerMm = 8.0, kMaxPxPerMm = 40.0;
constexpr double kPxPerHalfWidth = 6.0;   // on the thinnest half width, if there can be that many
constexpr double kMaxPx = 4e6;            // of one picture, to limit the memory
constexpr double kMaxSheetPxPerMm = 5.0;  // of tiles: overlaps are still exact to 1e-3
constexpr double kMaxSheetPx = 6e7;       // of all tiles together, to limit the time
constexpr double kTileSidePx = 1000.0;
constexpr double kOutlineToleranceMm = 0.01;
constexpr double kMarginMm = 0.3;  // margin around the box, so that paint on its edge is complete
// Sum of two strokes' shares in one pixel above which they count as touching. The parts of a letter's outline meet at
// their borders.
constexpr float kMinTouchingSum = 0.8f;

constexpr double kInf = std::numeric_limits<double>::infinity();

struct Box {
    double left = kInf, bottom = kInf, right = -kInf, top = -kInf;

    void include(const Box& other) {
        left = std::min(left, other.left);
        bottom = std::min(bottom, other.bottom);
        right = std::max(right, other.right);
        top = std::max(top, other.top);
    }
    bool meets(const Box& other) const {
        return left <= other.right && right >= other.left && bottom <= other.top && top >= other.bottom;
    }
};
Box box_of(const Ring& points) {
    if (points.rows() == 0) return {};
    return {points.col(0).minCoeff(), points.col(1).minCoeff(), points.col(0).maxCoeff(), points.col(1).maxCoeff()};
}
Box box_of(const PassMarks& pass, const Brush& brush) {
    const auto bounds = painted_bounds(pass, brush);
    return {bounds[0], bounds[1], bounds[2], bounds[3]};
}
Window window_around(const Box& box) {
    const Window none{-kMarginMm, -kMarginMm, 2.0 * kMarginMm, 2.0 * kMarginMm};
    if (!(box.left <= box.right)) return none;
    return {box.left - kMarginMm, box.bottom - kMarginMm, box.right - box.left + 2.0 * kMarginMm,
            box.top - box.bottom + 2.0 * kMarginMm};
}

/// Return the half width of a stroke where it is thinnest. The thin places of an outline have no length, so its mean
/// half width is returned: area over perimeter.
double thinnest_half_width_mm(const Stroke& stroke) {
    double finest = kInf;
    if (stroke.target_mm.empty()) {
        for (const WidthKnot& knot : stroke.half_width)
            if (knot.half_width_mm > 0.0) finest = std::min(finest, knot.half_width_mm);
        return finest;
    }
    double inside = 0.0, around = 0.0;
    for (const Ring& ring : stroke.target_mm) {
        inside += signed_area(ring);
        for (Eigen::Index i = 0, n = ring.rows(); i < n; ++i) around += (ring.row((i + 1) % n) - ring.row(i)).norm();
    }
    return inside > 0.0 ? inside / around : finest;
}

/// A stroke as it was drawn: its outline if it has one, else convex pieces of its path with its width.
struct TargetMark {
    bool is_outline = false;
    Rings parts;
    std::vector<Box> boxes;
    Box box;

    TargetMark() = default;
    /// `window`: if given, only the pieces that show in this part of the paper are made.
    explicit TargetMark(const Stroke& stroke, const Window* window = nullptr) : is_outline(!stroke.target_mm.empty()) {
        parts = is_outline ? stroke.target_mm
                : window   ? target_pieces_near(stroke, *window, kOutlineToleranceMm)
                           : target_pieces(stroke, kOutlineToleranceMm);
        for (const Ring& part : parts) {
            boxes.push_back(box_of(part));
            box.include(boxes.back());
        }
        if (parts.empty())
            for (int k : {0, 6}) box.include(box_of(Ring(stroke.middle_mm.middleCols(k, 2))));
    }
};

std::vector<TargetMark> make_target_marks(const std::vector<Stroke>& target, const Window* window = nullptr) {
    std::vector<TargetMark> all(target.size());
    parallel_for(0, all.size(), [&](std::size_t k) { all[k] = TargetMark(target[k], window); });
    return all;
}

Coverage target_pixels(const std::vector<const TargetMark*>& target, const Window& window, double px_per_mm) {
    const Box shown{window.x_mm, window.y_mm, window.x_mm + window.width_mm, window.y_mm + window.height_mm};
    Rings outlines, pieces;
    for (const TargetMark* each : target)
        for (std::size_t k = 0; k < each->parts.size(); ++k)
            if (shown.meets(each->boxes[k])) (each->is_outline ? outlines : pieces).push_back(each->parts[k]);
    if (outlines.empty()) return coverage_of_pieces(pieces, window, px_per_mm);
    const Coverage filled = coverage(outlines, window, px_per_mm);
    return pieces.empty() ? filled : filled.cwiseMax(coverage_of_pieces(pieces, window, px_per_mm)).eval();
}
std::vector<const TargetMark*> pointers_to(const std::vector<TargetMark>& target) {
    std::vector<const TargetMark*> all;
    for (const TargetMark& each : target) all.push_back(&each);
    return all;
}

Coverage painted_pixels(std::vector<PassMarks> passes, const Brush& brush, const Window& window, double px_per_mm) {
    Marks marks;
    marks.passes = std::move(passes);
    return coverage(marks, brush, window, px_per_mm);
}

bool are_touching(const TargetMark& a, const TargetMark& b) {
    const Window shared = window_around({std::max(a.box.left, b.box.left), std::max(a.box.bottom, b.box.bottom),
                                         std::min(a.box.right, b.box.right), std::min(a.box.top, b.box.top)});
    const double px_per_mm = std::min(kMinPxPerMm, std::sqrt(kMaxPx / (shared.width_mm * shared.height_mm)));
    const Coverage one = target_pixels({&a}, shared, px_per_mm), other = target_pixels({&b}, shared, px_per_mm);
    return (one.array() > 0.0f && other.array() > 0.0f && one.array() + other.array() > kMinTouchingSum).any();
}

}  // namespace

MarkOverlap mark_overlap(const std::vector<PassMarks>& painted, const std::vector<Stroke>& target, const Brush& brush) {
    const std::vector<TargetMark> drawn = make_target_marks(target);
    Box box;
    double finest = kInf;
    for (const Stroke& stroke : target) finest = std::min(finest, thinnest_half_width_mm(stroke));
    for (const TargetMark& each : drawn) box.include(each.box);
    for (const PassMarks& pass : painted) box.include(box_of(pass, brush));

    MarkOverlap seen;
    seen.window = window_around(box);
    seen.px_per_mm = std::min(std::clamp(kPxPerHalfWidth / finest, kMinPxPerMm, kMaxPxPerMm),
                              std::sqrt(kMaxPx / (seen.window.width_mm * seen.window.height_mm)));
    seen.painted = painted_pixels(painted, brush, seen.window, seen.px_per_mm);
    seen.target = target_pixels(pointers_to(drawn), seen.window, seen.px_per_mm);
    return seen;
}

CommonArea common_area(const MarkOverlap& seen) {
    if (seen.target.rows() != seen.painted.rows() || seen.target.cols() != seen.painted.cols())
        throw Error("sizes-differ", "the pictures of paint and drawing differ in size");
    const double mm2 = 1.0 / (seen.px_per_mm * seen.px_per_mm);
    double common = 0.0, together = 0.0;
    // a row's sum is exact enough in single precision
    for (Eigen::Index row = 0; row < seen.target.rows(); ++row) {
        common += seen.target.row(row).cwiseMin(seen.painted.row(row)).sum();
        together += seen.target.row(row).cwiseMax(seen.painted.row(row)).sum();
    }
    return {mm2 * common, mm2 * together};
}

CommonArea common_area(const std::vector<PassMarks>& painted, const std::vector<Stroke>& target, const Brush& brush) {
    std::vector<Box> paint(painted.size());
    parallel_for(0, paint.size(), [&](std::size_t k) { paint[k] = box_of(painted[k], brush); });
    Box box;
    for (const Box& each : paint) box.include(each);
    const std::vector<TargetMark> drawn = make_target_marks(target);
    for (const TargetMark& each : drawn) box.include(each.box);
    const Window sheet = window_around(box);
    const double mm2 = sheet.width_mm * sheet.height_mm;
    if (mm2 * kMinPxPerMm * kMinPxPerMm <= kMaxPx) return common_area(mark_overlap(painted, target, brush));

    const double px_per_mm = std::min(kMaxSheetPxPerMm, std::sqrt(kMaxSheetPx / mm2)), side = kTileSidePx / px_per_mm;
    const auto across = std::size_t(std::ceil(sheet.width_mm / side)),
               up = std::size_t(std::ceil(sheet.height_mm / side));
    std::vector<CommonArea> tiles(across * up);
    parallel_for(0, tiles.size(), [&](std::size_t k) {
        const Window tile{sheet.x_mm + double(k % across) * side, sheet.y_mm + double(k / across) * side, side, side};
        const Box shown{tile.x_mm, tile.y_mm, tile.x_mm + side, tile.y_mm + side};
        std::vector<PassMarks> here;
        std::vector<const TargetMark*> there;
        for (std::size_t i = 0; i < paint.size(); ++i)
            if (shown.meets(paint[i])) here.push_back(painted[i]);
        for (const TargetMark& each : drawn)
            if (shown.meets(each.box)) there.push_back(&each);
        tiles[k] = here.empty() && there.empty()
                       ? CommonArea{0.0, 0.0}
                       : common_area(MarkOverlap{tile, px_per_mm, target_pixels(there, tile, px_per_mm),
                                                 painted_pixels(here, brush, tile, px_per_mm)});
    });
    CommonArea all{0.0, 0.0};
    for (const CommonArea& tile : tiles) {
        all.intersection_mm2 += tile.intersection_mm2;
        all.union_mm2 += tile.union_mm2;
    }
    return all;
}

std::vector<CommonArea> common_areas(const std::vector<PassMarks>& painted, const std::vector<Stroke>& target,
                                     const std::vector<std::vector<std::size_t>>& groups, const Brush& brush) {
    for (const auto& members : groups)
        for (const std::size_t k : members)
            if (k >= painted.size() || k >= target.size())
                throw Error("out-of-range",
                            "a group contains stroke " + std::to_string(k) + ", but there are only " +
                                std::to_string(std::min(painted.size(), target.size())) + " strokes, counted from 0",
                            "", double(k));
    std::vector<CommonArea> found(groups.size());
    parallel_for(0, found.size(), [&](std::size_t g) {
        std::vector<PassMarks> marks;
        std::vector<Stroke> strokes;
        for (const std::size_t k : groups[g]) {
            marks.push_back(painted[k]);
            strokes.push_back(target[k]);
        }
        found[g] = common_area(marks, strokes, brush);
    });
    return found;
}

Coverage target_coverage(const std::vector<Stroke>& target, const Window& window, double px_per_mm) {
    return target_pixels(pointers_to(make_target_marks(target, &window)), window, px_per_mm);
}

std::vector<std::vector<std::size_t>> group_touching(const std::vector<Stroke>& target) {
    const std::vector<TargetMark> drawn = make_target_marks(target);
    std::vector<std::size_t> group(drawn.size()), order(drawn.size());
    std::iota(group.begin(), group.end(), std::size_t(0));
    order = group;
    const auto root = [&](std::size_t k) {
        while (group[k] != k) k = group[k] = group[group[k]];
        return k;
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return drawn[a].box.left < drawn[b].box.left; });
    for (std::size_t at = 0; at < order.size(); ++at)
        for (std::size_t next = at + 1; next < order.size(); ++next) {
            checkpoint(10);
            const TargetMark &one = drawn[order[at]], &other = drawn[order[next]];
            if (other.box.left > one.box.right) break;
            const std::size_t a = root(order[at]), b = root(order[next]);
            if (a != b && one.box.meets(other.box) && are_touching(one, other)) group[b] = a;
        }
    std::map<std::size_t, std::vector<std::size_t>> by_root;
    std::vector<std::size_t> roots;  // roots in the order of their first strokes
    for (std::size_t k = 0; k < drawn.size(); ++k) {
        auto& members = by_root[root(k)];
        if (members.empty()) roots.push_back(root(k));
        members.push_back(k);
    }
    std::vector<std::vector<std::size_t>> found;
    for (const std::size_t k : roots)
        if (by_root[k].size() > 1) found.push_back(by_root[k]);
    return found;
}

}  // namespace brushsvg
