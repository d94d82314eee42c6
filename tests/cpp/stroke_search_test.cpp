#include "brushsvg/stroke_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "brushsvg/compensate.hpp"
#include "brushsvg/coverage.hpp"
#include "brushsvg/region.hpp"
#include "brushsvg/simulate.hpp"
#include "refusal.hpp"
#include "round6.hpp"

using namespace brushsvg;

namespace {

Ring box(double left, double bottom, double right, double top) {
    Ring ring(4, 2);
    ring << left, bottom, right, bottom, right, top, left, top;
    return ring;
}

Stroke straight(Eigen::RowVector2d from, Eigen::RowVector2d to, double half) {
    Stroke stroke;
    stroke.middle_mm.resize(1, 8);
    stroke.middle_mm << from, from + (to - from) / 3.0, from + (to - from) / 1.5, to;
    stroke.half_width = {{0.0, half}};
    return stroke;
}

Pass pass_of(const Stroke& stroke, const Brush& brush) {
    CompensateOptions options;
    options.start = Terminal::automatic;
    options.end = Terminal::automatic;
    return compensate(stroke, brush, options).pass;
}

Rings mark_of(const std::vector<Stroke>& strokes, const Brush& brush) {
    Rings all;
    for (const Stroke& stroke : strokes)
        for (const Ring& ring : outline(simulate(pass_of(stroke, brush), brush), brush)) all.push_back(ring);
    return unite(all);
}

std::vector<Stroke> all_of(const SearchedShape& found) {
    std::vector<Stroke> all;
    for (const std::vector<Stroke>& parts : found.strokes) all.insert(all.end(), parts.begin(), parts.end());
    for (const AddedStroke& each : found.added) all.push_back(each.stroke);
    return all;
}

}  // namespace

TEST_CASE("a limb without a stroke gets one, and the mark fits the shape better") {
    const Brush brush = shipped("round-6");
    const Rings shape = unite({box(10, 10, 17, 50), box(17, 26, 34, 33)});
    const Stroke stem = straight({13.5, 46.5}, {13.5, 13.5}, 3.5);
    const auto found = search_strokes({{shape, {stem}, {pass_of(stem, brush)}}}, brush);
    REQUIRE(found.size() == 1);
    REQUIRE(!found[0].added.empty());
    CHECK(found[0].added[0].neighbour == 0);
    CHECK(area(found[0].added[0].area_mm) > 50.0);
    CHECK(overlap(mark_of(all_of(found[0]), brush), shape) > overlap(mark_of({stem}, brush), shape) + 0.15);
}

TEST_CASE("a stroke that sticks out of its shape is moved back") {
    const Brush brush = shipped("round-6");
    const Rings shape{box(10, 10, 17, 40)};
    const Stroke longer = straight({13.5, 36.5}, {13.5, 10.5}, 3.5);  // sticks out by nearly half a width
    const auto found = search_strokes({{shape, {longer}, {pass_of(longer, brush)}}}, brush);
    CHECK(found[0].changed[0]);
    const Rings before = mark_of({longer}, brush), after = mark_of(found[0].strokes[0], brush);
    const auto beyond = [&](const Rings& mark) { return area(mark) - area(intersect(mark, shape)); };
    CHECK(beyond(after) < 0.5 * beyond(before));
    const auto left_alone = search_strokes({{shape, {longer}, {pass_of(longer, brush)}}}, brush, {}, false);
    CHECK(!left_alone[0].changed[0]);
}

TEST_CASE("an added stroke has an outline, even for a pen hardly wider than a pixel of the search") {
    // this pen was found by the fuzzer
    const Brush pen = io::read_brush(R"({"format": "brushsvg/brush", "version": 1, "name": "fine", "kind": "pen",
        "depth_range_mm": [0, 2.313725490196078], "max_speed_mm_s": 25, "paint_depth_mm": 0.46274509803921565,
        "lag": {"coefficients": [0]}, "tip_gap": {"coefficients": [0, 0.53]},
        "tip_to_widest": {"coefficients": [0, 0.53]}, "half_width": {"coefficients": [0.1]},
        "footprints": {"dragged": [{"depth_mm": 2.3, "outline_mm":
                           [[0, 0], [1.23, -0.1], [1.33, -0.05], [1.33, 0.05], [1.23, 0.1]]}],
                       "pressed": [{"depth_mm": 2.3, "outline_mm":
                           [[0, 0], [1.23, -0.1], [1.49, -0.05], [1.49, 0.05], [1.23, 0.1]]}]}})");
    Ring triangle(3, 2);
    triangle << 40.25, 42.5, 30, 30, 32.5, 30;
    const auto found = search_strokes({{{triangle}, {}, {}}}, pen, weights_for(Detail::normal));
    for (const AddedStroke& each : found[0].added) CHECK(!each.mark_mm.empty());
}

TEST_CASE("shapes searched together and alone have the same result") {
    const Brush brush = shipped("round-6");
    std::vector<PaintedShape> shapes;
    for (int k = 0; k < 6; ++k) {
        const double x = 40.0 * k;
        const Stroke stem = straight({x + 13.5, 46.5}, {x + 13.5, 13.5}, 3.5);
        shapes.push_back({unite({box(x + 10, 10, x + 17, 50), box(x + 17, 26, x + 24 + 2 * k, 33)}),
                          {stem},
                          {pass_of(stem, brush)}});
    }
    const auto together = search_strokes(shapes, brush);
    for (std::size_t k = 0; k < shapes.size(); ++k) {
        const auto alone = search_strokes({shapes[k]}, brush);
        REQUIRE(alone[0].added.size() == together[k].added.size());
        for (std::size_t i = 0; i < alone[0].added.size(); ++i)
            CHECK(alone[0].added[i].stroke.middle_mm == together[k].added[i].stroke.middle_mm);
    }
}

TEST_CASE("a repeated shape gets the strokes of the first one at its own place, with its own names") {
    const Brush brush = shipped("round-6");
    Rings shape = unite({box(10, 10, 17, 50), box(17, 26, 34, 33)});
    Stroke stem = straight({13.5, 50}, {13.5, 4}, 3.5);
    stem.target_mm = shape;
    stem.id = StrokeId("a", 1);
    PaintedShape first{shape, {stem}, {pass_of(stem, brush)}}, again = first, other;
    const Eigen::RowVector2d by(-123.4, 56.7);
    for (Ring* ring : {&again.target_mm[0], &again.strokes[0].target_mm[0]}) ring->rowwise() += by;
    for (int column : {0, 2, 4, 6}) again.strokes[0].middle_mm.middleCols<2>(column).rowwise() += by;
    again.passes[0].poses_mm.leftCols<2>().rowwise() += by;
    again.strokes[0].id = StrokeId("b", 7);
    again.strokes[0].colour = "#ff0000";
    other = again;
    other.strokes[0].half_width = {{0.0, 2.5}};
    other.passes[0] = pass_of(other.strokes[0], brush);
    const auto found = search_strokes({first, again, other}, brush);
    const auto strokes = all_of(found[0]), repeated = all_of(found[1]), alone = all_of(found[2]);
    REQUIRE(found[0].changed[0]);
    REQUIRE(!found[0].added.empty());
    REQUIRE(repeated.size() == strokes.size());
    for (std::size_t k = 0; k < strokes.size(); ++k) {
        Cubics expected = strokes[k].middle_mm;
        for (int column : {0, 2, 4, 6}) expected.middleCols<2>(column).rowwise() += by;
        CHECK((repeated[k].middle_mm - expected).cwiseAbs().maxCoeff() < 1e-9);
    }
    CHECK(repeated[0].id.name() == again.strokes[0].id.name());
    CHECK(repeated[0].colour == "#ff0000");
    const auto expected = search_strokes({other}, brush);
    CHECK(alone.size() == all_of(expected[0]).size());
    CHECK(alone[0].middle_mm == all_of(expected[0])[0].middle_mm);
    const Ring &area = found[0].added[0].area_mm[0], &moved_area = found[1].added[0].area_mm[0];
    CHECK((moved_area.row(0) - area.row(0) - by).norm() < 1e-9);
}

TEST_CASE("unpainted areas above a share of the shape are found, the largest first") {
    const Brush brush = shipped("round-6");
    const Rings shape = unite({box(10, 10, 17, 50), box(17, 26, 34, 33), box(17, 40, 22, 44)});
    const Stroke stem = straight({13.5, 46.5}, {13.5, 13.5}, 3.5);
    const std::vector<PaintedShape> painted{{shape, {stem}, {pass_of(stem, brush)}}};
    const auto found = uncovered_areas(painted, brush, 0.02);
    REQUIRE(found[0].size() >= 2);
    CHECK(found[0][0].mm2 > found[0][1].mm2);
    CHECK(found[0][0].mm2 == doctest::Approx(17 * 7).epsilon(0.1));
    CHECK(std::abs(found[0][0].place_mm.x() - 25.5) < 6.0);
    CHECK(uncovered_areas(painted, brush, 0.5)[0].empty());
}

TEST_CASE("weights and shares that are not possible are refused") {
    const Brush brush = shipped("round-6");
    const Rings shape{box(10, 10, 34, 50)};
    const Stroke stem = straight({13.5, 46.5}, {13.5, 13.5}, 3.5);
    const std::vector<PaintedShape> painted{{shape, {stem}, {pass_of(stem, brush)}}};
    ObjectiveWeights weights;
    weights.seen_mm = -1.0;  // once wrote beyond the end of a picture
    CHECK(agrees(refusal([&] { search_strokes(painted, brush, weights); }), "out-of-range", "seen_mm"));
    CHECK(agrees(refusal([&] { uncovered_areas(painted, brush, std::nan("")); }), "out-of-range", ""));
    weights.seen_mm = 1000.0;
    CHECK(search_strokes(painted, brush, weights).size() == 1);
}
