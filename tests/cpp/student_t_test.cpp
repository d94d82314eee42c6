#include "brushsvg/student_t.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using brushsvg::interval_factor_95;
using brushsvg::normal_equivalent;

TEST_CASE("half of a 95 % interval agrees with printed tables") {
    CHECK(interval_factor_95(1.0) == doctest::Approx(12.706).epsilon(1e-4));
    CHECK(interval_factor_95(2.0) == doctest::Approx(4.303).epsilon(1e-4));
    CHECK(interval_factor_95(10.0) == doctest::Approx(2.228).epsilon(1e-4));
    CHECK(interval_factor_95(1e9) == doctest::Approx(interval_factor_95({})));
    CHECK(interval_factor_95({}) == doctest::Approx(1.959963985));
}

TEST_CASE("a value of t is converted to an equally unlikely normal value") {
    CHECK(normal_equivalent(12.7062047, 1.0) == doctest::Approx(1.959963985));
    CHECK(normal_equivalent(-2.228138852, 10.0) == doctest::Approx(1.959963985));
    CHECK(normal_equivalent(0.0, 3.0) == doctest::Approx(0.0));
    CHECK(std::isinf(normal_equivalent(1e200, 5.0)));
    CHECK(std::isinf(normal_equivalent(-std::numeric_limits<double>::infinity(), 5.0)));
    CHECK(std::isnan(normal_equivalent(std::nan(""), 5.0)));
}
