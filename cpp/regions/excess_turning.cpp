#include "brushsvg/excess_turning.hpp"

#include <boost/geometry.hpp>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace brushsvg {
namespace {

namespace bg = boost::geometry;
using Point = bg::model::d2::point_xy<double>;
using Line = bg::model::linestring<Point>;
using Shape = bg::model::multi_polygon<bg::model::polygon<Point, false, false>>;

constexpr double kSimplifyToleranceMm = 0.1;
// Smaller rings are pinholes between footprints side by side. Paint closes them and nobody sees them, but each would
// count as a whole turn. The finest line of round-6 leaves rings a hundred times as large.
constexpr double kMinRingAreaMm2 = 0.01;
constexpr double kTwoPi = 6.28318530717958648;
// Limits of a thorn: it is more than a waver of the edge, turns more sharply than a curve, and is outside of the
// target.
constexpr double kThornToleranceMm = 0.05, kMinThornRad = kTwoPi * 20.0 / 360.0, kMinThornDistanceMm = 0.3;

/// Return the corners of a simplified ring. The ring is simplified from its first point to the farthest one and back.
/// So a small ring is not reduced to a single line.
std::vector<Point> simplified_corners(const Ring& ring, double tolerance_mm) {
    const Eigen::Index n = ring.rows();
    if (n < 3) return {};
    Eigen::Index farthest = 0;
    (ring.rowwise() - ring.row(0)).rowwise().squaredNorm().maxCoeff(&farthest);
    std::vector<Point> corners;
    for (const auto& [first, last] : {std::pair(Eigen::Index(0), farthest), std::pair(farthest, n)}) {
        Line line, simple;
        for (Eigen::Index i = first; i <= last; ++i) line.emplace_back(ring(i % n, 0), ring(i % n, 1));
        bg::simplify(line, simple, tolerance_mm);
        corners.insert(corners.end(), simple.begin(), simple.end() - 1);
    }
    if (corners.size() < 3) corners.clear();
    return corners;
}

/// Call `visit` with each corner and the angle by which the outline turns there, to the left [rad].
template <class Visit>
void for_each_turn(const std::vector<Point>& corners, Visit&& visit) {
    const std::size_t count = corners.size();
    for (std::size_t i = 0; i < count; ++i) {
        const Point &a = corners[i], &b = corners[(i + 1) % count], &c = corners[(i + 2) % count];
        const double ux = b.x() - a.x(), uy = b.y() - a.y(), vx = c.x() - b.x(), vy = c.y() - b.y();
        visit(b, std::atan2(ux * vy - uy * vx, ux * vx + uy * vy));
    }
}

/// Return the sum of the absolute angles at a ring's corners, in full turns: 1 if the ring is convex.
double turns(const Ring& ring) {
    double sum = 0.0;
    for_each_turn(simplified_corners(ring, kSimplifyToleranceMm),
                  [&](const Point&, double angle) { sum += std::abs(angle); });
    return sum / kTwoPi;
}

double turns(const Rings& rings) {
    double sum = 0.0;
    for (const Ring& ring : rings)
        if (std::abs(signed_area(ring)) >= kMinRingAreaMm2) sum += turns(ring);
    return sum;
}

}  // namespace

double excess_turning(const Rings& mark, const Rings& target) { return turns(mark) - turns(target); }

int thorns(const Rings& mark, const Rings& target) {
    Shape shape;
    for (const Ring& ring : target) {
        if (ring.rows() < 3) continue;
        bg::model::ring<Point, false, false> rim;
        for (Eigen::Index i = 0; i < ring.rows(); ++i) rim.emplace_back(ring(i, 0), ring(i, 1));
        if (shape.empty() || bg::area(rim) > 0.0)
            shape.push_back({rim});
        else
            shape.back().inners().push_back(rim);
    }
    int count = 0;
    for (const Ring& ring : mark)
        for_each_turn(simplified_corners(ring, kThornToleranceMm), [&](const Point& corner, double angle) {
            count += angle > kMinThornRad && (shape.empty() || bg::distance(corner, shape) > kMinThornDistanceMm);
        });
    return count;
}

}  // namespace brushsvg
