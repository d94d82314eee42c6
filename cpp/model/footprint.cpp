#include "brushsvg/footprint.hpp"

#include <algorithm>
#include <cmath>

#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

/// Adds weight * outline(depth) to `sum`, blended between the neighbouring depths.
void add_blend(const std::vector<Footprint>& shapes, double depth, double weight, Ring& sum) {
    const auto needed = [&](const Footprint& shape) -> const Ring& {
        if (shape.outline_mm.rows() != sum.rows())
            throw Error("footprint-invalid", "all outlines of a footprint must have the same number of vertices");
        return shape.outline_mm;
    };
    const auto above = std::lower_bound(shapes.begin(), shapes.end(), depth,
                                        [](const Footprint& shape, double d) { return shape.depth_mm < d; });
    if (above == shapes.end()) {
        sum += weight * needed(shapes.back());
    } else if (above == shapes.begin()) {
        sum += (weight * depth / above->depth_mm) * needed(*above);
    } else {
        const Footprint& below = *(above - 1);
        const double c = (depth - below.depth_mm) / (above->depth_mm - below.depth_mm);
        sum += weight * (1.0 - c) * needed(below) + weight * c * needed(*above);
    }
}

double cross(const Ring& p, Eigen::Index a, Eigen::Index b, Eigen::Index c) {
    return (p(b, 0) - p(a, 0)) * (p(c, 1) - p(b, 1)) - (p(b, 1) - p(a, 1)) * (p(c, 0) - p(b, 0));
}

}  // namespace

Ring footprint_at(const FootprintTable& table, double depth_mm, double pull) {
    if (table.dragged.empty()) throw Error("footprint-invalid", "the footprint has no outline", "footprints.dragged");
    Ring outline = Ring::Zero(table.vertex_count(), 2);
    const bool pressed = !table.pressed.empty() && pull < 1.0;
    add_blend(table.dragged, depth_mm, pressed ? pull : 1.0, outline);
    if (pressed) add_blend(table.pressed, depth_mm, 1.0 - pull, outline);
    return outline;
}

WidestSection widest_section(const Ring& outline_mm) {
    // The width at x is top - bottom. It is piecewise linear between the x of vertices, so that it is greatest at a
    // vertex.
    WidestSection best{0.0, 0.0};
    const Eigen::Index n = outline_mm.rows();
    for (Eigen::Index i = 0; i < n; ++i) {
        const double x = outline_mm(i, 0);
        double top = outline_mm(i, 1), bottom = top;
        for (Eigen::Index j = 0; j < n; ++j) {
            const Eigen::Index k = (j + 1) % n;
            const double x0 = outline_mm(j, 0), x1 = outline_mm(k, 0);
            if (std::min(x0, x1) > x || std::max(x0, x1) < x || x0 == x1) continue;
            const double y = outline_mm(j, 1) + (outline_mm(k, 1) - outline_mm(j, 1)) * (x - x0) / (x1 - x0);
            top = std::max(top, y);
            bottom = std::min(bottom, y);
        }
        if (0.5 * (top - bottom) > best.half_width_mm) best = {x, 0.5 * (top - bottom)};
    }
    return best;
}

bool is_convex(const Ring& outline_mm) {
    const Eigen::Index n = outline_mm.rows();
    if (n < 3) return true;
    const double size = outline_mm.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < n; ++i)
        if (cross(outline_mm, i, (i + 1) % n, (i + 2) % n) < -1e-4 * size * size) return false;
    return true;
}

}  // namespace brushsvg
