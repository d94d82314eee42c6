#include "brushsvg/student_t.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using brushsvg::as_normal;
using brushsvg::deviations_of_95;

TEST_CASE("half of a 95 % interval agrees with printed tables") {
    CHECK(deviations_of_95(1.0) == doctest::Approx(12.706).epsilon(1e-4));
    CHECK(deviations_of_95(2.0) == doctest::Approx(4.303).epsilon(1e-4));
    CHECK(deviations_of_95(10.0) == doctest::Approx(2.228).epsilon(1e-4));
    CHECK(deviations_of_95(1e9) == doctest::Approx(deviations_of_95({})));
    CHECK(deviations_of_95({}) == doctest::Approx(1.959963985));
}

TEST_CASE("a value of t is converted to an equally unlikely normal value") {
    CHECK(as_normal(12.7062047, 1.0) == doctest::Approx(1.959963985));
    CHECK(as_normal(-2.228138852, 10.0) == doctest::Approx(1.959963985));
    CHECK(as_normal(0.0, 3.0) == doctest::Approx(0.0));
    CHECK(std::isinf(as_normal(1e200, 5.0)));
    CHECK(std::isinf(as_normal(-std::numeric_limits<double>::infinity(), 5.0)));
    CHECK(std::isnan(as_normal(std::nan(""), 5.0)));
}
