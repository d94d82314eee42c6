#include "brushsvg/stroke.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "brushsvg/error.hpp"
#include "refusal.hpp"
#include "round6.hpp"

using namespace brushsvg;
using V = Eigen::Vector2d;

namespace {

constexpr double kPi = 3.14159265358979323846;

Stroke quarter(double radius) {
    const double k = 0.5522847498307936 * radius;
    Stroke s;
    s.id = "q";
    s.middle_mm.resize(1, 8);
    s.middle_mm << radius, 0, radius, k, k, radius, 0, radius;
    s.half_width = {{0.0, 1.0}, {1.0, 2.0}};
    return s;
}

}  // namespace

TEST_CASE("points, tangents and lengths of a quarter circle are exact") {
    const Stroke s = quarter(10.0);
    CHECK((point_at(s.middle_mm, {0, 0.5}) - 10.0 * V(std::sqrt(0.5), std::sqrt(0.5))).norm() < 1e-9);
    CHECK((tangent_at(s.middle_mm, {0, 0.0}) - V(0, 1)).norm() < 1e-12);
    CHECK(arc_length(s.middle_mm, 0, 0.0, 1.0) == doctest::Approx(5 * kPi).epsilon(3e-4));
    CHECK(arc_length(s.middle_mm, 0, 0.0, 0.3) + arc_length(s.middle_mm, 0, 0.3, 1.0) ==
          doctest::Approx(arc_length(s.middle_mm, 0, 0.0, 1.0)).epsilon(1e-9));
}

TEST_CASE("the parameter at a length reaches that length, and never less") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(0.0, 1.0);
    for (int trial = 0; trial < 300; ++trial) {
        CAPTURE(trial);
        Cubics c(1, 8);
        for (int k = 0; k < 8; ++k) c(0, k) = 20.0 * any(random);
        if (trial % 5 == 0) c.leftCols(2) = c.middleCols(2, 2);  // a handle of zero length
        if (trial % 7 == 0) c << 0, 0, 10, 10, 0, 10, 10, 0;     // a cusp
        const double whole = arc_length(c, 0, 0.0, 1.0), length = any(random) * whole;
        const double t = parameter_at(c, 0, length);
        CHECK(arc_length(c, 0, 0.0, t) >= length);
        CHECK(arc_length(c, 0, 0.0, t - 1e-14) < length);
    }
    const Cubics c = quarter(10.0).middle_mm;
    CHECK(parameter_at(c, 0, -1.0) == 0.0);
    CHECK(parameter_at(c, 0, 100.0) == 1.0);
    CHECK(parameter_at(Cubics::Ones(1, 8), 0, 0.0) == 0.0);
}

TEST_CASE("a tangent where the handle has no length is the limit from inside") {
    Cubics c(1, 8);
    c << 0, 0, 0, 0, 3, 4, 6, 8;
    CHECK((tangent_at(c, {0, 0.0}) - V(0.6, 0.8)).norm() < 1e-6);
    c << 1, 1, 1, 1, 1, 1, 1, 1;
    CHECK(tangent_at(c, {0, 0.5}).norm() == 0.0);
}

TEST_CASE("flatten stays within its tolerance and keeps length and width") {
    const Stroke s = quarter(10.0);
    for (double tolerance : {0.1, 1e-3}) {
        const MiddlePolyline line = flatten(s, tolerance);
        for (int k = 0; k <= 1000; ++k) {
            const V p = point_at(s.middle_mm, {0, k / 1000.0});
            double best = 1e9;
            for (Eigen::Index i = 0; i + 1 < line.rows(); ++i) {
                const V a = line.row(i).head<2>(), d = line.row(i + 1).head<2>().transpose() - a;
                const double t = std::min(1.0, std::max(0.0, (p - a).dot(d) / d.squaredNorm()));
                best = std::min(best, (p - a - t * d).norm());
            }
            CHECK(best <= tolerance);
        }
        CHECK(line(0, 3) == doctest::Approx(1.0));
        CHECK(line(line.rows() - 1, 3) == doctest::Approx(2.0));
        CHECK(line(line.rows() - 1, 2) == doctest::Approx(arc_length(s.middle_mm, 0, 0, 1)));
    }
}

TEST_CASE("the width is linear between the rows of a flattened line, also along a straight one") {
    Stroke s;
    s.middle_mm.resize(1, 8);
    s.middle_mm << 0, 0, 2, 0, 4, 0, 6, 0;
    s.half_width = {{0.0, 0.0}, {0.5, 2.0}, {1.0, 2.0}};
    const MiddlePolyline line = flatten(s, 0.01);
    REQUIRE(line.rows() == 3);
    CHECK(line(1, 0) == doctest::Approx(3.0));
    CHECK(line(1, 2) == doctest::Approx(3.0));
    CHECK(line(1, 3) == doctest::Approx(2.0));
}

TEST_CASE("a stroke without line or width, or with a bad number, is refused") {
    Stroke s;
    s.id = "x";
    CHECK_THROWS_AS(check(s), Error);
    s.middle_mm = polyline({V(0, 0), V(NAN, 0)});
    s.half_width = {{0.0, 1.0}};
    CHECK_THROWS_AS(check(s), Error);
    s.middle_mm = polyline({V(0, 0), V(1, 0)});
    s.half_width = {{0.5, 1.0}, {0.2, 1.0}};
    CHECK_THROWS_AS(check(s), Error);
    s.half_width = {{2e6, 1.0}};
    CHECK(agrees(refusal([&] { check(s); }), "out-of-range", "x", {"place"}));
}
