#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/marks.hpp"
#include "values/require_usable.hpp"

namespace brushsvg {

/// Find the area that a segment from a to b sweeps on its way to d, c, as convex counter-clockwise pieces. A segment
/// that turns about one of its own points sweeps two triangles.
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
    // find where segments p0 p1 and q0 q1 cross, and return whether they do
    const auto crossing = [&](const P& p0, const P& p1, const P& q0, const P& q1, P& x) {
        const double side = cross(p1 - p0, q1 - q0);
        if (side == 0.0) return false;
        const double t = cross(q0 - p0, q1 - q0) / side, s = cross(q0 - p0, p1 - p0) / side;
        x = p0 + t * (p1 - p0);
        return t > 0.0 && t < 1.0 && s > 0.0 && s < 1.0;
    };
    P x;
    if (crossing(a, b, d, c, x)) {
        // move it a little into the shapes (to the left of both edges): otherwise rounding would leave a gap next to
        // them
        const P inwards(-(b - a).y(), (b - a).x());
        x += 5e-5 * inwards.normalized();
        emit(a, x, d);
        emit(b, c, x);
    } else if (crossing(b, c, a, d, x)) {  // turned over on its way: rare and small, so take the whole hull
        emit(a, b, c);
        emit(a, c, d);
        emit(a, b, d);
        emit(b, c, d);
    } else if ((cross(b - a, c - b) > 0.0) == (cross(d - c, a - d) > 0.0)) {  // the diagonal a c is inside
        emit(a, b, c);
        emit(a, c, d);
    } else {
        emit(a, b, d);
        emit(b, c, d);
    }
}

/// Default argument of sweep(): leave nothing out.
struct NothingOutside {};

/// A box about an outline whose tip is at (0, 0) and whose axis is +x.
struct OutlineBox {
    double back = 0.0, front = 0.0, side = 0.0;

    OutlineBox towards(const OutlineBox& other, double share) const {
        return {back + share * (other.back - back), front + share * (other.front - front),
                side + share * (other.side - side)};
    }
};

/// The outline boxes of a whole table, blended as footprint_at() blends the outlines.
class OutlineBoxes {
 public:
    explicit OutlineBoxes(const FootprintTable& table) : dragged_(all(table.dragged)), pressed_(all(table.pressed)) {}

    OutlineBox at(double depth_mm, double pull) const {
        const OutlineBox dragged = blended(dragged_, depth_mm);
        return pressed_.size() < 2 || !(pull < 1.0) ? dragged : blended(pressed_, depth_mm).towards(dragged, pull);
    }

 private:
    using Boxes = std::vector<std::pair<double, OutlineBox>>;  // from depth 0 on, where the box is empty

    static Boxes all(const std::vector<Footprint>& shapes) {
        Boxes boxes{{0.0, {}}};
        for (const Footprint& shape : shapes)
            boxes.push_back({shape.depth_mm,
                             {shape.outline_mm.col(0).minCoeff(), shape.outline_mm.col(0).maxCoeff(),
                              shape.outline_mm.col(1).cwiseAbs().maxCoeff()}});
        return boxes;
    }
    static OutlineBox blended(const Boxes& boxes, double depth_mm) {
        std::size_t k = 1;
        while (k < boxes.size() && boxes[k].first < depth_mm) ++k;
        if (k == boxes.size()) return boxes.back().second;
        const auto& [above, box] = boxes[k];
        const auto& [below, before] = boxes[k - 1];
        return before.towards(box, (depth_mm - below) / (above - below));
    }
    Boxes dragged_, pressed_;
};

/// Find the painted area of a pass as simple counter-clockwise polygons: for every two neighbouring rows the area that
/// the footprint sweeps between them. If every outline is convex, `convex(a, b)` is called with the footprint at both
/// rows: the swept area is their hull. Otherwise `polygon(ring)` is called for the footprint, and `piece(ring)`,
/// convex, for the sweep of each edge. Convex footprints are skipped if `is_outside(low, high)` returns true for their
/// box.
template <class Convex, class Polygon, class Piece, class IsOutside = NothingOutside>
void sweep(const PassMarks& marks, const Brush& brush, Convex&& convex, Polygon&& polygon, Piece&& piece,
           [[maybe_unused]] IsOutside&& is_outside = {}) {
    require_usable(brush);
    require_usable(marks);
    bool all_convex = true;
    for (const auto* shapes : {&brush.footprints.dragged, &brush.footprints.pressed})
        for (const Footprint& shape : *shapes) all_convex = all_convex && is_convex(shape.outline_mm);

    const auto placed = [&](std::size_t i) {
        const double d = marks.depth_mm[i], c = std::cos(marks.heading_rad[i]), s = std::sin(marks.heading_rad[i]);
        Ring ring = footprint_at(brush.footprints, d, marks.pull[i]);
        const double share = marks.width_share.empty() ? 1.0 : marks.width_share[i];
        const double b = brush.tip_gap(d), x0 = marks.contact_mm(i, 0) - b * c, y0 = marks.contact_mm(i, 1) - b * s;
        for (Eigen::Index k = 0; k < ring.rows(); ++k) {
            const double x = ring(k, 0), y = share * ring(k, 1);
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
    constexpr bool is_everywhere = std::is_same_v<std::decay_t<IsOutside>, NothingOutside>;
    const bool skips_outside = !is_everywhere && all_convex && marks.lean_mm_per_mm.rows() == 0;
    std::optional<OutlineBoxes> boxes;
    if (skips_outside) boxes.emplace(brush.footprints);
    using P = Eigen::RowVector2d;
    // box of the footprint at a row, slightly enlarged
    const auto box_of = [&](std::size_t i, P& low, P& high) {
        const double d = marks.depth_mm[i], pull = marks.pull[i], hair = 1e-6;
        if (!(pull >= 0.0 && pull <= 1.0)) {
            constexpr double inf = std::numeric_limits<double>::infinity();
            low.setConstant(-inf);
            high.setConstant(inf);
            return;
        }
        const OutlineBox box = boxes->at(d, pull);
        const double c = std::cos(marks.heading_rad[i]), s = std::sin(marks.heading_rad[i]), b = brush.tip_gap(d);
        const P u(c, s), there = marks.contact_mm.row(Eigen::Index(i)), back = there + (box.back - b) * u,
                         front = there + (box.front - b) * u, side(box.side * std::abs(s), box.side * std::abs(c));
        low = (back.cwiseMin(front) - side).array() - hair;
        high = (back.cwiseMax(front) + side).array() + hair;
    };
    Ring before;           // empty if it was skipped
    bool is_down = false;  // whether the brush was on the paper in the row before
    [[maybe_unused]] P low_before, high_before;
    for (std::size_t i = 0; i < marks.pose.size(); ++i) {
        if (marks.depth_mm[i] < 0.0) {  // lifted
            is_down = false;
            continue;
        }
        checkpoint(5);
        // where the heading flips over at once (the TCP passes over the patch), nothing is swept in between
        const bool flipped = is_down && std::cos(marks.heading_rad[i] - marks.heading_rad[i - 1]) < 0.8;
        if constexpr (!is_everywhere) {
            if (skips_outside) {
                P low, high;
                box_of(i, low, high);
                const P here_low = low, here_high = high;
                if (is_down && !flipped) {
                    low = low.cwiseMin(low_before);
                    high = high.cwiseMax(high_before);
                }
                low_before = here_low;
                high_before = here_high;
                if (is_outside(low, high)) {
                    before.resize(0, 2);
                    is_down = true;
                    continue;
                }
                if (is_down && !flipped && before.rows() == 0) before = placed(i - 1);
            }
        }
        Ring now = placed(i);
        if (!is_down) {
            if (all_convex)
                convex(now, now);
            else
                polygon(now);
        } else {
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
        is_down = true;
    }
}

}  // namespace brushsvg
