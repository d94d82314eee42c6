// Every input of the public functions gives a result or Error, without a crash or a hang.
#include "brushsvg/brushsvg.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "boxes.hpp"
#include "brush_json.hpp"
#include "marks_json.hpp"
#include "plan_json.hpp"
#include "round6.hpp"

using namespace brushsvg;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
const std::vector<double> kNumbers{0.05, 0.0, -1.0, kNan, kInf, -kInf, 1e-300, 1e300, 5.5e9};

template <class T>
using Named = std::vector<std::pair<std::string, T>>;

/// Make a call that must give a result or Error. Everything else fails the test.
template <class Call>
void ends(Call&& call) {
    try {
        call();
    } catch (const Error& e) {
        CHECK(std::string(e.what()).size() > 10);
    }
}

Named<Brush> brushes() {
    const Brush sound = shipped("round-6");
    Named<Brush> out{{"sound", sound}, {"rigid", shipped("rigid")}, {"empty", {}}};
    const auto add = [&](const std::string& name, auto change) {
        Brush brush = sound;
        change(brush);
        out.emplace_back(name, brush);
    };
    add("no footprints", [](Brush& b) { b.footprints = {}; });
    add("only pressed", [](Brush& b) { b.footprints = {{}, b.footprints.dragged}; });
    add("outline of nothing", [](Brush& b) { b.footprints.dragged[0].outline_mm.resize(0, 2); });
    add("all outlines of nothing", [](Brush& b) {
        for (Footprint& shape : b.footprints.dragged) shape.outline_mm.resize(0, 2);
        b.footprints.pressed.clear();
    });
    add("a shorter outline", [](Brush& b) { b.footprints.dragged.back().outline_mm.conservativeResize(5, 2); });
    add("a shorter pressed outline", [](Brush& b) {
        b.footprints.pressed = b.footprints.dragged;
        b.footprints.pressed[0].outline_mm.conservativeResize(5, 2);
    });
    add("outlines in no order", [](Brush& b) { std::swap(b.footprints.dragged[0], b.footprints.dragged.back()); });
    for (const double x : {kNan, kInf, 5.5e9, 1e300}) {
        const std::string with = " of " + std::to_string(x);
        add("a vertex" + with, [x](Brush& b) { b.footprints.dragged[1].outline_mm(3, 0) = x; });
        add("a footprint's depth" + with, [x](Brush& b) { b.footprints.dragged.back().depth_mm = x; });
        add("a lag" + with, [x](Brush& b) { b.lag = {{x}}; });
        add("a slope of the lag" + with, [x](Brush& b) { b.lag = {{1.0, x}}; });
        add("a half width" + with, [x](Brush& b) { b.half_width = {{0.0, x}}; });
        add("a floor" + with, [x](Brush& b) { b.tip_to_widest.floor = x; });
        add("a range" + with, [x](Brush& b) { b.depth_range_mm = {0.0, x}; });
        add("a painting depth" + with, [x](Brush& b) { b.paint_depth_mm = x; });
        add("one width and a painting depth" + with, [x](Brush& b) {
            b.half_width = {{1.0}};
            b.paint_depth_mm = x;
        });
    }
    add("reversed", [](Brush& b) { b.depth_range_mm = {8.0, 0.0}; });
    add("no range", [](Brush& b) { b.depth_range_mm = {3.0, 3.0}; });
    add("no lag", [](Brush& b) { b.lag = {}; });
    add("negative lag", [](Brush& b) { b.lag = {{-5.0}}; });
    add("falling width", [](Brush& b) { b.half_width = {{5.0, -1.0}}; });
    add("waves", [](Brush& b) { b.lag = {{5.0, 9.0, -30.0, 20.0, -6.0, 0.9, -0.07, 0.003, -0.00004}}; });
    add("ten thousand terms", [](Brush& b) { b.lag = {std::vector<double>(10000, 1e-9)}; });
    return out;
}

Named<Stroke> strokes() {
    Named<Stroke> out{{"empty", {}}};
    const std::vector<WidthKnot> wide{{0.0, 1.0}, {1.0, 2.0}};
    const auto add = [&](const std::string& name, const std::vector<Eigen::Vector2d>& points,
                         const std::vector<WidthKnot>& knots, bool closed = false) {
        out.emplace_back(name, stroke_of(polyline(points), knots));
        out.back().second.closed = closed;
    };
    const std::vector<Eigen::Vector2d> line{{10, 10}, {30, 10}, {30, 25}};
    add("sound", line, wide);
    add("no width", line, {});
    add("a point", {{5, 5}, {5, 5}}, wide);
    add("a closed point", {{5, 5}, {5, 5}}, wide, true);
    add("closed there and back", {{0, 0}, {9, 0}, {0, 0}}, wide, true);
    add("knots in no order", line, {{1.0, 1.0}, {0.0, 2.0}});
    add("knots elsewhere", line, {{-5e5, 1.0}, {9e5, 2.0}});
    add("a jump in width", line, {{0.5, 0.5}, {0.5, 3.0}, {0.5, 0.5}});
    add("as long as the world", {{-1e6, -1e6}, {1e6, 1e6}}, wide);
    for (const double x : {kNan, kInf, -kInf, 1e300, 5.5e9, 1e-300}) {
        const std::string with = " of " + std::to_string(x);
        add("a place" + with, {{0, 0}, {x, 3}}, wide);
        add("a width" + with, line, {{0.0, x}, {1.0, 1.0}});
        add("a knot" + with, line, {{0.0, 1.0}, {x, 1.0}});
        add("an outline" + with, line, wide);
        out.back().second.target_mm = {Ring::Constant(4, 2, x)};
    }
    add("an outline of nothing", line, wide);
    out.back().second.target_mm = {Ring(0, 2), Ring::Zero(1, 2)};
    return out;
}

Pass pass_of(const std::vector<Eigen::RowVector3d>& poses, std::vector<Arc> arcs = {}) {
    Pass pass;
    pass.stroke = "s";
    pass.poses_mm.resize(Eigen::Index(poses.size()), 3);
    for (std::size_t i = 0; i < poses.size(); ++i) pass.poses_mm.row(Eigen::Index(i)) = poses[i];
    pass.arcs = std::move(arcs);
    return pass;
}

Named<Pass> passes() {
    Named<Pass> out{{"empty", {}}};
    const std::vector<Eigen::RowVector3d> sound{{0, 0, 0}, {9, 0, -3}, {30, 0, -3}, {30, 9, 0}};
    out.emplace_back("sound", pass_of(sound));
    out.emplace_back("one pose", pass_of({{3, 3, -2}}));
    out.emplace_back("on the spot", pass_of({{3, 3, -2}, {3, 3, -2}, {3, 3, 0}, {3, 3, -2}}));
    out.emplace_back("in the air", pass_of({{0, 0, 5}, {9, 0, 5}}));
    out.emplace_back("round the world", pass_of({{-1e6, -1e6, -2}, {1e6, 1e6, -3}, {-1e6, 1e6, -1}}));
    out.emplace_back("to and fro", pass_of({{0, 0, 0}, {9, 0, -5}, {0, 0, -5}, {9, 0, -5}, {0, 0, 0}}));
    for (const double x : {kNan, kInf, -kInf, 1e300, -1e300, 5.5e9}) {
        out.emplace_back("x " + std::to_string(x), pass_of({{0, 0, 0}, {x, 0, -3}}));
        out.emplace_back("z " + std::to_string(x), pass_of({{0, 0, 0}, {9, 0, x}, {20, 0, -2}}));
        out.emplace_back("centre " + std::to_string(x), pass_of(sound, {{1, 2, {x, 0}, 1}}));
    }
    for (const Arc& arc : {Arc{-1, 2, {0, 0}, 1}, Arc{1, 99, {0, 0}, 1}, Arc{2, 1, {0, 0}, 1}, Arc{1, 2, {19, 0}, 7},
                           Arc{0, std::numeric_limits<std::int64_t>::max(), {0, 0}, 1}})
        out.emplace_back("arc", pass_of(sound, {arc}));
    return out;
}

Named<PassMarks> marks() {
    const PassMarks sound = simulate(pass_of({{0, 0, 0}, {9, 0, -3}, {30, 0, -3}}), shipped("round-6"));
    Named<PassMarks> out{{"sound", sound}, {"empty", {}}};
    const auto add = [&](const std::string& name, auto change) {
        PassMarks changed = sound;
        change(changed);
        out.emplace_back(name, changed);
    };
    add("fewer contacts", [](PassMarks& m) { m.contact_mm.conservativeResize(1, 2); });
    add("no pull", [](PassMarks& m) { m.pull.clear(); });
    add("fewer depths", [](PassMarks& m) { m.depth_mm.pop_back(); });
    add("no headings", [](PassMarks& m) { m.heading_rad.clear(); });
    add("only poses", [](PassMarks& m) {
        m = {};
        m.pose = {0.0, 1.0};
    });
    for (const double x : {kNan, kInf, 1e300, 5.5e9}) {
        add("contact " + std::to_string(x), [x](PassMarks& m) { m.contact_mm(2, 0) = x; });
        add("depth " + std::to_string(x), [x](PassMarks& m) { m.depth_mm[2] = x; });
        add("heading " + std::to_string(x), [x](PassMarks& m) { m.heading_rad[2] = x; });
        add("pull " + std::to_string(x), [x](PassMarks& m) { m.pull[2] = x; });
    }
    return out;
}

Named<Rings> many_rings() {
    Ring square(4, 2), bow(4, 2);
    square << 0, 0, 9, 0, 9, 9, 0, 9;
    bow << 0, 0, 9, 9, 9, 0, 0, 9;
    Named<Rings> out{{"sound", {square}},
                     {"none", {}},
                     {"of nothing", {Ring(0, 2)}},
                     {"a point", {Ring::Zero(1, 2)}},
                     {"two points", {square.topRows(2)}},
                     {"one place", {Ring::Zero(5, 2)}},
                     {"a bow", {bow}},
                     {"clockwise", {square.colwise().reverse().eval()}},
                     {"twice", {square, square}},
                     {"hole alone", {square.colwise().reverse().eval(), square}}};
    for (const double x : {kNan, kInf, -kInf, 1e300, 5.5e9, 1e5}) {
        Ring far = square;
        far(2, 1) = x;
        out.push_back({"a corner of " + std::to_string(x), {far}});
    }
    return out;
}

}  // namespace

TEST_CASE("any brush with a valid stroke, pass and marks gives a result or Error") {
    const Stroke stroke = strokes()[1].second;
    const Pass pass = passes()[1].second;
    const PassMarks mark = marks()[0].second;
    REQUIRE(stroke.middle_mm.rows() == 2);
    for (const auto& [name, brush] : brushes()) {
        CAPTURE(name);
        ends([&, &b = brush] { check(b); });
        ends([&, &b = brush] { remarks(b); });
        for (const Compensation method : {Compensation::none, Compensation::constant, Compensation::closed})
            ends([&, &b = brush] { compensate(stroke, b, {method}); });
        ends([&, &b = brush] { simulate(pass, b); });
        ends([&, &b = brush] { simplify_pass(pass, b, 0.05); });
        ends([&, &b = brush] { tracking_error_of(pass, stroke, b, 0.05); });
        ends([&, &b = brush] { split_into_loads(pass, b, {10.0, 30.0, 5.0}); });
        ends([&, &b = brush] { outline(mark, b); });
        ends([&, &b = brush] { painted_bounds(mark, b); });
        ends([&, &b = brush] { coverage(Marks{{mark}, {}}, b, {0, 0, 40, 20}, 4.0); });
        ends([&, &b = brush] { mark_overlap({mark}, {stroke}, b); });
        ends([&, &b = brush] { common_area({mark}, {stroke}, b); });
        ends([&, &b = brush] { stroke_score(mark, stroke, b); });
        ends([&, &b = brush] { widest_points(mark, b); });
        ends([&, &b = brush] { io::write_brush(b); });
        for (const double x : kNumbers) {
            ends([&, &b = brush] { b.depth_for_half_width(x, ""); });
            ends([&, &b = brush] { footprint_at(b.footprints, x, 0.5); });
            ends([&, &b = brush] { footprint_at(b.footprints, 1.0, x); });
            ends([&, &b = brush] { make_law(pieces(b.lag, 0.0, x)); });
        }
    }
}

TEST_CASE("any stroke with a valid brush gives a result or Error") {
    const Brush brush = shipped("round-6"), pen = shipped("rigid");
    const PassMarks mark = marks()[0].second;
    for (const auto& [name, stroke] : strokes()) {
        CAPTURE(name);
        const Stroke& s = stroke;
        ends([&] { check(s); });
        for (const Brush* b : {&brush, &pen})
            for (const Compensation method : {Compensation::none, Compensation::constant, Compensation::closed})
                ends([&] { compensate(s, *b, {method}); });
        for (const double x : kNumbers) {
            ends([&] { flatten(s, x); });
            ends([&] { half_width_at(s, x); });
            ends([&] { arc_length(s.middle_mm, 0, 0.0, x); });
            ends([&] { point_at(s.middle_mm, {0, x}); });
            ends([&] { tangent_at(s.middle_mm, {5, x}); });
        }
        ends([&] { target_pieces(s, 0.01); });
        ends([&] { target_outline(s, 0.05); });
        ends([&] { target_coverage({s}, {0, 0, 40, 20}, 4.0); });
        ends([&] { mark_overlap({mark}, {s}, brush); });
        ends([&] { stroke_score(mark, s, brush); });
        ends([&] { tracking_error_of(passes()[1].second, s, brush, 0.05); });
        ends([&] { group_touching({s, s}); });
    }
}

TEST_CASE("any pass with a valid brush gives a result or Error") {
    const Brush brush = shipped("round-6"), pen = shipped("rigid");
    const Stroke stroke = strokes()[1].second;
    for (const auto& [name, pass] : passes()) {
        CAPTURE(name);
        const Pass& p = pass;
        for (const Brush* b : {&brush, &pen}) {
            ends([&] { simulate(p, *b); });
            ends([&] { simplify_pass(p, *b, 0.05); });
            ends([&] { tracking_error_of(p, stroke, *b, 0.05); });
            ends([&] { split_into_loads(p, *b, {10.0, 30.0, 5.0}); });
        }
        for (std::size_t k = 0; k < p.arcs.size(); ++k) ends([&] { check_arc(p, k, ""); });
        ends([&] { io::write_plan({"b", "", {100.0, 100.0}, {p}, "{}"}); });
    }
}

TEST_CASE("any marks with a valid brush give a result or Error") {
    const Brush brush = shipped("round-6");
    const Stroke stroke = strokes()[1].second;
    for (const auto& [name, mark] : marks()) {
        CAPTURE(name);
        const PassMarks& m = mark;
        ends([&] { outline(m, brush); });
        ends([&] { painted_bounds(m, brush); });
        ends([&] { widest_points(m, brush); });
        ends([&] { coverage(Marks{{m}, {}}, brush, {0, 0, 40, 20}, 4.0); });
        ends([&] { mark_overlap({m}, {stroke}, brush); });
        ends([&] { common_area({m}, {stroke}, brush); });
        ends([&] { stroke_score(m, stroke, brush); });
        ends([&] { io::write_marks({{m}, {}}); });
    }
}

TEST_CASE("any rings give a result or Error") {
    for (const auto& [name, rings] : many_rings()) {
        CAPTURE(name);
        const Rings& r = rings;
        ends([&] { unite(r); });
        ends([&] { area(r); });
        for (const FillRule rule : {FillRule::nonzero, FillRule::evenodd})
            ends([&] {
                const Rings filled = fill(r, rule);
                for (const double x : kNumbers) ends([&] { medial_axis(filled, x); });
            });
        ends([&] { pieces_between(r); });
        ends([&] { coverage(r, {0, 0, 20, 20}, 4.0); });
        ends([&] { coverage_of_pieces(r, {0, 0, 20, 20}, 4.0); });
        for (const auto& [other_name, other] : many_rings()) {
            ends([&, &o = other] { intersect(r, o); });
            ends([&, &o = other] { overlap(r, o); });
            for (const Ring& points : other) {
                ends([&] { clearance(r, points); });
                ends([&] { convex_hull(points); });
                ends([&] { is_convex(points); });
                ends([&] { widest_section(points); });
                ends([&] { signed_area(points); });
            }
        }
    }
}

TEST_CASE("any number as an argument gives a result or Error") {
    const Brush brush = shipped("round-6");
    const Stroke stroke = strokes()[1].second;
    const Pass pass = passes()[1].second;
    const PassMarks mark = marks()[0].second;
    const MarkOverlap seen = mark_overlap({mark}, {stroke}, brush);
    for (const double x : kNumbers) {
        CAPTURE(x);
        CompensateOptions options;
        options.tolerance_mm = x;
        ends([&] { compensate(stroke, brush, options); });
        options = {Compensation::constant, 0.05, x};
        ends([&] { compensate(stroke, brush, options); });
        options = {Compensation::closed, 0.05, {}, x};
        ends([&] { compensate(stroke, brush, options); });
        ends([&] { simulate(pass, brush, x); });
        ends([&] { simplify_pass(pass, brush, x); });
        ends([&] { tracking_error_of(pass, stroke, brush, x); });
        for (const double y : kNumbers) {
            ends([&] { split_into_loads(pass, brush, {x, y, 0.0}); });
            ends([&] { split_into_loads(pass, brush, {0.0, x, y}); });
            ends([&] { coverage(Marks{{mark}, {}}, brush, {x, 0, y, 20}, 4.0); });
            ends([&] { coverage(Rings{box(0, 0, 9, 9)}, {0, x, 20, y}, 4.0); });
            ends([&] { width_across(seen.painted, seen, {x, y}, {0, 1}, 2.0); });
            ends([&] { width_across(seen.painted, seen, {5, 5}, {x, y}, 2.0); });
            ends([&] { real_roots({x, y, 1.0}, -1.0, 1.0); });
            ends([&] { real_roots({-1.0, 0.0, 1.0}, x, y); });
            ends([&] { pieces(brush.tip_to_widest, x, y); });
            ends([&] { difference(brush.tip_to_widest, brush.tip_gap, x, y); });
            ends([&] {
                const LagLaw<double> law = make_law(pieces(brush.lag, 0.0, 10.0));
                LagState<double> state = touch_down<double>({0.0, 0.0});
                advance(law, Move<double>({0, 0}, {x, y}, 1.0, 5.0), state);
                advance(law, Move<double>({x, y}, {3, 0}, 5.0, 2.0), state);
                advance(law, Move<double>({0, 0}, {3, 0}, x, y), state);
            });
        }
        ends([&] { coverage(Marks{{mark}, {}}, brush, {0, 0, 40, 20}, x); });
        ends([&] { width_across(seen.painted, seen, {5, 5}, {0, 1}, x); });
        ends([&] { worst_place(seen, x); });
        ends([&] { fit_cubics(WideLine::Constant(5, 3, x), 0.05, false); });
        ends([&] { fit_cubics(WideLine::Random(50, 3), x, true); });
        ends([&] { bristle_deflection(bristle_coefficients(SlidingEnd::shear_free), x); });
    }
    ends([&] { real_roots(std::vector<double>(100000, 1.0), 0.0, 1.0); });
    ends([&] { make_law({}); });
    ends([&] { fit_cubics(WideLine(0, 3), 0.05, true); });
    ends([&] { worst_place({{0, 0, 1, 1}, 1.0, Coverage(0, 0), Coverage(0, 0)}, 1.0); });
    ends([&] { worst_place({{0, 0, 1, 1}, 1.0, Coverage::Zero(9, 9), Coverage::Zero(3, 3)}, 1.0); });
    ends([&] { common_area(MarkOverlap{{0, 0, 1, 1}, 1.0, Coverage::Zero(9, 9), Coverage::Zero(3, 3)}); });
}

TEST_CASE("an impossible footprint is refused when the file is checked") {
    Brush brush = shipped("round-6");
    brush.footprints.dragged.back().outline_mm(4, 0) = 5.5e9;
    brush.depth_range_mm[1] = 5.0;  // the last outline is beyond this depth and was not checked before
    CHECK_THROWS_AS(check(brush), Error);
}
