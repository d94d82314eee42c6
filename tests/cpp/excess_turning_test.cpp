#include "brushsvg/excess_turning.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace brushsvg;

namespace {

/// Return a disc of radius 10 mm with a number of waves along its edge.
Ring wavy(double height_mm, int waves, int points = 720) {
    Ring ring(points, 2);
    for (int i = 0; i < points; ++i) {
        const double angle = 2.0 * 3.14159265358979324 * i / points, r = 10.0 + height_mm * std::sin(waves * angle);
        ring.row(i) << r * std::cos(angle), r * std::sin(angle);
    }
    return ring;
}

Ring corners(std::initializer_list<std::array<double, 2>> places) {
    Ring ring(Eigen::Index(places.size()), 2);
    Eigen::Index i = 0;
    for (const auto& [x, y] : places) ring.row(i++) << x, y;
    return ring;
}

}  // namespace

TEST_CASE("convex outlines turn once, however many corners they have") {
    const Rings disc{wavy(0.0, 0)}, coarse{wavy(0.0, 0, 60)}, square{corners({{0, 0}, {10, 0}, {10, 10}, {0, 10}})};
    CHECK(excess_turning(disc, square) == doctest::Approx(0.0).epsilon(1e-9));
    CHECK(excess_turning(coarse, disc) == doctest::Approx(0.0).epsilon(1e-9));
    CHECK(excess_turning({}, {}) == 0.0);
}

TEST_CASE("a thorn turns there and back, each wave as well, and details finer than 0.1 do not count") {
    const Rings square{corners({{0, 0}, {10, 0}, {10, 10}, {0, 10}})};
    const Rings thorn{corners({{0, 0}, {10, 0}, {10, 10}, {5.5, 10}, {5, 12}, {4.5, 10}, {0, 10}})};
    const double beside = std::atan2(2.0, 0.5), peak = 3.14159265358979324 - 2.0 * beside;
    const double all =
        (4.0 * 3.14159265358979324 / 2.0 + 2.0 * beside + std::abs(3.14159265358979324 - std::abs(peak)));
    CHECK(excess_turning(thorn, square) == doctest::Approx(all / (2.0 * 3.14159265358979324) - 1.0).epsilon(1e-6));
    CHECK(excess_turning({wavy(0.5, 20)}, {wavy(0.0, 0)}) > 2.0);
    CHECK(std::abs(excess_turning({wavy(0.04, 40)}, {wavy(0.0, 0)})) < 0.01);
}

TEST_CASE("a hole counts like an outline") {
    Ring hole = wavy(0.0, 0);
    hole = hole.colwise().reverse().eval() / 2.0;
    CHECK(excess_turning({wavy(0.0, 0), hole}, {wavy(0.0, 0)}) == doctest::Approx(1.0).epsilon(1e-9));
}

TEST_CASE("a pinhole below a hundredth of a square millimetre does not count, a larger one does") {
    const auto slit = [](double width_mm) { return corners({{0, 0}, {0, 0.2}, {width_mm, 0.2}, {width_mm, 0}}); };
    const Rings disc{wavy(0.0, 0)};
    CHECK(excess_turning({disc[0], slit(0.045)}, disc) == 0.0);
    CHECK(excess_turning({disc[0], slit(0.2)}, disc) == doctest::Approx(1.0).epsilon(1e-9));
    Ring curl(4, 2);  // not straight, so that no tolerance reduces it to a line
    curl << 0, 0, 0, 0.3, 0.02, 0.02, 0.3, 0;
    CHECK(std::abs(signed_area(curl)) < 0.01);
    CHECK(excess_turning({disc[0], curl}, disc) == 0.0);
}

TEST_CASE("thorns are sharp, point outwards and stick out of the target, or into a hole of it") {
    const auto square_with = [](double peak) {
        return Rings{corners({{0, 0}, {10, 0}, {10, 10}, {5.5, 10}, {5, 10 + peak}, {4.5, 10}, {0, 10}})};
    };
    const Rings square{corners({{0, 0}, {10, 0}, {10, 10}, {0, 10}})};
    CHECK(thorns(square_with(2.0), square) == 1);
    CHECK(thorns(square_with(0.29), square) == 0);
    CHECK(thorns(square_with(0.31), square) == 1);
    CHECK(thorns(square_with(-2.0), square) == 0);  // a notch, not a thorn
    CHECK(thorns(square_with(2.0), square_with(2.0)) == 0);
    CHECK(thorns(square, {corners({{1, 1}, {9, 1}, {9, 9}, {1, 9}})}) == 4);
    CHECK(thorns(square, {}) == 4);
    CHECK(thorns({}, square) == 0);
    CHECK(thorns({wavy(0.0, 0)}, {wavy(0.0, 0) / 2.0}) == 0);  // a curve turns by less at each corner
    // a bar from the left that ends within a hole
    const Rings ring{corners({{0, 0}, {10, 0}, {10, 10}, {0, 10}}), corners({{2, 2}, {2, 8}, {8, 8}, {8, 2}})};
    CHECK(thorns({corners({{0, 4}, {5, 4}, {5, 6}, {0, 6}})}, ring) == 2);
}
