#include "brushsvg/cubic_fit.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace brushsvg;

namespace {

constexpr double kPi = 3.14159265358979323846;

WideLine arc(double radius, double angle, int n) {
    WideLine line(n, 3);
    for (int i = 0; i < n; ++i) {
        const double t = double(i) / (n - 1);
        line.row(i) << radius * std::cos(angle * t), radius * std::sin(angle * t), 1.0 + t;
    }
    return line;
}

double farthest(const FittedLine& fitted, double radius) {
    double most = 0.0;
    for (Eigen::Index i = 0; i < fitted.middle_mm.rows(); ++i)
        for (double t = 0.0; t <= 1.0; t += 0.05)
            most = std::max(most, std::abs(point_at(fitted.middle_mm, {i, t}).norm() - radius));
    return most;
}

}  // namespace

TEST_CASE("a straight line with an even taper is one cubic and two widths") {
    WideLine line(50, 3);
    for (int i = 0; i < 50; ++i) line.row(i) << i, 2.0 * i, 3.0 - 0.05 * i;
    const FittedLine fitted = fit_cubics(line, 0.01, false);
    CHECK(fitted.middle_mm.rows() == 1);
    REQUIRE(fitted.half_width.size() == 2);
    CHECK(fitted.half_width[0].half_width_mm == doctest::Approx(3.0));
    CHECK(fitted.half_width[1].half_width_mm == doctest::Approx(3.0 - 0.05 * 49));
}

TEST_CASE("half a circle is fitted within its tolerance, with more cubics for a finer one") {
    const FittedLine coarse = fit_cubics(arc(20.0, kPi, 200), 0.2, false);
    const FittedLine fine = fit_cubics(arc(20.0, kPi, 200), 0.005, false);
    CHECK(farthest(coarse, 20.0) < 0.2);
    CHECK(farthest(fine, 20.0) < 0.005);
    CHECK(coarse.middle_mm.rows() <= 2);
    CHECK(fine.middle_mm.rows() > coarse.middle_mm.rows());
}

TEST_CASE("no cubic runs backwards along a noisy straight line") {
    std::mt19937 noise(1);
    for (int trial = 0; trial < 300; ++trial) {
        WideLine line(60, 3);
        double aside = 0.0;
        for (int i = 0; i < 60; ++i) {
            aside += 0.2 * (double(noise()) / double(std::mt19937::max()) - 0.5);
            line.row(i) << i / 3.0, aside, 2.0;
        }
        const FittedLine fitted = fit_cubics(line, 0.05, false);
        for (Eigen::Index i = 0; i < fitted.middle_mm.rows(); ++i)
            for (double t = 0.0; t <= 1.0; t += 0.02) CHECK(tangent_at(fitted.middle_mm, {i, t}).x() > 0.3);
    }
}

TEST_CASE("cubics meet with one tangent, also at the seam of a closed line") {
    const FittedLine ring = fit_cubics(arc(20.0, 2.0 * kPi, 400), 0.02, true);
    const Eigen::Index n = ring.middle_mm.rows();
    CHECK(n > 1);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Index next = (i + 1) % n;
        CHECK((point_at(ring.middle_mm, {i, 1.0}) - point_at(ring.middle_mm, {next, 0.0})).norm() < 1e-9);
        CHECK(tangent_at(ring.middle_mm, {i, 1.0}).dot(tangent_at(ring.middle_mm, {next, 0.0})) > 0.999);
    }
}

TEST_CASE("noise below the tolerance adds few cubics") {
    WideLine line(200, 3);
    for (int i = 0; i < 200; ++i) line.row(i) << 0.25 * i, (i % 2 ? 0.01 : -0.01), 2.0 + (i % 3 ? 0.01 : -0.01);
    const FittedLine fitted = fit_cubics(line, 0.06, false);
    CHECK(fitted.middle_mm.rows() <= 3);
    CHECK(fitted.half_width.size() == 2);
}

TEST_CASE("fits of a point, repeated points and a reversal terminate") {
    WideLine point(3, 3);
    point << 1, 2, 0.5, 1, 2, 0.5, 1, 2, 0.5;
    const FittedLine dab = fit_cubics(point, 0.1, false);
    CHECK(dab.middle_mm.rows() == 1);
    CHECK(dab.half_width.size() == 1);
    CHECK(fit_cubics(WideLine(0, 3), 0.1, false).middle_mm.rows() == 0);
    WideLine back(21, 3);
    for (int i = 0; i < 21; ++i) back.row(i) << (i <= 10 ? i : 20 - i), 0.0, 1.0;
    const FittedLine there_and_back = fit_cubics(back, 0.05, false);
    CHECK(there_and_back.middle_mm.allFinite());
    CHECK(there_and_back.middle_mm.rows() <= 20);
}

TEST_CASE("a stroke along points passes all of them, including corners") {
    WideLine points(60, 3);  // half a circle, a corner, and a straight line
    for (int i = 0; i < 50; ++i)
        points.row(i) << 20.0 * std::cos(kPi * i / 49.0), 20.0 * std::sin(kPi * i / 49.0), 1.0 + 0.02 * i;
    for (int i = 50; i < 60; ++i) points.row(i) << -20.0 + 3.0 * (i - 49), 0.0, 2.0;
    for (const double tolerance : {0.2, 0.02, 0.002}) {
        const Stroke stroke = stroke_along("s", points, tolerance);
        CHECK_NOTHROW(check(stroke));
        CHECK(stroke.middle_mm.rows() <= (tolerance > 0.01 ? 30 : 59));  // the chords are 0.01 mm off the circle
        const MiddlePolyline line = flatten(stroke, 1e-5);
        double most = 0.0;
        for (Eigen::Index i = 0; i < points.rows(); ++i) {
            const Eigen::Vector2d p = points.row(i).head<2>().transpose();
            double best = 1e9;
            for (Eigen::Index k = 1; k < line.rows(); ++k) {
                const Eigen::Vector2d a = line.row(k - 1).head<2>().transpose(),
                                      d = line.row(k).head<2>().transpose() - a;
                const double t = std::min(1.0, std::max(0.0, (p - a).dot(d) / d.squaredNorm()));
                best = std::min(best, (p - a - t * d).norm());
            }
            most = std::max(most, best);
        }
        CHECK(most <= tolerance);
    }
    const Stroke lines = stroke_along("s", points);
    CHECK(lines.middle_mm.rows() == 59);
    CHECK(lines.half_width.front().half_width_mm == 1.0);
    CHECK(lines.half_width.back().half_width_mm == 2.0);
    CHECK_FALSE(lines.closed);
}
