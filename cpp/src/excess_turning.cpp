#include "brushsvg/excess_turning.hpp"

#include <boost/geometry.hpp>
#include <cmath>
#include <cstddef>

namespace brushsvg {
namespace {

namespace bg = boost::geometry;
using Point = bg::model::d2::point_xy<double>;
using Polygon = bg::model::ring<Point, false, false>;

constexpr double kToleranceMm = 0.1;
constexpr double kTwoPi = 6.28318530717958648;

/// Sum of the absolute angles at its corners: one turn where it is convex.
double turns(const Ring& ring) {
    Polygon polygon, simple;
    for (Eigen::Index i = 0; i < ring.rows(); ++i) polygon.emplace_back(ring(i, 0), ring(i, 1));
    bg::simplify(polygon, simple, kToleranceMm);
    const std::size_t n = simple.size();
    double sum = 0.0;
    for (std::size_t i = 0; n > 2 && i < n; ++i) {
        const Point &a = simple[i], &b = simple[(i + 1) % n], &c = simple[(i + 2) % n];
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
