#include "brushsvg/stroke_score.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "boxes.hpp"
#include "brushsvg/compensate.hpp"
#include "brushsvg/simulate.hpp"
#include "round6.hpp"

using namespace brushsvg;
using V = Eigen::Vector2d;

namespace {

Ring hole(double x0, double y0, double x1, double y1) { return box(x0, y0, x1, y1).colwise().reverse(); }

MarkOverlap laid(const Rings& target, const Rings& painted) {
    const Window window{-12.0, -12.0, 64.0, 64.0};
    return {window, 10.0, coverage(target, window, 10.0), coverage(painted, window, 10.0)};
}

MiddlePolyline line_of(const V& a, const V& b, double half) {
    MiddlePolyline line(2, 4);
    line << a.transpose(), 0.0, half, b.transpose(), (b - a).norm(), half;
    return line;
}

}  // namespace

TEST_CASE("the width across a line is measured in any direction") {
    struct Case {
        Rings rings;
        double width;
    };
    const V middle(10.0, 5.0);
    for (const double turn : {0.0, 0.5, 1.5707963267948966, 3.7})
        for (const Case& each : {Case{{box(0, 3.5, 20, 7)}, 3.5},
                                 {{box(0, 5.5, 20, 7)}, 1.5},                     // next to the line, but within reach
                                 {{box(0, 9, 20, 12)}, 0.0},                      // too far away to be this line's mark
                                 {{box(0, 3, 20, 7), hole(1, 4, 19, 6)}, 1.0},    // the line runs in the hole
                                 {{box(0, 3, 20, 7), box(0, 7.5, 20, 30)}, 4.0},  // another mark next to it
                                 {{}, 0.0}}) {
            Eigen::Matrix2d rotation;
            rotation << std::cos(turn), std::sin(turn), -std::sin(turn), std::cos(turn);
            Rings rings;
            for (Ring ring : each.rings) {
                ring.rowwise() -= middle.transpose();
                ring = ring * rotation;
                ring.rowwise() += Eigen::RowVector2d(20.0, 20.0);
                rings.push_back(ring);
            }
            const MarkOverlap seen = laid(rings, {});
            const V along(std::cos(turn), std::sin(turn));
            CHECK(std::abs(width_across(seen.target, seen, V(20, 20), along, 3.0) - each.width) < 0.03);
        }
}

TEST_CASE("the width error is the mean absolute difference where the width can be measured") {
    const MiddlePolyline line = line_of(V(0, 0), V(40, 0), 2.0);
    const Rings target{box(-2, -2, 42, 2)};
    Ring half_right(6, 2);
    half_right << -2, -2, 42, -2, 42, 2, 20, 2, 20, 2.5, -2, 2.5;
    CHECK(*width_error_mm(laid(target, target), line) < 1e-6);
    CHECK(std::abs(*width_error_mm(laid(target, {half_right}), line) - 0.25) < 0.01);
    CHECK(std::abs(*width_error_mm(laid(target, {}), line) - 4.0) < 0.01);
    // where the line crosses itself, the mark is wider than the line, so its width cannot be measured
    const MiddlePolyline thin = line_of(V(0, 0), V(40, 0), 1.0);
    const Rings crossing{box(0, -1, 18, 1), box(18, -9, 22, 1), box(22, -1, 40, 1)};
    CHECK(*width_error_mm(laid(crossing, {box(0, -1, 40, 1)}), thin) < 1e-6);
    CHECK_FALSE(width_error_mm(laid({box(0, -5, 40, 5)}, crossing), thin));
    MiddlePolyline dab(1, 4);
    dab << 3, 3, 0, 1;
    CHECK_FALSE(width_error_mm(laid({box(2, 2, 4, 4)}, {box(2, 2, 4, 4)}), dab));
}

TEST_CASE("the worst place is found, for missing and for additional paint") {
    const Rings target{box(0, 0, 20, 4)};
    const WorstPlace missing = worst_place(laid(target, {box(0, 0, 18, 4), box(5, 4, 6, 5)}), 2.0);
    CHECK(missing.is_missing);
    CHECK((V(missing.at_mm[0], missing.at_mm[1]) - V(19, 2)).cwiseAbs().maxCoeff() < 1.1);
    CHECK(missing.area_mm2 == doctest::Approx(4.0).epsilon(0.01));
    const WorstPlace spilt = worst_place(laid(target, {box(0, 0, 20, 4), box(5, 4, 6, 5)}), 1.0);
    CHECK_FALSE(spilt.is_missing);
    CHECK((V(spilt.at_mm[0], spilt.at_mm[1]) - V(5.5, 4.5)).cwiseAbs().maxCoeff() < 0.11);
    CHECK(spilt.area_mm2 == doctest::Approx(1.0).epsilon(0.03));
    CHECK(worst_place(laid(target, target), 1e6).area_mm2 == 0.0);  // a square larger than the picture
}

TEST_CASE("a verdict has the overlap of the pixels and a place near the stroke") {
    const Brush brush = shipped("round-6");
    const Stroke line = stroke_of(polyline({V(20, 20), V(50, 20)}), {{0.0, 1.5}});
    const PassMarks marks = simulate(compensate(line, brush).pass, brush);
    const StrokeScore found = stroke_score(marks, line, brush);
    CHECK(found.overlap == common_area(mark_overlap({marks}, {line}, brush)).overlap());
    CHECK(*found.width_error_mm < 0.05);
    CHECK(found.worst.area_mm2 > 0.005);
    CHECK(std::abs(found.worst.at_mm[1] - 20.0) < 2.0);
}
