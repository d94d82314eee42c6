#include "strokes/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/simulate.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr double kMaxPxPerMm = 6.0;  // coarser pixels miss visible details of 0.15 mm, finer ones take longer
constexpr double kMaxSidePx = 2e3;   // pixels: a shape of half a metre has coarser pixels
// Length of the parts into which long edges are split: each part handles the pixels about it.
constexpr double kMaxEdgePartMm = 2.0;
constexpr double kRowToleranceMm = 0.05;  // tolerance of the rows of marks: a third of a pixel

/// Return the distance [mm] of each pixel from an outline. Pixels further away than the reach get the largest value.
Coverage edge_distances(const Rings& rings, const Canvas& canvas, Index rows, Index columns, double reach_mm) {
    Coverage out = Coverage::Constant(rows, columns, std::numeric_limits<float>::max());
    const auto near = [&](const Vector2d& a, const Vector2d& b) {
        const Vector2d reach(reach_mm, reach_mm), way = b - a;
        const PixelBox box = canvas.box_of(a.cwiseMin(b) - reach, a.cwiseMax(b) + reach);
        const double squared = std::max(way.squaredNorm(), 1e-18);
        for (Index row = box.row; row < box.row + box.rows; ++row)
            for (Index column = box.column; column < box.column + box.columns; ++column) {
                const Vector2d off = canvas.place(row, column) - a;
                const double t = std::clamp(off.dot(way) / squared, 0.0, 1.0);
                out(row, column) = std::min(out(row, column), float((off - t * way).norm()));
            }
    };
    for (const Ring& ring : rings)
        for (Index i = 0, n = ring.rows(); i < n; ++i) {
            checkpoint(10);
            const Vector2d a = ring.row(i).transpose(), b = ring.row((i + 1) % n).transpose();
            const int parts = std::max(1, int(std::ceil((b - a).norm() / kMaxEdgePartMm)));
            for (int k = 0; k < parts; ++k) near(a + double(k) / parts * (b - a), a + double(k + 1) / parts * (b - a));
        }
    return out;
}

}  // namespace

Canvas::Canvas(const Rings& target_mm, const ObjectiveWeights& weights, double margin_mm) : weights_(weights) {
    Vector2d low(0.0, 0.0), high(0.0, 0.0);
    bool is_first = true;
    for (const Ring& ring : target_mm) {
        if (ring.rows() == 0) continue;
        const Vector2d lo = ring.colwise().minCoeff().transpose(), hi = ring.colwise().maxCoeff().transpose();
        low = is_first ? lo : low.cwiseMin(lo).eval();
        high = is_first ? hi : high.cwiseMax(hi).eval();
        is_first = false;
    }
    const Vector2d size = (high - low).array() + 2.0 * margin_mm;
    px_per_mm_ = std::min(kMaxPxPerMm, kMaxSidePx / size.maxCoeff());
    const Vector2d pixels = (size * px_per_mm_).array().ceil();
    window_ = {low.x() - margin_mm, low.y() - margin_mm, pixels.x() / px_per_mm_, pixels.y() / px_per_mm_};
    target_ = coverage(target_mm, window_, px_per_mm_);
    const double seen_mm = weights.seen_mm;
    const Coverage edge = edge_distances(target_mm, *this, target_.rows(), target_.cols(), seen_mm + 1.0 / px_per_mm_);
    inner_ = outer_ = target_;
    for (Index i = 0; i < target_.size(); ++i) {
        const bool is_in = target_.data()[i] >= 0.5f;
        const float off = std::min(edge.data()[i], 1e3f) - float(seen_mm);
        const float share = std::clamp(0.5f + float(px_per_mm_) * (is_in ? off : -off), 0.0f, 1.0f);
        inner_.data()[i] = is_in ? share : 0.0f;
        outer_.data()[i] = is_in ? 1.0f : share;
    }
}

Window Canvas::window_of(const PixelBox& box) const {
    return {window_.x_mm + double(box.column) / px_per_mm_,
            window_.y_mm + window_.height_mm - double(box.row + box.rows) / px_per_mm_,
            double(box.columns) / px_per_mm_, double(box.rows) / px_per_mm_};
}

PixelBox Canvas::box_of(const Vector2d& low_mm, const Vector2d& high_mm) const {
    const double top = window_.y_mm + window_.height_mm;
    const auto clipped = [](double at, Index most) { return Index(std::clamp(std::floor(at), 0.0, double(most))); };
    const Index left = clipped((low_mm.x() - window_.x_mm) * px_per_mm_, target_.cols());
    const Index right = clipped((high_mm.x() - window_.x_mm) * px_per_mm_ + 1.0, target_.cols());
    const Index first = clipped((top - high_mm.y()) * px_per_mm_, target_.rows());
    const Index last = clipped((top - low_mm.y()) * px_per_mm_ + 1.0, target_.rows());
    return {first, left, last - first, right - left};
}

Vector2d Canvas::place(Index row, Index column) const {
    return {window_.x_mm + (double(column) + 0.5) / px_per_mm_,
            window_.y_mm + window_.height_mm - (double(row) + 0.5) / px_per_mm_};
}

bool Canvas::is_inside(const Vector2d& at_mm) const {
    const double column = (at_mm.x() - window_.x_mm) * px_per_mm_;
    const double row = (window_.y_mm + window_.height_mm - at_mm.y()) * px_per_mm_;
    return column >= 0.0 && row >= 0.0 && column < double(target_.cols()) && row < double(target_.rows()) &&
           target_(Index(row), Index(column)) >= 0.5f;
}

Tile Canvas::paint(const Pass& pass, const Brush& brush) const {
    Marks marks;
    marks.passes.push_back(simulate_near(pass, brush, window_, kRowToleranceMm));
    const std::array<double, 4> bounds = painted_bounds(marks.passes.front(), brush);
    Tile tile;
    if (!(bounds[0] <= bounds[2])) return tile;
    tile.box = box_of({bounds[0], bounds[1]}, {bounds[2], bounds[3]});
    if (!tile.box.is_empty()) tile.share = coverage(marks, brush, window_of(tile.box), px_per_mm_);
    return tile;
}

double Canvas::cost_mm2(const PixelBox& box, const Coverage& painted, bool is_last) const {
    const auto part = [&](const Coverage& of) { return of.block(box.row, box.column, box.rows, box.columns).array(); };
    const auto paint = painted.array();
    const double missing = double((part(target_) - paint).max(0.0f).sum());
    const double spill = double((paint - part(target_)).max(0.0f).sum());
    const double notch = !is_last ? 0.0 : double((part(inner_) - paint).max(0.0f).sum());
    const double bulge = double((paint - part(outer_)).max(0.0f).sum());
    return (weights_.missing * missing + weights_.spill * spill + weights_.notch * notch + weights_.bulge * bulge) /
           (px_per_mm_ * px_per_mm_);
}

double Canvas::bulge_mm2(const Tile& tile) const {
    if (tile.box.is_empty()) return 0.0;
    const auto out = outer_.block(tile.box.row, tile.box.column, tile.box.rows, tile.box.columns);
    return double((tile.share - out).cwiseMax(0.0f).sum()) / (px_per_mm_ * px_per_mm_);
}

void paint_over(Coverage& picture, const PixelBox& box, const Tile& tile) {
    const Index top = std::max(box.row, tile.box.row), left = std::max(box.column, tile.box.column);
    const Index rows = std::min(box.row + box.rows, tile.box.row + tile.box.rows) - top;
    const Index columns = std::min(box.column + box.columns, tile.box.column + tile.box.columns) - left;
    if (rows <= 0 || columns <= 0) return;
    auto part = picture.block(top - box.row, left - box.column, rows, columns);
    part = part.cwiseMax(tile.share.block(top - tile.box.row, left - tile.box.column, rows, columns)).eval();
}

}  // namespace brushsvg
