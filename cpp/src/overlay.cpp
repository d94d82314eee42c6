#include "brushsvg/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brushsvg/wanted.hpp"

namespace brushsvg {
namespace {

constexpr double kLeastPxPerMm = 8.0, kMostPxPerMm = 40.0;
constexpr double kAcrossPx = 6.0;  // of the thinnest half width, where that many can be had
constexpr double kMostPx = 4e6;    // bounds the memory
constexpr double kOutlineMm = 0.01;
constexpr double kBesideMm = 0.3;  // round the box: what lies on its edge is seen whole

struct Box {
    double left = std::numeric_limits<double>::infinity(), bottom = left, right = -left, top = -left;

    void include(double to_left, double to_bottom, double to_right, double to_top) {
        left = std::min(left, to_left);
        bottom = std::min(bottom, to_bottom);
        right = std::max(right, to_right);
        top = std::max(top, to_top);
    }
    void include(const Ring& points) {
        if (points.rows() == 0) return;
        include(points.col(0).minCoeff(), points.col(1).minCoeff(), points.col(0).maxCoeff(), points.col(1).maxCoeff());
    }
};

/// Half width of a stroke where it is thinnest; of an outline, whose thin places have no length, in the mean: area over
/// half of the way round it.
double finest_mm(const Stroke& stroke) {
    if (stroke.wanted_mm.empty()) {
        double finest = std::numeric_limits<double>::infinity();
        for (const WidthKnot& knot : stroke.half_width)
            if (knot.half_width_mm > 0.0) finest = std::min(finest, knot.half_width_mm);
        return finest;
    }
    double inside = 0.0, around = 0.0;
    for (const Ring& ring : stroke.wanted_mm) {
        inside += signed_area(ring);
        for (Eigen::Index i = 0, n = ring.rows(); i < n; ++i) around += (ring.row((i + 1) % n) - ring.row(i)).norm();
    }
    return inside > 0.0 ? inside / around : std::numeric_limits<double>::infinity();
}

}  // namespace

Overlay overlay(const std::vector<PassMarks>& painted, const std::vector<Stroke>& wanted, const Brush& brush) {
    Rings outlines, pieces;
    Box box;
    double finest = std::numeric_limits<double>::infinity();
    for (const Stroke& stroke : wanted) {
        finest = std::min(finest, finest_mm(stroke));
        const bool is_outline = !stroke.wanted_mm.empty();
        const Rings parts = is_outline ? stroke.wanted_mm : wanted_pieces(stroke, kOutlineMm);
        for (const Ring& ring : parts) box.include(ring);
        if (parts.empty())
            for (int k : {0, 6}) box.include(Ring(stroke.middle_mm.middleCols(k, 2)));
        Rings& all = is_outline ? outlines : pieces;
        all.insert(all.end(), parts.begin(), parts.end());
    }
    Marks marks;
    marks.passes = painted;
    for (const PassMarks& pass : painted) {
        const auto bounds = painted_bounds(pass, brush);
        box.include(bounds[0], bounds[1], bounds[2], bounds[3]);
    }
    if (!(box.left <= box.right)) box.include(0.0, 0.0, 0.0, 0.0);

    Overlay seen;
    const double width = box.right - box.left + 2.0 * kBesideMm, height = box.top - box.bottom + 2.0 * kBesideMm;
    seen.window = {box.left - kBesideMm, box.bottom - kBesideMm, width, height};
    seen.px_per_mm =
        std::min(std::clamp(kAcrossPx / finest, kLeastPxPerMm, kMostPxPerMm), std::sqrt(kMostPx / (width * height)));
    seen.painted = coverage(marks, brush, seen.window, seen.px_per_mm);
    seen.wanted = coverage_of_pieces(pieces, seen.window, seen.px_per_mm);
    if (!outlines.empty()) seen.wanted = seen.wanted.cwiseMax(coverage(outlines, seen.window, seen.px_per_mm));
    return seen;
}

CommonArea common_area(const Overlay& seen) {
    const double mm2 = 1.0 / (seen.px_per_mm * seen.px_per_mm);
    double common = 0.0, together = 0.0;
    for (Eigen::Index row = 0; row < seen.wanted.rows(); ++row) {  // a row's sum is exact enough in single precision
        common += seen.wanted.row(row).cwiseMin(seen.painted.row(row)).sum();
        together += seen.wanted.row(row).cwiseMax(seen.painted.row(row)).sum();
    }
    return {mm2 * common, mm2 * together};
}

}  // namespace brushsvg
