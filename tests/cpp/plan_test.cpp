#include "brushsvg/plan.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "brushsvg/error.hpp"

using namespace brushsvg;

namespace {

constexpr double kPi = 3.14159265358979323846;

/// Return a pass with poses at these angles about (100, 50), and one arc through all of them.
Pass on_circle(double radius, const std::vector<double>& angles, int direction, double digits_mm = 0.0) {
    Pass pass;
    pass.stroke = "s";
    pass.poses_mm.resize(Eigen::Index(angles.size()), 3);
    const auto rounded = [&](double x) { return digits_mm > 0.0 ? std::round(x / digits_mm) * digits_mm : x; };
    for (std::size_t i = 0; i < angles.size(); ++i)
        pass.poses_mm.row(Eigen::Index(i)) << rounded(100.0 + radius * std::cos(angles[i])),
            rounded(50.0 + radius * std::sin(angles[i])), -2.0;
    pass.arcs = {{0, std::int64_t(angles.size()) - 1, {100.0, 50.0}, direction}};
    return pass;
}

}  // namespace

TEST_CASE("an arc of any radius in the range and with several turns is accepted, also rounded to three decimals") {
    for (double radius : {0.11, 1.0, 9.0, 1000.0, 9e5})
        for (int direction : {1, -1}) {
            std::vector<double> angles;
            for (int i = 0; i < 60; ++i) angles.push_back(direction * 0.3 * i);
            CHECK_NOTHROW(check_arc(on_circle(radius, angles, direction), 0, ""));
            CHECK_NOTHROW(check_arc(on_circle(radius, angles, direction, 1e-3), 0, ""));
            CHECK_THROWS_AS(check_arc(on_circle(radius, angles, -direction), 0, ""), Error);
        }
}

TEST_CASE("neighbours on an arc are at most half a turn apart, and never in reverse") {
    CHECK_NOTHROW(check_arc(on_circle(9.0, {0.0, 0.999 * kPi}, 1), 0, ""));
    CHECK_THROWS_AS(check_arc(on_circle(9.0, {0.0, kPi}, 1), 0, ""), Error);
    CHECK_THROWS_AS(check_arc(on_circle(9.0, {0.0, 1.001 * kPi}, 1), 0, ""), Error);
    CHECK_THROWS_AS(check_arc(on_circle(9.0, {0.0, 1.0, 0.999}, 1), 0, ""), Error);
    CHECK_THROWS_AS(check_arc(on_circle(9.0, {0.0, 1.0, 1.0}, 1), 0, ""), Error);
}

TEST_CASE("poses that are not finite or not on the circle are refused") {
    for (double bad : {double(NAN), double(INFINITY)}) {
        Pass pass = on_circle(9.0, {0.0, 1.0, 2.0}, 1);
        pass.arcs[0].centre_mm.x() = bad;
        CHECK_THROWS_AS(check_arc(pass, 0, ""), Error);
        for (int k = 0; k < 3; ++k) {
            pass = on_circle(9.0, {0.0, 1.0, 2.0}, 1);
            pass.poses_mm(1, k) = bad;
            CHECK_THROWS_AS(check_arc(pass, 0, ""), Error);
        }
    }
}

TEST_CASE("tool axes: one for each pose, of length 1, tilted by at most 30 degrees, without arcs") {
    Pass pass;
    pass.stroke = "s";
    pass.poses_mm = Poses::Zero(2, 3);
    CHECK_NOTHROW(check_tool_axes(pass, ""));
    pass.tool_axes.resize(2, 3);
    pass.tool_axes << 0.0, 0.0, 1.0, 0.5, 0.0, std::sqrt(0.75) + 1e-9;
    CHECK_NOTHROW(check_tool_axes(pass, ""));
    pass.tool_axes.row(1) << 0.18, 0.467, 0.866;  // 30 degrees, rounded to three decimals
    CHECK_NOTHROW(check_tool_axes(pass, ""));
    CHECK(is_tilted(pass));
    CHECK_THROWS_AS(refuse_tilted(pass, "a test holds it upright"), Error);
    pass.arcs = {{0, 1, {1.0, 0.0}, 1}};
    CHECK_THROWS_AS(check_tool_axes(pass, ""), Error);
    pass.arcs.clear();
    for (const auto& [x, z] : {std::pair(0.51, std::sqrt(1.0 - 0.51 * 0.51)), {0.0, -1.0}, {0.0, 1.002}, {NAN, 1.0}}) {
        pass.tool_axes.row(1) << x, 0.0, z;
        CHECK_THROWS_AS(check_tool_axes(pass, ""), Error);
    }
    pass.tool_axes.row(1) << 0.0, 0.0, 1.0;
    CHECK_FALSE(is_tilted(pass));
    CHECK_NOTHROW(refuse_tilted(pass, "a test holds it upright"));
    pass.tool_axes.conservativeResize(1, 3);
    CHECK_THROWS_AS(check_tool_axes(pass, ""), Error);
}
