#include "brushsvg/paint.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "refusal.hpp"
#include "round6.hpp"

using namespace brushsvg;

namespace {

Paint paint_of(double narrows_per_m) {
    Paint paint;
    paint.narrows_per_m = narrows_per_m;
    return paint;
}

}  // namespace

TEST_CASE("two paths use as much paint as one of their joint length, and the path to a share is its inverse") {
    const Paint paint = paint_of(0.7);
    CHECK(paint.width_share(0.0) == 1.0);
    CHECK(paint.width_share(1000.0) == doctest::Approx(std::exp(-0.7)));
    CHECK(paint.width_share(120.0) * paint.width_share(345.0) == doctest::Approx(paint.width_share(465.0)));
    CHECK(paint.width_share(paint.path_to_share_mm(0.95)) == doctest::Approx(0.95));
    CHECK(std::isinf(paint_of(0.0).path_to_share_mm(0.95)));
}

TEST_CASE("impossible paint is refused with its key") {
    const auto changed = [](auto&& change) {
        Brush brush = shipped("round-6");
        brush.paint = paint_of(0.4);
        brush.paint->lasts_mm = 500.0;
        brush.paint->covariance = {{0.01, 0.0}, {0.0, 400.0}};
        change(*brush.paint);
        return refusal([&] { check(brush); });
    };
    CHECK(!changed([](Paint&) {}));
    CHECK(agrees(changed([](Paint& p) { p.narrows_per_m = -0.1; }), "out-of-range", "paint.narrows_per_m"));
    CHECK(agrees(changed([](Paint& p) { p.narrows_per_m = NAN; }), "out-of-range", "paint.narrows_per_m", {"[0, 20]"}));
    CHECK(agrees(changed([](Paint& p) { p.lasts_mm = 0.0; }), "out-of-range", "paint.lasts_mm", {"[1, 1e+06]"}));
    CHECK(agrees(changed([](Paint& p) { p.calibrated_mm = {{9.0, 3.0}}; }), "out-of-range", "paint.calibrated_mm"));
    CHECK(agrees(changed([](Paint& p) { p.degrees_of_freedom = 0.5; }), "out-of-range", "paint.degrees_of_freedom"));
    CHECK(agrees(changed([](Paint& p) { p.lasts_mm.reset(); }), "covariance-invalid", "paint.covariance", {"1"}));
    CHECK(
        agrees(changed([](Paint& p) { p.covariance[1].pop_back(); }), "covariance-invalid", "paint.covariance", {"2"}));
    CHECK(agrees(changed([](Paint& p) { p.covariance[0][0] = INFINITY; }), "not-finite", "paint.covariance"));
    CHECK(agrees(changed([](Paint& p) { p.covariance[0][0] = -1.0; }), "covariance-invalid", "paint.covariance"));
    CHECK(agrees(changed([](Paint& p) { p.covariance[0][1] = 1.0; }), "covariance-invalid", "paint.covariance"));
    CHECK(agrees(changed([](Paint& p) { p.covariance[0][1] = p.covariance[1][0] = 3.0; }), "covariance-invalid",
                 "paint.covariance"));
}
