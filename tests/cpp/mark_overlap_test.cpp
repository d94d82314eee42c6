#include "brushsvg/mark_overlap.hpp"

#include <doctest/doctest.h>

#include "boxes.hpp"
#include "brushsvg/compensate.hpp"
#include "brushsvg/simulate.hpp"
#include "brushsvg/target_mark.hpp"
#include "round6.hpp"

using namespace brushsvg;
using V = Eigen::Vector2d;

TEST_CASE("counted pixels agree with the area of rings") {
    const Brush brush = shipped("round-6");
    const Stroke line = stroke_of(polyline({V(20, 20), V(50, 28), V(50, 50)}), {{0.0, 0.4}, {1.0, 3.0}});
    Stroke shape = line;
    shape.target_mm = target_outline(line, 0.01);
    const PassMarks marks = simulate(compensate(line, brush).pass, brush);
    for (const Stroke& stroke : {line, shape}) {
        const MarkOverlap seen = mark_overlap({marks}, {stroke}, brush);
        CHECK(common_area(seen).overlap() ==
              doctest::Approx(overlap(outline(marks, brush), shape.target_mm)).epsilon(1e-3));
        CHECK(seen.target.row(0).sum() + seen.painted.row(0).sum() == 0.0f);  // the border is paper
        CHECK(seen.target.col(0).sum() + seen.painted.col(0).sum() == 0.0f);
    }
    CHECK(mark_overlap({marks}, {line}, brush).px_per_mm == doctest::Approx(15.0));  // 6 across the finest half width
    CHECK(mark_overlap({marks}, {shape}, brush).px_per_mm == doctest::Approx(8.0));
}

TEST_CASE("strokes that overlap count once") {
    const Brush brush = shipped("round-6");
    Stroke a, b;
    a.target_mm = {box(0, 0, 20, 4)};
    b.target_mm = {box(10, 0, 30, 4)};
    CHECK(common_area(mark_overlap({}, {a, b}, brush)).union_mm2 == doctest::Approx(120.0).epsilon(0.01));
    CHECK(common_area(mark_overlap({}, {a, b}, brush)).intersection_mm2 == 0.0);
}

TEST_CASE("a large sheet is counted tile by tile") {
    const Brush brush = shipped("round-6");
    std::vector<Stroke> strokes;
    std::vector<PassMarks> marks;
    double common = 0.0, together = 0.0;
    for (const double y : {30.0, 200.0, 480.0}) {
        strokes.push_back(stroke_of(polyline({V(30, y), V(470, y + 60)}), {{0.0, 1.0}, {1.0, 3.0}}));
        marks.push_back(simulate(compensate(strokes.back(), brush).pass, brush));
        const CommonArea one = common_area(mark_overlap({marks.back()}, {strokes.back()}, brush));
        common += one.intersection_mm2;
        together += one.union_mm2;
    }
    const CommonArea all = common_area(marks, strokes, brush);
    CHECK(all.intersection_mm2 == doctest::Approx(common).epsilon(1e-3));
    CHECK(all.union_mm2 == doctest::Approx(together).epsilon(1e-3));
    CHECK(group_touching(strokes).empty());
    strokes.push_back(stroke_of(polyline({V(30, 10), V(30, 300)}), {{0.0, 1.0}}));
    CHECK(group_touching(strokes) == std::vector<std::vector<std::size_t>>{{0, 1, 3}});
}

TEST_CASE("an empty target without paint has full overlap, and hairlines and huge sheets have pixels") {
    const Brush brush = shipped("round-6");
    CHECK(common_area(mark_overlap({}, {}, brush)).overlap() == 1.0);
    const Stroke thin = stroke_of(polyline({V(0, 0), V(3, 0)}), {{0.0, 0.01}});
    CHECK(mark_overlap({}, {thin}, brush).px_per_mm == doctest::Approx(40.0));
    CHECK(common_area(mark_overlap({}, {thin}, brush)).union_mm2 == doctest::Approx(0.06).epsilon(0.05));
    const Stroke wide = stroke_of(polyline({V(0, 0), V(9000, 9000)}), {{0.0, 3.0}});
    CHECK(double(mark_overlap({}, {wide}, brush).target.size()) < 4.1e6);
    const Stroke none = stroke_of(polyline({V(1, 2), V(3, 2)}), {{0.0, 0.0}});
    CHECK(common_area(mark_overlap({}, {none}, brush)).union_mm2 == 0.0);
}
