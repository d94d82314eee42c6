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

constexpr double kToleranceMm = 0.1;
constexpr double kTwoPi = 6.28318530717958648;

/// Sum of the absolute angles at its corners: one turn where it is convex. From its first point to the farthest and
/// back, so that what is left of a small ring is no single line.
double turns(const Ring& ring) {
    const Eigen::Index n = ring.rows();
    if (n < 3) return 0.0;
    Eigen::Index farthest = 0;
    (ring.rowwise() - ring.row(0)).rowwise().squaredNorm().maxCoeff(&farthest);
    std::vector<Point> corners;
    for (const auto& [first, last] : {std::pair(Eigen::Index(0), farthest), std::pair(farthest, n)}) {
        Line line, simple;
        for (Eigen::Index i = first; i <= last; ++i) line.emplace_back(ring(i % n, 0), ring(i % n, 1));
        bg::simplify(line, simple, kToleranceMm);
        corners.insert(corners.end(), simple.begin(), simple.end() - 1);
    }
    const std::size_t count = corners.size();
    double sum = 0.0;
    for (std::size_t i = 0; count > 2 && i < count; ++i) {
        const Point &a = corners[i], &b = corners[(i + 1) % count], &c = corners[(i + 2) % count];
        const double ux = b.x() - a.x(), uy = b.y() - a.y(), vx = c.x() - b.x(), vy = c.y() - b.y();
        sum += std::abs(std::atan2(ux * vy - uy * vx, ux * vx + uy * vy));
    }
    return sum / kTwoPi;
}

double turns(const Rings& rings) {
    double sum = 0.0;
    for (const Ring& ring : rings) sum += turns(ring);
    return sum;
}

}  // namespace

double excess_turning(const Rings& mark, const Rings& wanted) { return turns(mark) - turns(wanted); }

}  // namespace brushsvg
