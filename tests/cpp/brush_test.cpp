#include "brushsvg/brush.hpp"

#include <doctest/doctest.h>

#include "brushsvg/simulate.hpp"
#include "refusal.hpp"
#include "round6.hpp"

using namespace brushsvg;

namespace {

std::optional<Error> refusal(const Brush& brush) {
    return ::refusal([&] { check(brush); });
}

}  // namespace

TEST_CASE("the shipped brushes are admissible") {
    CHECK(!refusal(shipped("round-6")));
    CHECK(!refusal(shipped("rigid")));
}

TEST_CASE("the article's printed coefficients make the lag negative and are refused") {
    Brush brush = shipped("round-6");
    brush.lag.coefficients.back() = 2.1e-4;
    CHECK(agrees(refusal(brush), "law-negative", "lag", {"-5.200", "10.00"}));
}

TEST_CASE("a lag that is negative at depths smaller than the least one is refused") {
    // The brush passes these depths when it is set down and lifted. Its patch would be ahead of the handle there.
    Brush brush = shipped("round-6");
    brush.depth_range_mm[0] = 2.0;
    brush.lag.coefficients = {-1.0, 1.0};
    CHECK(agrees(refusal(brush), "law-negative", "lag", {"-1.000", "0.00"}));
    Pass pass;
    pass.poses_mm.resize(3, 3);
    pass.poses_mm << 0, 0, -0.5, 20, 0, -0.5, 20, 20, -0.5;
    CHECK(agrees(refusal([&] { simulate(pass, brush); }), "out-of-range", "lag"));
    brush.lag.floor = 0.0;
    CHECK(!refusal(brush));
    CHECK(simulate(pass, brush).contact_mm.row(0).norm() == 0.0);
}

TEST_CASE("a lag that is zero is refused, except at depth 0 alone") {
    Brush brush = shipped("round-6");
    brush.lag.coefficients = {-3.0, 1.0};
    brush.lag.floor = 0.0;
    CHECK(agrees(refusal(brush), "law-zero", "lag"));
    brush.lag.coefficients = {0.0, 0.8};
    CHECK(!refusal(brush));
}

TEST_CASE("impossible numbers are refused with their range") {
    const auto changed = [](auto&& change, const char* name = "round-6") {
        Brush brush = shipped(name);
        change(brush);
        return refusal(brush);
    };
    CHECK(agrees(changed([](Brush& b) { b.depth_range_mm[1] = 1e300; }), "out-of-range", "depth_range_mm",
                 {"[0, 1000]"}));
    CHECK(agrees(changed([](Brush& b) { b.lag.coefficients = {1e30}; }), "out-of-range", "lag", {"1e+30"}));
    CHECK(agrees(changed([](Brush& b) { b.tip_gap.coefficients = {1e300}; }), "out-of-range", "tip_gap"));
    CHECK(agrees(changed([](Brush& b) { b.lag.calibrated_mm = {{20.0, 30.0}}; }), "out-of-range", "lag", {"[0, 10]"}));
    CHECK(agrees(changed([](Brush& b) { b.lag.calibrated_mm = {{9.0, 3.0}}; }), "out-of-range", "lag", {"[0, 10]"}));
    CHECK(agrees(changed([](Brush& b) { b.lag.rmse_mm = -1.0; }), "out-of-range", "lag", {"rmse_mm"}));
    CHECK(agrees(changed([](Brush& b) { b.name = ""; }), "name-invalid", "name"));
    CHECK(agrees(changed([](Brush& b) { b.name = "a\nb"; }), "name-invalid", "name"));
    CHECK(
        agrees(changed([](Brush& b) { b.max_speed_mm_s = 1e9; }), "out-of-range", "max_speed_mm_s", {"[0.01, 10000]"}));
    CHECK(agrees(changed([](Brush& b) { b.paint_depth_mm = 50.0; }), "out-of-range", "paint_depth_mm", {"50.00"}));
    CHECK(agrees(changed([](Brush& b) { b.paint_depth_mm = 0.0; }, "rigid"), "out-of-range", "paint_depth_mm", {"0"}));
    CHECK(agrees(changed([](Brush& b) { b.lag.coefficients = {0.0}; }), "pen-off-centre", "lag"));
    CHECK(agrees(changed([](Brush& b) { b.kind = "flat"; }), "choice-unknown", "kind"));
    CHECK(!changed([](Brush& b) { b.kind = ""; }));
}

TEST_CASE("an impossible covariance is refused") {
    Brush brush = shipped("round-6");
    std::size_t n = 0;
    for (const Profile* law : {&brush.lag, &brush.tip_gap, &brush.tip_to_widest, &brush.half_width})
        n += law->coefficients.size();
    std::vector<std::vector<double>> good(n, std::vector<double>(n, 0.0));
    good[0][0] = 0.04;
    good[1][1] = 0.01;
    good[0][1] = good[1][0] = -0.02 * (1.0 + 1e-6);  // fully correlated, up to a rounding to six digits
    const auto changed = [&](auto&& change) {
        brush.covariance = good;
        change(brush.covariance);
        return refusal(brush);
    };
    using Matrix = std::vector<std::vector<double>>;
    CHECK(!changed([](Matrix&) {}));
    CHECK(!changed([](Matrix& c) { c.clear(); }));
    CHECK(agrees(changed([](Matrix& c) { c[1][1] = -0.01; }), "covariance-invalid", "covariance[1][1]", {"-0.01"}));
    CHECK(agrees(changed([](Matrix& c) { c[0][1] = 0.01; }), "covariance-invalid", "covariance[1][0]",
                 {"-0.02", "0.01"}));
    CHECK(agrees(changed([](Matrix& c) { c[0][1] = c[1][0] = 0.03; }), "covariance-invalid", "covariance"));
    CHECK(agrees(changed([](Matrix& c) { c[2][0] = c[0][2] = 0.001; }), "covariance-invalid", "covariance"));
    CHECK(agrees(changed([](Matrix& c) { c[0][0] = 1e200; }), "out-of-range", "lag", {"1.96e+100"}));
    CHECK(agrees(changed([](Matrix& c) { c[0][0] = NAN; }), "not-finite", "covariance"));
    CHECK(agrees(changed([](Matrix& c) { c.pop_back(); }), "covariance-invalid", "covariance"));
    CHECK(agrees(changed([](Matrix& c) { c.assign(1, {1.0}); }), "covariance-invalid", "covariance"));
}

TEST_CASE("laws and outlines must agree to 0.5 mm, and shapes must be rings") {
    Brush brush = shipped("round-6");
    brush.half_width.coefficients[1] = 0.30;
    CHECK(agrees(refusal(brush), "footprint-against-law", "footprints.dragged[4]", {"0.5"}));
    brush = shipped("round-6");
    brush.tip_to_widest.coefficients[0] += 0.7;
    CHECK(agrees(refusal(brush), "footprint-against-law", "footprints.dragged[0]", {"tip_to_widest"}));
    brush = shipped("round-6");
    brush.footprints.dragged[3].outline_mm = brush.footprints.dragged[3].outline_mm.colwise().reverse().eval();
    CHECK(agrees(refusal(brush), "footprint-invalid", "footprints.dragged[3]"));
    brush = shipped("round-6");
    brush.footprints.dragged[3].outline_mm.row(20).swap(brush.footprints.dragged[3].outline_mm.row(40));
    CHECK(agrees(refusal(brush), "footprint-invalid", "footprints.dragged[3]"));
    brush = shipped("round-6");
    brush.half_width.coefficients = {6.0, -0.3};
    CHECK(agrees(refusal(brush), "width-falls", "half_width"));
}

TEST_CASE("width and depth are inverse, and a refusal names the reachable range") {
    const Brush brush = shipped("round-6");
    for (double h : {0.1, 0.42, 2.0, 4.2})
        CHECK(brush.half_width(brush.depth_for_half_width(h, "")) == doctest::Approx(h));
    const auto wide = ::refusal([&] { brush.depth_for_half_width(5.0, "p1"); });
    REQUIRE(agrees(wide, "width-out-of-reach", "p1", {"10.000", "[0.000, 8.400]", "0.84"}));
    CHECK(*wide->value() == doctest::Approx(10.0));
    CHECK(agrees(::refusal([&] { brush.depth_for_half_width(5.95, "p1"); }), "width-out-of-reach", "p1", {"0.7"}));
    CHECK(shipped("rigid").depth_for_half_width(7.0, "") == shipped("rigid").paint_depth_mm);
}

TEST_CASE("a brush with a width at depth 0 is pressed for its thinnest line") {
    const Brush liner = shipped("liner-1");  // 1 mm wide at depth 0
    double before = 0.0;
    for (double h : {0.5, 0.52, 0.55, 0.6, 1.0}) {
        const double depth = liner.depth_for_half_width(h, "");
        CHECK(depth > 0.1);
        CHECK(depth >= before);
        CHECK(std::abs(liner.half_width(depth) - h) < 0.05 + 1e-9);
        before = depth;
    }
    Brush even = liner;  // widens so little when pressed that all of its widths look alike
    even.half_width.coefficients = {0.5, 0.002};
    CHECK(even.depth_for_half_width(0.5, "") == doctest::Approx(5.0));
    Brush lifted = liner;  // its depth range begins above 0, so it is always pressed
    lifted.depth_range_mm = {1.0, 5.0};
    CHECK(lifted.depth_for_half_width(0.6, "") == doctest::Approx(1.0));
    CHECK(shipped("round-6").depth_for_half_width(1e-3, "") == doctest::Approx(1e-3 / 0.42));  // least width: 0
}

TEST_CASE("a steep half-width law with a floor can be inverted") {
    Brush brush = shipped("round-6");
    brush.half_width.coefficients = {0.0, 0.2, 0.022};
    const double d = brush.depth_for_half_width(1.5, "");
    CHECK(brush.half_width(d) == doctest::Approx(1.5));
}

TEST_CASE("unusual values of a brush are reported with their numbers") {
    const auto says = [](const Brush& brush, const char* code, const char* where,
                         const std::vector<std::string>& parts = {}) {
        for (const Warning& w : remarks(brush)) {
            bool all = w.code == code && w.where == where;
            for (const std::string& part : parts) all = all && stands_in(part, w.sentence);
            if (all) return true;
        }
        return false;
    };
    Brush brush = shipped("round-6");
    CHECK(!says(brush, "law-falls", "lag"));
    CHECK(!says(brush, "contact-outside-footprint", "tip_gap"));
    CHECK(!says(brush, "law-scatters", "tip_gap"));
    brush.lag.coefficients = {8.0, -0.4};
    CHECK(says(brush, "law-falls", "lag", {"4.00", "0.00", "10.00"}));
    brush.lag.coefficients = {1.0, 6.0, -3.0, 0.4};  // never below its value at depth 0
    CHECK(says(brush, "law-falls", "lag", {"2.24", "1.38", "3.62"}));
    brush.tip_gap.coefficients = {0.0, 1.1};
    CHECK(says(brush, "contact-outside-footprint", "tip_gap", {"1.00", "1.10"}));
    brush.tip_gap.rmse_mm = 4.0;
    CHECK(says(brush, "law-scatters", "tip_gap", {"4.00", "11.00"}));
}
