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

TEST_CASE("two ways take what one as long takes, and the way to a share is the way that takes it") {
    const Paint paint = paint_of(0.7);
    CHECK(paint.width_share(0.0) == 1.0);
    CHECK(paint.width_share(1000.0) == doctest::Approx(std::exp(-0.7)));
    CHECK(paint.width_share(120.0) * paint.width_share(345.0) == doctest::Approx(paint.width_share(465.0)));
    CHECK(paint.width_share(paint.way_to_share_mm(0.95)) == doctest::Approx(0.95));
    CHECK(std::isinf(paint_of(0.0).way_to_share_mm(0.95)));
}

TEST_CASE("paint that none can be is refused by its key") {
    const auto changed = [](auto&& change) {
        Brush brush = shipped("round-6");
        brush.paint = paint_of(0.4);
        brush.paint->lasts_mm = 500.0;
        brush.paint->covariance = {{0.01, 0.0}, {0.0, 400.0}};
        change(*brush.paint);
        return refusal([&] { check(brush); });
    };
    CHECK(changed([](Paint&) {}) == "");
    CHECK(contains(changed([](Paint& p) { p.narrows_per_m = -0.1; }), "paint.narrows_per_m: narrows_per_m must lie"));
    CHECK(contains(changed([](Paint& p) { p.narrows_per_m = NAN; }), "[0, 20] per metre"));
    CHECK(contains(changed([](Paint& p) { p.lasts_mm = 0.0; }), "paint.lasts_mm: lasts_mm must lie within [1, 1e6]"));
    CHECK(contains(changed([](Paint& p) { p.calibrated_mm = {{9.0, 3.0}}; }), "paint.calibrated_mm: the ways"));
    CHECK(contains(changed([](Paint& p) { p.degrees_of_freedom = 0.5; }), "paint.degrees_of_freedom"));
    CHECK(contains(changed([](Paint& p) { p.lasts_mm.reset(); }), "must have 1 rows of as many numbers"));
    CHECK(contains(changed([](Paint& p) { p.covariance[1].pop_back(); }), "must have 2 rows"));
    CHECK(contains(changed([](Paint& p) { p.covariance[0][0] = INFINITY; }), "a number is not finite"));
    CHECK(contains(changed([](Paint& p) { p.covariance[0][0] = -1.0; }), "a variance must not be negative"));
    CHECK(contains(changed([](Paint& p) { p.covariance[0][1] = 1.0; }), "symmetric"));
    CHECK(contains(changed([](Paint& p) { p.covariance[0][1] = p.covariance[1][0] = 3.0; }), "positive semi-definite"));
}
