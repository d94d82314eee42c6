#include "brushsvg/bristle_deflection.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace brushsvg;

TEST_CASE("Lemma 1 with the article's fourth condition") {
    const auto c = bristle_coefficients(SlidingEnd::third_derivative);
    const double k = 2.0 * std::exp(1.0) - 3.0;
    CHECK((c - Eigen::Vector4d(4, 3, -4, 1) / k).cwiseAbs().maxCoeff() < 1e-12);
    CHECK(std::abs(bristle_deflection(c, 1.0) - 0.0260351676) < 1e-10);
}

TEST_CASE("Lemma 1 with an end free of shear") {
    const auto c = bristle_coefficients(SlidingEnd::shear_free);
    CHECK((c - Eigen::Vector4d(1.531832855, 1.163953414, -1.531832855, 0.367879441)).cwiseAbs().maxCoeff() < 1e-9);
    CHECK(std::abs(bristle_deflection(c, 1.0) - 0.0318328549) < 1e-10);
}

TEST_CASE("the deflection solves (e^(1-z) w'')'' = e^(1-z)") {
    for (auto end : {SlidingEnd::third_derivative, SlidingEnd::shear_free}) {
        const auto c = bristle_coefficients(end);
        const auto moment = [&](double z) {
            const double h = 1e-3, w2 = (bristle_deflection(c, z + h) - 2 * bristle_deflection(c, z) +
                                         bristle_deflection(c, z - h)) /
                                        (h * h);
            return std::exp(1.0 - z) * w2;
        };
        for (double z : {0.2, 0.5, 0.8}) {
            const double h = 2e-2;
            CHECK(std::abs((moment(z + h) - 2 * moment(z) + moment(z - h)) / (h * h) - std::exp(1.0 - z)) < 2e-3);
        }
    }
}
