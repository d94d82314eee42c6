#include "brushsvg/brush.hpp"

#include <doctest/doctest.h>

#include "refusal.hpp"
#include "round6.hpp"

using namespace brushsvg;

namespace {

std::string refusal(const Brush& brush) {
    return ::refusal([&] { check(brush); });
}

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

TEST_CASE("numbers that no brush has are refused with their range") {
    const auto changed = [](auto&& change, const char* name = "round-6") {
        Brush brush = shipped(name);
        change(brush);
        return refusal(brush);
    };
    CHECK(contains(changed([](Brush& b) { b.depth_range_mm[1] = 1e300; }), "must rise within [0, 1000] mm"));
    CHECK(contains(changed([](Brush& b) { b.lag.coefficients = {1e30}; }), "lag: the law says 1e+30 mm"));
    CHECK(contains(changed([](Brush& b) { b.tip_gap.coefficients = {1e300}; }), "tip_gap: the law says"));
    CHECK(contains(changed([](Brush& b) { b.lag.calibrated_mm = {{20.0, 30.0}}; }), "must rise and meet"));
    CHECK(contains(changed([](Brush& b) { b.lag.calibrated_mm = {{9.0, 3.0}}; }), "must rise and meet"));
    CHECK(contains(changed([](Brush& b) { b.lag.rmse_mm = -1.0; }), "lag: an interval or rmse_mm is negative"));
    CHECK(contains(changed([](Brush& b) { b.name = ""; }), "name: the name must be one line"));
    CHECK(contains(changed([](Brush& b) { b.name = "a\nb"; }), "name: the name must be one line"));
    CHECK(contains(changed([](Brush& b) { b.max_speed_mm_s = 1e9; }), "[0.01, 10000] mm/s"));
    CHECK(contains(changed([](Brush& b) { b.paint_depth_mm = 50.0; }), "painting depth 50.00 mm is outside"));
    CHECK(contains(changed([](Brush& b) { b.paint_depth_mm = 0.0; }, "rigid"), "must be greater than 0"));
    CHECK(contains(changed([](Brush& b) { b.lag.coefficients = {0.0}; }), "the mark has no heading"));
}

TEST_CASE("a covariance that nothing can have is refused") {
    Brush brush = shipped("round-6");
    std::size_t n = 0;
    for (const Profile* law : {&brush.lag, &brush.tip_gap, &brush.tip_to_widest, &brush.half_width})
        n += law->coefficients.size();
    std::vector<std::vector<double>> good(n, std::vector<double>(n, 0.0));
    good[0][0] = 0.04;
    good[1][1] = 0.01;
    good[0][1] = good[1][0] = -0.02 * (1.0 + 1e-6);  // wholly correlated, as six digits leave it
    const auto changed = [&](auto&& change) {
        brush.covariance = good;
        change(brush.covariance);
        return refusal(brush);
    };
    using Matrix = std::vector<std::vector<double>>;
    CHECK(changed([](Matrix&) {}) == "");
    CHECK(changed([](Matrix& c) { c.clear(); }) == "");
    CHECK(contains(changed([](Matrix& c) { c[1][1] = -0.01; }), "covariance[1][1]: the variance -0.01 must not"));
    CHECK(contains(changed([](Matrix& c) { c[0][1] = 0.01; }), "covariance[1][0]: -0.02 differs from 0.01"));
    CHECK(contains(changed([](Matrix& c) { c[0][1] = c[1][0] = 0.03; }), "covariance: some sum of the coefficients"));
    CHECK(contains(changed([](Matrix& c) { c[2][0] = c[0][2] = 0.001; }), "covariance: some sum of the coefficients"));
    CHECK(contains(changed([](Matrix& c) { c[0][0] = 1e200; }),
                   "lag: by the covariance the law is known to +- 1.96e+100"));
    CHECK(contains(changed([](Matrix& c) { c[0][0] = NAN; }), "covariance: a number is not finite"));
    CHECK(contains(changed([](Matrix& c) { c.pop_back(); }), "covariance"));
    CHECK(contains(changed([](Matrix& c) { c.assign(1, {1.0}); }), "covariance must have one row per coefficient"));
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

TEST_CASE("a brush with a width at depth 0 presses for its thinnest line") {
    const Brush liner = shipped("liner-1");  // 1 mm wide at depth 0
    double before = 0.0;
    for (double h : {0.5, 0.52, 0.55, 0.6, 1.0}) {
        const double depth = liner.depth_for_half_width(h, "");
        CHECK(depth > 0.1);
        CHECK(depth >= before);
        CHECK(std::abs(liner.half_width(depth) - h) < 0.05 + 1e-9);
        before = depth;
    }
    Brush even = liner;  // so little wider when pressed that all of its widths are alike to the eye
    even.half_width.coefficients = {0.5, 0.002};
    CHECK(even.depth_for_half_width(0.5, "") == doctest::Approx(5.0));
    Brush lifted = liner;  // its range begins above 0: pressed already
    lifted.depth_range_mm = {1.0, 5.0};
    CHECK(lifted.depth_for_half_width(0.6, "") == doctest::Approx(1.0));
    CHECK(shipped("round-6").depth_for_half_width(1e-3, "") == doctest::Approx(1e-3 / 0.42));  // its widths begin at 0
}

TEST_CASE("a steeper half-width law with a floor inverts too") {
    Brush brush = shipped("round-6");
    brush.half_width.coefficients = {0.0, 0.2, 0.022};
    const double d = brush.depth_for_half_width(1.5, "");
    CHECK(brush.half_width(d) == doctest::Approx(1.5));
}

TEST_CASE("what is odd about a brush is said in words") {
    const auto says = [](const Brush& brush, const char* where, const char* words) {
        for (const Warning& w : remarks(brush))
            if (w.where == where && w.sentence.find(words) != std::string::npos) return true;
        return false;
    };
    Brush brush = shipped("round-6");
    CHECK(!says(brush, "lag", "falls"));
    CHECK(!says(brush, "tip_gap", "beyond the footprint"));
    CHECK(!says(brush, "tip_gap", "scatters"));
    brush.lag.coefficients = {8.0, -0.4};
    CHECK(says(brush, "lag", "falls by 4.00 mm from depth 0.00 to 10.00 mm"));
    brush.lag.coefficients = {1.0, 6.0, -3.0, 0.4};  // never below where it begins
    CHECK(says(brush, "lag", "falls by 2.24 mm from depth 1.38 to 3.62 mm"));
    brush.tip_gap.coefficients = {0.0, 1.1};
    CHECK(says(brush, "tip_gap", "at depth 1.00 mm the centre of friction lies 1.10 mm from the tip"));
    brush.tip_gap.rmse_mm = 4.0;
    CHECK(says(brush, "tip_gap", "scatters by 4.00 mm about a law of at most 11.00 mm"));
}
