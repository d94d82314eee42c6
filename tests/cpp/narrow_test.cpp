#include "brushsvg/narrow.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "brushsvg/coverage.hpp"
#include "brushsvg/simulate.hpp"
#include "refusal.hpp"
#include "round6.hpp"

using namespace brushsvg;

namespace {

Paint paint_of(double narrows_per_m) {
    Paint paint;
    paint.narrows_per_m = narrows_per_m;
    return paint;
}

/// Return a line of 200 mm along x at a given y, with the brush set down and lifted on the spot.
Pass line_at(double y, double depth) {
    Pass pass;
    pass.stroke = "s";
    pass.poses_mm.resize(4, 3);
    pass.poses_mm << 0, y, 0, 0, y, -depth, 200, y, -depth, 200, y, 0;
    return pass;
}

double height_at(const Marks& marks, const Brush& brush, double x, double y) {
    const Coverage seen = coverage(marks, brush, {x, y - 6.0, 0.05, 12.0}, 20.0);
    return double(seen.sum()) / 20.0;
}

}  // namespace

TEST_CASE("a mark narrows with the distance since the dip, over all passes until paint is fetched") {
    const Brush brush = shipped("round-6");
    const Paint paint = paint_of(1.5);
    Plan plan;
    plan.passes = {line_at(0.0, 4.0), line_at(20.0, 4.0), line_at(40.0, 4.0)};
    Marks marks = simulate(plan, brush);
    narrow(marks, paint, {{0.0}, {}, {0.0, 100.0}});
    const double wide = 2.0 * brush.half_width(4.0);
    // The widest section is behind the TCP by a constant distance. So when it is at x, the TCP has moved x plus that
    // distance.
    const double behind = brush.lag(4.0) - brush.lever_to_widest(4.0);
    const auto is_wide = [&](double x, double y, double way) {
        CHECK(height_at(marks, brush, x, y) == doctest::Approx(wide * std::exp(-1.5e-3 * way)).epsilon(0.004));
    };
    is_wide(60.0, 0.0, 60.0 + behind);
    is_wide(150.0, 0.0, 150.0 + behind);
    is_wide(60.0, 20.0, 260.0 + behind);
    is_wide(60.0, 40.0, 60.0 + behind);
    is_wide(85.0, 40.0, 85.0 + behind);
    is_wide(150.0, 40.0, 50.0 + behind);
    for (PassMarks& pass : marks.passes) pass.width_share.clear();
    CHECK(height_at(marks, brush, 150.0, 0.0) == doctest::Approx(wide).epsilon(0.004));
}

TEST_CASE("impossible dips are refused") {
    const Brush brush = shipped("round-6");
    Plan plan;
    plan.passes = {line_at(0.0, 4.0)};
    Marks marks = simulate(plan, brush);
    const auto with = [&](const std::vector<std::vector<double>>& dips) {
        return refusal([&] { narrow(marks, paint_of(0.3), dips); });
    };
    CHECK(agrees(with({}), "sizes-differ", "", {"0", "1"}));
    CHECK(agrees(with({{50.0, 20.0}}), "not-ascending", "s"));
    CHECK(agrees(with({{NAN}}), "not-ascending", "s"));
    CHECK(agrees(refusal([&] { narrow(marks, paint_of(-1.0), {{0.0}}); }), "out-of-range", "paint.narrows_per_m"));
    marks.passes[0].tcp_mm.resize(0, 2);
    CHECK(agrees(with({{0.0}}), "sizes-differ", "s"));
    marks = simulate(plan, brush);
    marks.passes[0].width_share = {1.0};
    CHECK(agrees(refusal([&] { outline(marks.passes[0], brush); }), "sizes-differ", "s"));
    marks.passes[0].width_share.assign(marks.passes[0].pose.size(), 1.5);
    CHECK(agrees(refusal([&] { outline(marks.passes[0], brush); }), "out-of-range", "s", {"[0, 1]"}));
}
