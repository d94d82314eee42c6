#pragma once

#include <cmath>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/marks.hpp"

namespace brushsvg {

/// The painted area of a pass as simple polygons, counter-clockwise: for every two neighbouring rows what the footprint
/// sweeps between them. `convex(a, b)` is called with the footprint at both rows when every outline is convex (the
/// swept area is their hull), else `polygon(ring)` and `quad(ring)` for the footprint and each edge's sweep.
template <class Convex, class Polygon, class Quad>
void sweep(const PassMarks& marks, const Brush& brush, Convex&& convex, Polygon&& polygon, Quad&& quad) {
    bool all_convex = true;
    for (const auto* shapes : {&brush.footprints.dragged, &brush.footprints.pressed})
        for (const Footprint& shape : *shapes) all_convex = all_convex && is_convex(shape.outline_mm);

    const auto placed = [&](std::size_t i) {
        const double d = marks.depth_mm[i], c = std::cos(marks.heading_rad[i]), s = std::sin(marks.heading_rad[i]);
        Ring ring = footprint_at(brush.footprints, d, marks.pull[i]);
        const double b = brush.tip_gap(d), x0 = marks.contact_mm(i, 0) - b * c, y0 = marks.contact_mm(i, 1) - b * s;
        for (Eigen::Index k = 0; k < ring.rows(); ++k) {
            const double x = ring(k, 0), y = ring(k, 1);
            ring(k, 0) = x0 + c * x - s * y;
            ring(k, 1) = y0 + s * x + c * y;
        }
        return ring;
    };
    Ring before;
    for (std::size_t i = 0; i < marks.pose.size(); ++i) {
        if (marks.depth_mm[i] < 0.0) {  // lifted
            before.resize(0, 2);
            continue;
        }
        Ring now = placed(i);
        if (before.rows() == 0) {
            if (all_convex)
                convex(now, now);
            else
                polygon(now);
        } else {
            // where the heading flips over at once (the TCP passing over the patch) nothing is swept in between
            const bool flipped = std::cos(marks.heading_rad[i] - marks.heading_rad[i - 1]) < 0.8;
            if (all_convex && !flipped) {
                convex(before, now);
            } else if (all_convex) {
                convex(now, now);
            } else {
                polygon(now);
                for (Eigen::Index k = 0, n = now.rows(); !flipped && k < n; ++k) {
                    const Eigen::Index j = (k + 1) % n;
                    Ring corners(4, 2);
                    corners << before.row(k), before.row(j), now.row(j), now.row(k);
                    quad(corners);
                }
            }
        }
        before = std::move(now);
    }
}

}  // namespace brushsvg
