#include "marks/coverage_contours.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace brushsvg;

namespace {

constexpr Window kWindow{-5.0, 3.0, 20.0, 12.0};
constexpr double kPxPerMm = 4.0;

Rings back(const Rings& rings) { return trace_half_coverage(coverage(rings, kWindow, kPxPerMm), kWindow, kPxPerMm); }

Ring box(double left, double bottom, double right, double top) {
    Ring ring(4, 2);
    ring << left, bottom, right, bottom, right, top, left, top;
    return ring;
}

}  // namespace

TEST_CASE("the rings of a picture are the drawn rings, except for half a pixel at corners") {
    const Rings found = back({box(0.0, 5.0, 6.0, 9.0)});
    REQUIRE(found.size() == 1);
    CHECK(signed_area(found[0]) == doctest::Approx(24.0).epsilon(0.01));  // positive: counter-clockwise
    CHECK(found[0].col(0).minCoeff() == doctest::Approx(0.0).epsilon(1e-6));
    CHECK(found[0].col(1).maxCoeff() == doctest::Approx(9.0).epsilon(1e-6));
}

TEST_CASE("holes run clockwise, and rings that leave the window end at its edge") {
    Ring hole = box(1.0, 6.0, 3.0, 8.0).colwise().reverse();
    Rings found = back({box(-9.0, 5.0, 6.0, 9.0), hole});
    REQUIRE(found.size() == 2);
    std::sort(found.begin(), found.end(), [](const Ring& a, const Ring& b) { return signed_area(a) < signed_area(b); });
    CHECK(signed_area(found[0]) == doctest::Approx(-4.0).epsilon(0.05));
    CHECK(signed_area(found[1]) == doctest::Approx(44.0).epsilon(0.02));
    CHECK(found[1].col(0).minCoeff() == doctest::Approx(-5.0).epsilon(0.01));
}

TEST_CASE("pixels that touch at a corner are separate, and an empty picture has no rings") {
    Coverage picture = Coverage::Zero(4, 4);
    picture(1, 1) = picture(2, 2) = 1.0f;
    CHECK(trace_half_coverage(picture, {0.0, 0.0, 4.0, 4.0}, 1.0).size() == 2);
    picture(1, 2) = 0.4f;  // then the point between the four pixels counts as painted
    CHECK(trace_half_coverage(picture, {0.0, 0.0, 4.0, 4.0}, 1.0).size() == 1);
    CHECK(trace_half_coverage(Coverage::Zero(3, 3), {0.0, 0.0, 3.0, 3.0}, 1.0).empty());
}
