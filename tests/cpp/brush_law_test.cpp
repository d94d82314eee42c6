#include "brushsvg/brush_law.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "brushsvg/error.hpp"
#include "brushsvg/simulate.hpp"
#include "refusal.hpp"
#include "round6.hpp"

using namespace brushsvg;

TEST_CASE("a floor replaces the polynomial below it, and the pieces meet there") {
    Profile w;
    w.coefficients = {-2.35, 2.75, -0.42, 0.024};
    w.floor = 0.0;
    w.floor_slope = 0.126;
    const auto parts = pieces(w, 0.0, 10.0);
    REQUIRE(parts.size() == 2);
    CHECK(parts[0].coefficients == std::vector<double>{0.0, 0.126});
    const double joint = parts[0].hi;
    CHECK(std::abs(-2.35 + 2.75 * joint - 0.42 * joint * joint + 0.024 * joint * joint * joint - 0.126 * joint) <
          1e-12);
    for (double d = 0.0; d <= 10.0; d += 0.1) {
        const auto& part = d < joint ? parts[0] : parts[1];
        double y = 0.0;
        for (std::size_t i = part.coefficients.size(); i-- > 0;) y = y * d + part.coefficients[i];
        CHECK(std::abs(y - w(d)) < 1e-12);
    }
}

TEST_CASE("a law of a brush refuses depths that the brush cannot have") {
    Profile lag;
    lag.coefficients = {3.0, 1.0};
    CHECK(lag.at(50.0) == 53.0);  // a law without a brush accepts any depth
    lag.depth_range_mm = {1.0, 10.0};
    CHECK(lag.at(10.0 + 1e-9) == doctest::Approx(13.0));
    CHECK(lag.at(0.0) == 3.0);  // the brush passes this depth when it is set down
    CHECK(lag(50.0) == 53.0);   // not checked
    for (const double depth : {50.0, 10.1, -0.1, double(NAN)}) try {
            lag.at(depth);
            FAIL("it follows the polynomial to any depth");
        } catch (const Error& error) {
            CHECK(error.code() == "depth-out-of-range");
            CHECK((*error.range())[1] == 10.0);
        }
}

TEST_CASE("a law needs 1 to 11 coefficients in check and in simulate") {
    Pass pass;
    pass.poses_mm.resize(2, 3);
    pass.poses_mm << 0, 0, -1, 20, 0, -1;
    for (const std::size_t count : {std::size_t(0), std::size_t(12)}) {
        Brush brush = shipped("round-6");
        brush.lag.coefficients = std::vector<double>(count, 1e-3);
        const std::vector<std::string> parts{std::to_string(count), "[1, 11]"};
        CHECK(agrees(refusal([&] { check(brush); }), "law-terms", "lag", parts));
        CHECK(agrees(refusal([&] { simulate(pass, brush); }), "law-terms", "lag", parts));
    }
}

TEST_CASE("the difference of two laws is split where either changes") {
    Profile w, b;
    w.coefficients = {-2.35, 2.75, -0.42, 0.024};
    w.floor = 0.0;
    b.coefficients = {0.0, 0.52};
    const auto e = difference(w, b, 0.0, 10.0);
    REQUIRE(e.size() == 2);
    double crossing = 0.0;
    for (const auto& part : e)
        for (double root : real_roots(part.coefficients, part.lo, part.hi)) crossing = root;
    CHECK(crossing == doctest::Approx(1.39).epsilon(0.005));  // below this depth the widest section trails the contact
}

TEST_CASE("real roots: none, a pair inside one interval, a double root, the ends") {
    CHECK(real_roots({1.0, 0.0, 1.0}, -5.0, 5.0).empty());
    const auto pair = real_roots({0.2499, -1.0, 1.0}, 0.0, 1.0);  // 0.49, 0.51
    REQUIRE(pair.size() == 2);
    CHECK(pair[0] == doctest::Approx(0.49).epsilon(1e-10));
    CHECK(pair[1] == doctest::Approx(0.51).epsilon(1e-10));
    CHECK(real_roots({0.0, 1.0}, 0.0, 1.0) == std::vector<double>{0.0});
    CHECK(real_roots({-1.0, 1.0}, 0.0, 1.0) == std::vector<double>{1.0});
    CHECK(real_roots({3.0}, 0.0, 1.0).empty());
}
