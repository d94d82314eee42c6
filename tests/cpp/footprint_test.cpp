#include "brushsvg/footprint.hpp"

#include <doctest/doctest.h>

using namespace brushsvg;

namespace {

Ring diamond(double length, double half) {
    Ring r(4, 2);
    r << 0, 0, length / 2, -half, length, 0, length / 2, half;
    return r;
}

}  // namespace

TEST_CASE("outlines blend vertex by vertex, scale below the least depth, and stay constant above the greatest") {
    const FootprintTable table{{{1.0, diamond(2, 1)}, {3.0, diamond(6, 2)}}, {}};
    CHECK((footprint_at(table, 2.0, 1.0) - diamond(4, 1.5)).norm() < 1e-12);
    CHECK((footprint_at(table, 0.5, 1.0) - diamond(1, 0.5)).norm() < 1e-12);
    CHECK((footprint_at(table, 9.0, 1.0) - diamond(6, 2)).norm() < 1e-12);
    CHECK(footprint_at(table, 0.0, 1.0).norm() == 0.0);
}

TEST_CASE("the pull blends pressed and dragged footprints, each at its own depths") {
    const FootprintTable table{{{1.0, diamond(2, 1)}, {3.0, diamond(6, 2)}}, {{2.0, diamond(8, 4)}}};
    CHECK((footprint_at(table, 2.0, 0.25) - (0.75 * diamond(8, 4) + 0.25 * diamond(4, 1.5))).norm() < 1e-12);
    CHECK((footprint_at(table, 2.0, 1.0) - diamond(4, 1.5)).norm() < 1e-12);
}

TEST_CASE("the widest section and the convexity of a footprint are found") {
    const WidestSection w = widest_section(diamond(6, 2));
    CHECK(w.from_tip_mm == doctest::Approx(3.0));
    CHECK(w.half_width_mm == doctest::Approx(2.0));
    CHECK(is_convex(diamond(6, 2)));
    Ring crescent(6, 2);
    crescent << 0, 0, 4, -3, 6, -1, 3, 0, 6, 1, 4, 3;
    CHECK_FALSE(is_convex(crescent));
}
