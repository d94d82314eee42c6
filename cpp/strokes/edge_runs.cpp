#include "strokes/edge_runs.hpp"

#include <algorithm>
#include <boost/geometry.hpp>
#include <cmath>
#include <limits>

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
namespace bg = boost::geometry;
using Point = bg::model::d2::point_xy<double>;

constexpr double kMinCornerRad = 30.0 / 180.0 * 3.14159265358979323846;
constexpr double kSimplifyToleranceMm = 0.02;  // bends of edges that are smaller are ignored, as in flattened outlines
constexpr double kDirectionReachMm = 0.1;      // length in both directions over which a direction is measured

/// Return a ring with fewer points, at most kSimplifyToleranceMm away from the original.
Ring simplify_ring(const Ring& ring) {
    const Index n = ring.rows();
    Index farthest = 0;
    (ring.rowwise() - ring.row(0)).rowwise().squaredNorm().maxCoeff(&farthest);
    std::vector<Point> kept;
    for (const auto& [first, last] : {std::pair(Index(0), farthest), std::pair(farthest, n)}) {
        bg::model::linestring<Point> line, few;
        for (Index i = first; i <= last; ++i) line.emplace_back(ring(i % n, 0), ring(i % n, 1));
        bg::simplify(line, few, kSimplifyToleranceMm);
        kept.insert(kept.end(), few.begin(), few.end() - 1);
    }
    Ring out(Index(kept.size()), 2);
    for (Index i = 0; i < out.rows(); ++i) out.row(i) << kept[std::size_t(i)].x(), kept[std::size_t(i)].y();
    return out;
}

EdgeRun make_run(const Ring& ring, Index first, Index last) {
    EdgeRun run;
    run.points.resize(last - first + 1, 2);
    for (Index i = first; i <= last; ++i) {
        run.points.row(i - first) = ring.row(i % ring.rows());
        const double step = i == first ? 0.0 : (run.points.row(i - first) - run.points.row(i - first - 1)).norm();
        run.at_mm.push_back(i == first ? 0.0 : run.at_mm.back() + step);
    }
    return run;
}

}  // namespace

std::pair<Vector2d, Vector2d> EdgeRun::at(double arc_mm) const {
    const double length = length_mm();
    if (is_ring) arc_mm -= length * std::floor(arc_mm / length);
    const auto point = [&](double at) -> Vector2d {
        const auto next = std::upper_bound(at_mm.begin() + 1, at_mm.end() - 1, at) - at_mm.begin();
        const double from = at_mm[std::size_t(next - 1)], step = at_mm[std::size_t(next)] - from;
        const double t = step > 0.0 ? (at - from) / step : 0.0;
        return (points.row(next - 1) + t * (points.row(next) - points.row(next - 1))).transpose();
    };
    const double reach = std::min(kDirectionReachMm, length / 2.0);
    const double near = std::clamp(arc_mm, reach, length - reach);
    const Vector2d a = point(near - reach), b = point(near + reach);
    const Vector2d along = (b - a).normalized();
    return {(a + b) / 2.0 + (arc_mm - near) * along, along};
}

std::pair<double, double> EdgeRun::nearest(const Vector2d& place_mm) const {
    double best = std::numeric_limits<double>::infinity(), where = 0.0;
    for (Index i = 0; i + 1 < points.rows(); ++i) {
        const Vector2d a = points.row(i).transpose(), way = points.row(i + 1).transpose() - a;
        const double squared = way.squaredNorm();
        const double t = squared > 0.0 ? std::clamp((place_mm - a).dot(way) / squared, 0.0, 1.0) : 0.0;
        const double off = (place_mm - a - t * way).squaredNorm();
        if (off >= best) continue;
        best = off;
        where = at_mm[std::size_t(i)] + t * std::sqrt(squared);
    }
    return {std::sqrt(best), where};
}

OutlineEdges find_edge_runs(const Rings& rings) {
    OutlineEdges out;
    for (const Ring& whole : rings) {
        if (whole.rows() < 3) continue;
        const Ring ring = simplify_ring(whole);
        const Index n = ring.rows();
        if (n < 3) continue;
        std::vector<Index> corners;
        std::vector<double> turns(std::size_t(n), 0.0);
        for (Index i = 0; i < n; ++i) {
            const Vector2d before = (ring.row(i) - ring.row((i + n - 1) % n)).transpose();
            const Vector2d after = (ring.row((i + 1) % n) - ring.row(i)).transpose();
            const double turn = std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
            turns[std::size_t(i)] = turn;
            if (std::abs(turn) <= kMinCornerRad) continue;
            corners.push_back(i);
            if (turn > 0.0)
                out.corners.push_back(
                    {ring.row(i).transpose(), (after.normalized() - before.normalized()).normalized()});
        }
        if (corners.empty()) {
            out.runs.push_back(make_run(ring, 0, n));
            out.runs.back().is_ring = true;
            continue;
        }
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const Index first = corners[k], last = k + 1 < corners.size() ? corners[k + 1] : corners[0] + n;
            out.runs.push_back(make_run(ring, first, last));
            out.runs.back().turns_rad = {turns[std::size_t(first)], turns[std::size_t(last % n)]};
        }
    }
    return out;
}

}  // namespace brushsvg
