#include "brushsvg/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "marks/rasterizer.hpp"
#include "marks/sweep.hpp"

namespace brushsvg {
namespace {

constexpr std::size_t kMinPassesPerThread = 32;  // least number for one processor: fewer are not worth a thread
constexpr double kMaxNegativeAreaMm2 = 1e-6;     // mm^2: a piece may turn over by this much because of rounding

void require_finite(const Rings& rings) {
    for (const Ring& ring : rings)
        if (ring.rows() > 0 && !(ring.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kMaxPaintedCoordinateMm))
            throw Error("geometry-out-of-range", "a ring has a coordinate that is not finite or beyond 1e7 mm");
}

}  // namespace

Coverage coverage(const Marks& marks, const Brush& brush, const Window& window, double px_per_mm) {
    const std::size_t count = marks.passes.size();
    const std::size_t parts = std::clamp<std::size_t>(count / kMinPassesPerThread, 1, processor_count());
    std::vector<Rasterizer> rasters(parts, Rasterizer(window, px_per_mm));
    parallel_for(0, parts, [&](std::size_t part) {
        Rasterizer& raster = rasters[part];
        for (std::size_t i = part * count / parts; i < (part + 1) * count / parts; ++i)
            sweep(
                marks.passes[i], brush, [&](const Ring& a, const Ring& b) { raster.convex_pair(a, b); },
                [&](const Ring& ring) { raster.polygon({ring}); },
                [&](const Ring& piece) { raster.convex_pair(piece, piece); },
                [&](const auto& low, const auto& high) { return raster.is_outside(low, high); });
    });
    for (std::size_t part = 1; part < parts; ++part) rasters[0].add_shapes_of(rasters[part]);
    return rasters[0].coverage();
}

Coverage coverage(const Rings& rings, const Window& window, double px_per_mm) {
    const std::array<Eigen::Index, 2> size = picture_size(window, px_per_mm);
    // separate names: clang 14 cannot capture structured bindings
    const Eigen::Index width = size[0], height = size[1];
    require_finite(rings);
    // exact: each edge adds the area to its right to each pixel that it crosses, and its height to all pixels beyond
    Eigen::MatrixXd edge = Eigen::MatrixXd::Zero(width + 2, height);                 // one column per pixel row
    const auto add = [&](double x0, double y0, double x1, double y1, double sign) {  // within one pixel row
        const auto row = Eigen::Index(std::floor(0.5 * (y0 + y1)));
        if (row < 0 || row >= height) return;
        if (x0 > x1) std::swap(x0, x1);
        const double dy = sign * (y1 - y0), w = double(width);
        x0 = std::clamp(x0, 0.0, w);
        x1 = std::clamp(x1, 0.0, w);
        const auto first = Eigen::Index(x0), last = Eigen::Index(x1);
        if (x1 - x0 < 1e-12) {
            edge(first, row) += dy * (first + 1 - x0);
            edge(first + 1, row) += dy * (x0 - first);
            return;
        }
        for (Eigen::Index k = first; k <= last; ++k) {
            const double a = std::max(x0, double(k)), b = std::min(x1, double(k + 1));
            const double part = dy * (b - a) / (x1 - x0), middle = 0.5 * (a + b) - double(k);
            edge(k, row) += part * (1.0 - middle);
            edge(k + 1, row) += part * middle;
        }
    };
    for (const Ring& ring : rings)
        for (Eigen::Index i = 0, n = ring.rows(); i < n; ++i) {
            const Eigen::Index j = i + 1 == n ? 0 : i + 1;
            double x0 = (ring(i, 0) - window.x_mm) * px_per_mm, x1 = (ring(j, 0) - window.x_mm) * px_per_mm;
            double y0 = (window.y_mm + window.height_mm - ring(i, 1)) * px_per_mm;
            double y1 = (window.y_mm + window.height_mm - ring(j, 1)) * px_per_mm;
            const double sign = y0 < y1 ? 1.0 : -1.0;
            if (y0 > y1) std::swap(x0, x1), std::swap(y0, y1);
            if (!(y1 > y0) || y1 <= 0.0 || y0 >= double(height)) continue;
            const double slope = (x1 - x0) / (y1 - y0);
            if (!std::isfinite(slope)) continue;
            const double top = std::max(y0, 0.0), bottom = std::min(y1, double(height));
            for (double y = top; y < bottom;) {
                checkpoint();
                const double until = std::min(bottom, std::floor(y) + 1.0);
                // clipping in x may bend the edge at the window's side, beyond which nothing shows
                add(x0 + (y - y0) * slope, y, x0 + (until - y0) * slope, until, sign);
                y = until;
            }
        }
    Coverage out(height, width);
    for (Eigen::Index row = 0; row < height; ++row) {
        checkpoint(1 + int(width / 50));
        double sum = 0.0;
        for (Eigen::Index x = 0; x < width; ++x) {
            sum += edge(x, row);
            out(row, x) = float(std::clamp(std::abs(sum), 0.0, 1.0));
        }
    }
    return out;
}

Coverage coverage_of_pieces(const Rings& convex, const Window& window, double px_per_mm) {
    require_finite(convex);
    Rasterizer raster(window, px_per_mm);
    for (const Ring& piece : convex) {
        if (piece.rows() == 0) continue;
        if (const double mm2 = signed_area(piece); mm2 < -kMaxNegativeAreaMm2)
            throw Error("outline-clockwise", "a convex piece is clockwise: list its points counter-clockwise", "", mm2);
        raster.convex_pair(piece, piece);
    }
    return raster.coverage();
}

Rings outline(const PassMarks& pass, const Brush& brush) {
    Rings swept, chain;
    const auto keep = [&](const Ring& ring) {
        if (ring.rows() > 2) swept.push_back(ring);
    };
    const auto end_chain = [&] {
        for (const Ring& piece : pieces_between(chain)) keep(piece);
        chain.clear();
    };
    sweep(
        pass, brush,
        [&](const Ring& a, const Ring& b) {
            if (&a == &b) end_chain();  // set down, or turned over at once
            chain.push_back(b);
        },
        keep, keep);
    end_chain();
    return unite(swept);
}

std::array<double, 4> painted_bounds(const PassMarks& marks, const Brush& brush) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    std::array<double, 4> box{inf, inf, -inf, -inf};
    const auto include = [&](const Ring& ring) {
        box = {std::min(box[0], ring.col(0).minCoeff()), std::min(box[1], ring.col(1).minCoeff()),
               std::max(box[2], ring.col(0).maxCoeff()), std::max(box[3], ring.col(1).maxCoeff())};
    };
    // an area inside of the known box adds nothing
    sweep(
        marks, brush, [&](const Ring&, const Ring& b) { include(b); }, include, [](const Ring&) {},
        [&](const auto& low, const auto& high) {
            return low.x() >= box[0] && low.y() >= box[1] && high.x() <= box[2] && high.y() <= box[3];
        });
    return box;
}

}  // namespace brushsvg
