#include "brushsvg/target_mark.hpp"

#include <algorithm>
#include <cmath>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Hull of two discs as a ring: polygons of n sides (a multiple of 4) whose vertices across the segment lie on the
/// circle, so that the flanks are exact, and whose others lie a little outside, so that the caps have the disc's area.
Ring hull_of_discs(const Eigen::Vector2d& a, double ra, const Eigen::Vector2d& b, double rb, int n) {
    const double grow = std::sqrt(2.0 * kPi / n / std::sin(2.0 * kPi / n));
    const double along = std::atan2(b.y() - a.y(), b.x() - a.x());
    Ring points(2 * n, 2);
    for (int i = 0; i < n; ++i) {
        const double angle = along + 2.0 * kPi * i / n;
        const Eigen::Vector2d d =
            (i % (n / 2) == n / 4 ? 1.0 : grow) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        points.row(i) = (a + ra * d).transpose();
        points.row(n + i) = (b + rb * d).transpose();
    }
    return convex_hull(points);
}

}  // namespace

Rings wanted_pieces(const Stroke& stroke, double tolerance_mm) {
    const MiddlePolyline line = flatten(stroke, tolerance_mm);
    const double widest = line.col(3).maxCoeff();
    if (!(widest > 0.0)) return {};
    // sagitta of a side: r (1 - cos(pi / n))
    const double cosine = std::max(0.5, 1.0 - tolerance_mm / widest);
    const int n = 4 * std::max(3, int(std::ceil(kPi / std::acos(cosine) / 4.0)));
    Rings hulls;
    for (Eigen::Index i = 0; i < std::max<Eigen::Index>(1, line.rows() - 1); ++i) {
        checkpoint(20);
        const Eigen::Index j = std::min(i + 1, line.rows() - 1);
        hulls.push_back(hull_of_discs(line.row(i).head<2>().transpose(), line(i, 3), line.row(j).head<2>().transpose(),
                                      line(j, 3), n));
    }
    return hulls;
}

Rings wanted_outline(const Stroke& stroke, double tolerance_mm) {
    if (!stroke.wanted_mm.empty()) return stroke.wanted_mm;
    return unite(wanted_pieces(stroke, tolerance_mm));
}

}  // namespace brushsvg
