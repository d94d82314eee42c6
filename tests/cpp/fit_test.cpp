#include <doctest/doctest.h>

#include <cmath>

#include "brushsvg/error.hpp"
#include "law_fit.hpp"
#include "refusal.hpp"

using namespace brushsvg;
using namespace brushsvg::fit;

TEST_CASE("exact data give back their law") {
    const std::vector<double> law{3.1, 0.86, 0.31, -0.05, 0.0021};
    std::vector<double> depth, value;
    for (int i = 0; i < 40; ++i) {
        const double d = 0.25 * (i + 1);
        depth.push_back(d);
        value.push_back(law[0] + d * (law[1] + d * (law[2] + d * (law[3] + d * law[4]))));
    }
    for (const Norm norm : {Norm::squares, Norm::absolute}) {
        LawShape shape;
        shape.degree = 4;
        shape.positive = true;
        shape.norm = norm;
        const LawFit fit = fit_law(depth, value, shape);
        for (int i = 0; i < 5; ++i) CHECK(fit.law.coefficients[i] == doctest::Approx(law[i]).epsilon(1e-6));
        CHECK(fit.r_squared == doctest::Approx(1.0));
        CHECK(!fit.held);
    }
}

TEST_CASE("a range of depths too short for its powers is refused") {
    LawShape shape;
    shape.degree = 3;
    shape.rising = true;
    shape.range_mm = {0.0, 5e-324};
    CHECK_THROWS_AS(fit_law({1, 2, 3, 4, 5}, {1, 1, 2, 1, 3}, shape), Error);
}

TEST_CASE("a degree that no law can have is refused with the greatest degree") {
    std::vector<double> depth, value;
    for (int i = 0; i < 20; ++i) {
        depth.push_back(i);
        value.push_back(1.0 + i);
    }
    LawShape shape;
    shape.range_mm = {0.0, 20.0};
    shape.degree = 11;
    CHECK(agrees(refusal([&] { fit_law(depth, value, shape); }), "law-terms", "degree", {"11", "[0, 10]"}));
}

TEST_CASE("a line through zero agrees with a manual calculation") {
    LawShape shape;
    shape.through_zero = true;
    const LawFit fit = fit_law({1, 2, 3}, {1, 1, 2}, shape);  // sum d v / sum d^2 = 9 / 14
    CHECK(fit.law.coefficients[1] == doctest::Approx(9.0 / 14.0));
    const double squares = 6.0 - 81.0 / 14.0;
    CHECK(*fit.law.rmse_mm == doctest::Approx(std::sqrt(squares / 2.0)));
    CHECK(fit.covariance[1][1] == doctest::Approx(squares / 2.0 / 14.0));
    CHECK(fit.law.half_interval_95[1] == doctest::Approx(4.30265 * std::sqrt(squares / 28.0)).epsilon(1e-5));
}

TEST_CASE("values are weighted by their scatter in any unit, as calculated manually") {
    LawShape shape;
    shape.through_zero = true;
    for (const double unit : {1.0, 1e-3}) {  // sum d v / s^2 over sum d^2 / s^2
        const LawFit fit = fit_law({1, 2, 4}, {1, 1, 6}, shape, {unit, 2 * unit, 4 * unit});
        CHECK(fit.law.coefficients[1] == doctest::Approx((1.0 + 0.5 + 1.5) / 3.0));
        const double squares = 0.0 + 0.25 + 0.25;  // sum of the squared residuals over their scatter
        CHECK(fit.covariance[1][1] == doctest::Approx(squares / 2.0 / 3.0));
        CHECK(*fit.law.rmse_mm == doctest::Approx(std::sqrt((0.0 + 1.0 + 4.0) / 2.0)));
    }
    CHECK_THROWS_AS(fit_law({1, 2, 4}, {1, 1, 6}, shape, {1, 2}), Error);
    CHECK_THROWS_AS(fit_law({1, 2, 4}, {1, 1, 6}, shape, {1, 2, 0}), Error);
}

TEST_CASE("one depth does not determine a slope") {
    LawShape shape;
    const auto told = refusal([&] { fit_law({3, 3, 3}, {1, 2, 3}, shape); });
    REQUIRE(agrees(told, "depths-too-few", "", {"1", "2"}));
    CHECK(*told->value() == 1.0);
}
