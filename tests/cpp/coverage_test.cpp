#include "brushsvg/coverage.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "brushsvg/simulate.hpp"
#include "marks/rasterizer.hpp"
#include "marks/sweep.hpp"
#include "refusal.hpp"
#include "round6.hpp"

using namespace brushsvg;

namespace {

Pass pass_of_marks() {
    Pass pass;
    pass.stroke = "s";
    pass.poses_mm.resize(6, 3);
    pass.poses_mm << 20, 20, 0, 26, 20, -4, 60, 20, -4, 60, 50, -5, 20, 30, -3, 22, 30, 0;
    return pass;
}

Marks marks_of(const Brush& brush, double tolerance_mm) {
    Plan plan;
    plan.passes = {pass_of_marks()};
    return simulate(plan, brush, tolerance_mm);
}

double painted_mm2(const Coverage& c, double px_per_mm) {
    return double(c.cast<double>().sum()) / (px_per_mm * px_per_mm);
}

/// Return a brush with a crescent that opens towards the TCP, because footprints need not be convex.
Brush crescent_brush() {
    Brush brush = shipped("round-6");
    brush.footprints = {};
    for (double d : {2.0, 6.0}) {
        Ring r(6, 2);
        const double h = 0.42 * d, x = brush.tip_to_widest(d);
        r << 0, 0, x, -h, x + 1.5, -0.6 * h, 0.55 * x, 0, x + 1.5, 0.6 * h, x, h;
        brush.footprints.dragged.push_back({d, r});
    }
    return brush;
}

}  // namespace

TEST_CASE("the coverage of a box is exact in edge pixels") {
    Ring r(4, 2);
    r << 1.25, 1.0, 3.5, 1.0, 3.5, 2.0, 1.25, 2.0;
    const Coverage c = coverage({r}, Window{0, 0, 5, 4}, 1.0);
    CHECK(c.rows() == 4);
    CHECK(c.cols() == 5);
    CHECK(c(2, 1) == doctest::Approx(0.75));
    CHECK(c(2, 2) == doctest::Approx(1.0));
    CHECK(c(2, 3) == doctest::Approx(0.5));
    CHECK(c.sum() == doctest::Approx(2.25));
}

TEST_CASE("coverage and rings agree on the painted area, convex or not") {
    for (const Brush& brush : {shipped("round-6"), crescent_brush()}) {
        const Marks marks = marks_of(brush, 0.005);
        const double ring_area = area(outline(marks.passes[0], brush));
        const Coverage c = coverage(marks, brush, Window{0, 0, 80, 70}, 20.0);
        CHECK(c.minCoeff() >= 0.0f);
        CHECK(c.maxCoeff() <= 1.0f);
        CHECK(painted_mm2(c, 20.0) == doctest::Approx(ring_area).epsilon(2e-4));
    }
}

TEST_CASE("a window cuts off the mark without moving it") {
    const Brush brush = shipped("round-6");
    const Marks marks = marks_of(brush, 0.02);
    const Coverage all = coverage(marks, brush, Window{0, 0, 80, 70}, 4.0);
    const Coverage part = coverage(marks, brush, Window{30, 10, 20, 20}, 4.0);
    CHECK((all.block(160, 120, 80, 80) - part).cwiseAbs().maxCoeff() < 1e-4f);
}

TEST_CASE("bounds contain every ring") {
    const Brush brush = shipped("round-6");
    const Marks marks = marks_of(brush, 0.02);
    const auto [left, bottom, right, top] = painted_bounds(marks.passes[0], brush);
    const Rings rings = outline(marks.passes[0], brush);
    double farthest = 0.0;
    for (const Ring& ring : rings) {
        farthest = std::max(farthest, ring.col(0).maxCoeff());
        CHECK(ring.col(0).minCoeff() >= left - 1e-4);
        CHECK(ring.col(1).minCoeff() >= bottom - 1e-4);
        CHECK(ring.col(0).maxCoeff() <= right + 1e-4);
        CHECK(ring.col(1).maxCoeff() <= top + 1e-4);
    }
    CHECK(right == doctest::Approx(farthest).epsilon(1e-5));
}

TEST_CASE("an impossible picture size is refused") {
    CHECK_THROWS_AS(coverage(Rings{}, Window{0, 0, 0, 10}, 20.0), Error);
    CHECK_THROWS_AS(coverage(Rings{}, Window{0, 0, 1e6, 1e6}, 20.0), Error);
    const double nan = std::nan("");
    const auto picture = [](const Window& window, double px_per_mm) {
        return refusal([&] { coverage(Rings{}, window, px_per_mm); });
    };
    CHECK(agrees(picture({0, 0, -10, 10}, 20.0), "picture-size", "", {"-200 x 200"}));
    CHECK(agrees(picture({nan, 0, 10, 10}, 20.0), "picture-size", "", {"corner", "nan"}));
    CHECK(agrees(picture({0, 0, 10, 10}, nan), "picture-size", "", {"scale", "nan"}));
}

TEST_CASE("the coverage of overlapping convex pieces is the coverage of their union") {
    Ring a(4, 2), b(4, 2);
    a << 1, 1, 5, 1, 5, 3, 1, 3;
    b << 3, 1, 8, 1, 8, 3, 3, 3;  // shares two edges with the first
    const Window window{0.0, 0.0, 10.0, 4.0};
    const Coverage found = coverage_of_pieces({a, b}, window, 1.7);
    CHECK(found.sum() / (1.7 * 1.7) == doctest::Approx(14.0).epsilon(0.002));
    CHECK((found - coverage(unite({a, b}), window, 1.7)).cwiseAbs().maxCoeff() < 0.13);
}

TEST_CASE("a picture of a part of the paper equals that part of the whole, to the last bit") {
    for (const Brush& brush : {shipped("round-6"), crescent_brush()}) {
        const Marks all = marks_of(brush, 0.1);
        const auto rows = [](const Marks& marks) { return marks.passes[0].pose.size(); };
        // paint next to the window cancels out, for shapes that are not convex only up to a rounding error
        const float hair = is_convex(brush.footprints.dragged[0].outline_mm) ? 0.0f : 1e-5f;
        std::size_t fewest = rows(all);
        for (double x = 10.0; x < 70.0; x += 7.0)
            for (double y = 10.0; y < 60.0; y += 7.0) {
                const Window window{x, y, 6.0, 6.0};
                Rasterizer whole(window, 8.0);
                sweep(
                    all.passes[0], brush, [&](const Ring& a, const Ring& b) { whole.convex_pair(a, b); },
                    [&](const Ring& ring) { whole.polygon({ring}); },
                    [&](const Ring& piece) { whole.convex_pair(piece, piece); });
                const Coverage expected = whole.coverage();
                CHECK(coverage(all, brush, window, 8.0) == expected);
                Marks near;
                near.passes = {simulate_near(pass_of_marks(), brush, window, 0.1)};
                CHECK((coverage(near, brush, window, 8.0) - expected).cwiseAbs().maxCoeff() <= hair);
                fewest = std::min(fewest, rows(near));
            }
        CHECK(fewest < rows(all));
    }
}
