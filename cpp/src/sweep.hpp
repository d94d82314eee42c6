#pragma once

#include <cmath>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/marks.hpp"
#include "refuse_unusable.hpp"

namespace brushsvg {

/// What a segment from a to b sweeps on its way to d, c: convex pieces, counter-clockwise. A segment that turns about a
/// point of its own sweeps two triangles.
template <class Piece>
void swept_by_edge(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b, const Eigen::RowVector2d& c,
                   const Eigen::RowVector2d& d, Piece&& piece) {
    using P = Eigen::RowVector2d;
    const auto cross = [](const P& u, const P& v) { return u.x() * v.y() - u.y() * v.x(); };
    const auto emit = [&](const P& p, const P& q, const P& r) {
        const double twice = cross(q - p, r - p);
        if (twice == 0.0) return;
        Ring triangle(3, 2);
        triangle << p, (twice > 0.0 ? q : r), (twice > 0.0 ? r : q);
        piece(triangle);
    };
    // where segments p0 p1 and q0 q1 cross, if they do
    const auto crossing = [&](const P& p0, const P& p1, const P& q0, const P& q1, P& x) {
        const double side = cross(p1 - p0, q1 - q0);
        if (side == 0.0) return false;
        const double t = cross(q0 - p0, q1 - q0) / side, s = cross(q0 - p0, p1 - p0) / side;
        x = p0 + t * (p1 - p0);
        return t > 0.0 && t < 1.0 && s > 0.0 && s < 1.0;
    };
    P x;
    if (crossing(a, b, d, c, x)) {
        // a little into the shapes (to the left of both edges): rounded, it would else leave a gap beside them
        const P inwards(-(b - a).y(), (b - a).x());
        x += 5e-5 * inwards.normalized();
        emit(a, x, d);
        emit(b, c, x);
    } else if (crossing(b, c, a, d, x)) {  // turned over on its way: rare and small, all of its hull
        emit(a, b, c);
        emit(a, c, d);
        emit(a, b, d);
        emit(b, c, d);
    } else if ((cross(b - a, c - b) > 0.0) == (cross(d - c, a - d) > 0.0)) {  // the diagonal a c lies inside
        emit(a, b, c);
        emit(a, c, d);
    } else {
        emit(a, b, d);
        emit(b, c, d);
    }
}

/// The painted area of a pass as simple polygons, counter-clockwise: for every two neighbouring rows what the footprint
/// sweeps between them. `convex(a, b)` is called with the footprint at both rows when every outline is convex (the
/// swept area is their hull), else `polygon(ring)` for the footprint and `piece(ring)`, convex, for each edge's sweep.
template <class Convex, class Polygon, class Piece>
void sweep(const PassMarks& marks, const Brush& brush, Convex&& convex, Polygon&& polygon, Piece&& piece) {
    require_usable(brush);
    require_usable(marks);
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
        if (marks.lean_mm_per_mm.rows() > 0) {
            const Eigen::RowVector2d contact = marks.contact_mm.row(Eigen::Index(i));
            const Eigen::Matrix2d stretch = stretch_of(marks.lean_mm_per_mm.row(Eigen::Index(i)));
            ring = ((ring.rowwise() - contact) * stretch).rowwise() + contact;
        }
        return ring;
    };
    Ring before;
    for (std::size_t i = 0; i < marks.pose.size(); ++i) {
        if (marks.depth_mm[i] < 0.0) {  // lifted
            before.resize(0, 2);
            continue;
        }
        checkpoint(5);
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
                    swept_by_edge(before.row(k), before.row(j), now.row(j), now.row(k), piece);
                }
            }
        }
        before = std::move(now);
    }
}

}  // namespace brushsvg
