#include "brushsvg/target_mark.hpp"

#include <algorithm>
#include <cmath>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg {
namespace {

constexpr double kPi = 3.14159265358979323846;

double disc_factor(int n) { return std::sqrt(2.0 * kPi / n / std::sin(2.0 * kPi / n)); }

/// Return the hull of two discs as a ring. The discs are polygons of n sides (a multiple of 4). Their vertices across
/// the segment are on the circle, so that the flanks are exact. The other vertices are slightly outside, so that the
/// caps have the disc's area.
Ring hull_of_discs(const Eigen::Vector2d& a, double ra, const Eigen::Vector2d& b, double rb, int n) {
    const double grow = disc_factor(n);
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

/// Return the hulls of neighbouring discs. A hull is left out if `is_outside` returns true for its box: left, bottom,
/// right and top.
template <class IsOutside>
Rings hull_pieces(const Stroke& stroke, double tolerance_mm, IsOutside&& is_outside) {
    const MiddlePolyline line = flatten(stroke, tolerance_mm);
    const double widest = line.col(3).maxCoeff();
    if (!(widest > 0.0)) return {};
    // sagitta of a side: r (1 - cos(pi / n))
    const double cosine = std::max(0.5, 1.0 - tolerance_mm / widest);
    const int n = 4 * std::max(3, int(std::ceil(kPi / std::acos(cosine) / 4.0)));
    const double grow = 1.0001 * disc_factor(n);
    Rings hulls;
    for (Eigen::Index i = 0; i < std::max<Eigen::Index>(1, line.rows() - 1); ++i) {
        checkpoint(20);
        const Eigen::Index j = std::min(i + 1, line.rows() - 1);
        const double reach = grow * std::max(line(i, 3), line(j, 3));
        if (is_outside(std::min(line(i, 0), line(j, 0)) - reach, std::min(line(i, 1), line(j, 1)) - reach,
                       std::max(line(i, 0), line(j, 0)) + reach, std::max(line(i, 1), line(j, 1)) + reach))
            continue;
        hulls.push_back(hull_of_discs(line.row(i).head<2>().transpose(), line(i, 3), line.row(j).head<2>().transpose(),
                                      line(j, 3), n));
    }
    return hulls;
}

}  // namespace

Rings target_pieces(const Stroke& stroke, double tolerance_mm) {
    return hull_pieces(stroke, tolerance_mm, [](double, double, double, double) { return false; });
}

Rings target_pieces_near(const Stroke& stroke, const Window& window, double tolerance_mm) {
    return hull_pieces(stroke, tolerance_mm, [&](double left, double bottom, double right, double top) {
        return right < window.x_mm || left > window.x_mm + window.width_mm || top < window.y_mm ||
               bottom > window.y_mm + window.height_mm;
    });
}

Rings target_outline(const Stroke& stroke, double tolerance_mm) {
    if (!stroke.target_mm.empty()) return stroke.target_mm;
    return unite(target_pieces(stroke, tolerance_mm));
}

}  // namespace brushsvg
