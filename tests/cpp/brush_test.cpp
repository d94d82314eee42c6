#include "brushsvg/brush.hpp"

#include <doctest/doctest.h>

#include "round6.hpp"

using namespace brushsvg;

namespace {

std::string refusal(const Brush& brush) {
    try {
        check(brush);
    } catch (const Error& e) {
        return e.where() + ": " + e.what();
    }
    return "";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("the shipped brushes are admissible") {
    CHECK(refusal(shipped("round-6")) == "");
    CHECK(refusal(shipped("rigid")) == "");
}

TEST_CASE("the article's printed coefficients make the lag negative and are refused") {
    Brush brush = shipped("round-6");
    brush.lag.coefficients.back() = 2.1e-4;
    const std::string why = refusal(brush);
    CHECK(contains(why, "lag: "));
    CHECK(contains(why, "-5.200 mm at depth 10.00"));
    CHECK(contains(why, "must not be negative"));
}

TEST_CASE("lag zero in part is refused, at depth 0 alone it is not") {
    Brush brush = shipped("round-6");
    brush.lag.coefficients = {-3.0, 1.0};
    brush.lag.floor = 0.0;
    CHECK(contains(refusal(brush), "zero"));
    brush.lag.coefficients = {0.0, 0.8};
    CHECK(refusal(brush) == "");
}

TEST_CASE("laws and outlines must agree to half a millimetre, and shapes must be rings") {
    Brush brush = shipped("round-6");
    brush.half_width.coefficients[1] = 0.30;
    CHECK(contains(refusal(brush), "must agree to 0.5 mm"));
    brush = shipped("round-6");
    brush.tip_to_widest.coefficients[0] += 0.7;
    CHECK(contains(refusal(brush), "tip_to_widest"));
    brush = shipped("round-6");
    brush.footprints.dragged[3].outline_mm = brush.footprints.dragged[3].outline_mm.colwise().reverse().eval();
    CHECK(refusal(brush) != "");
    brush = shipped("round-6");
    brush.footprints.dragged[3].outline_mm.row(20).swap(brush.footprints.dragged[3].outline_mm.row(40));
    CHECK(contains(refusal(brush), "crosses itself"));
    brush = shipped("round-6");
    brush.half_width.coefficients = {6.0, -0.3};
    CHECK(contains(refusal(brush), "must not fall"));
}

TEST_CASE("width to depth and back, and the refusal names the reachable range") {
    const Brush brush = shipped("round-6");
    for (double h : {0.1, 0.42, 2.0, 4.2})
        CHECK(brush.half_width(brush.depth_for_half_width(h, "")) == doctest::Approx(h));
    try {
        brush.depth_for_half_width(5.0, "p1");
        FAIL("a width out of reach was accepted");
    } catch (const Error& e) {
        CHECK(e.where() == "p1");
        CHECK(contains(e.what(), "width 10.000 mm is outside the range [0.000, 8.400] mm"));
        CHECK(*e.value() == doctest::Approx(10.0));
    }
    CHECK(shipped("rigid").depth_for_half_width(7.0, "") == shipped("rigid").paint_depth_mm);
}

TEST_CASE("a steeper half-width law with a floor inverts too") {
    Brush brush = shipped("round-6");
    brush.half_width.coefficients = {0.0, 0.2, 0.022};
    const double d = brush.depth_for_half_width(1.5, "");
    CHECK(brush.half_width(d) == doctest::Approx(1.5));
}
