#include "brushsvg/ring.hpp"

#include <doctest/doctest.h>

using namespace brushsvg;

TEST_CASE("the signed area of a triangle is correct in both directions and far from the origin") {
    Ring r(3, 2);
    r << 0, 0, 4, 0, 0, 3;
    CHECK(signed_area(r) == doctest::Approx(6.0));
    Ring reversed = r.colwise().reverse();
    CHECK(signed_area(reversed) == doctest::Approx(-6.0));
    r.array() += 1e7;
    CHECK(signed_area(r) == doctest::Approx(6.0));
    CHECK(signed_area(Ring(0, 2)) == 0.0);
}

TEST_CASE("the length around a triangle is its perimeter, and 0 for no point or one") {
    Ring r(3, 2);
    r << 0, 0, 4, 0, 0, 3;
    CHECK(length_around(r) == doctest::Approx(12.0));
    CHECK(length_around(Ring(0, 2)) == 0.0);
    CHECK(length_around(r.topRows(1)) == 0.0);
}
