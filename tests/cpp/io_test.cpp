#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "brush_json.hpp"
#include "brushsvg/error.hpp"
#include "marks_json.hpp"
#include "plan_json.hpp"
#include "refusal.hpp"

using namespace brushsvg;

namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), by);
}

/// Return the Error that refuses a text. Fails the test if the text is accepted.
template <class Act>
Error refusal_of(Act act) {
    try {
        act();
    } catch (const Error& error) {
        return error;
    }
    FAIL("it was not refused");
    return Error("", "");
}

const std::string kBrush = R"({"format": "brushsvg/brush", "version": 1, "name": "flat", "depth_range_mm": [0, 4],
  "maker": {"b": 1, "a": [2e-5]},
  "lag": {"coefficients": [1, 0.1], "half_interval_95": [0.5, 0.1], "rmse_mm": 0.3, "degrees_of_freedom": 7, "calibrated_mm": [1, 4],
          "source": "ruler", "assumed": true, "note": "wet"},
  "tip_gap": {"coefficients": [0, 0.52]},
  "tip_to_widest": {"coefficients": [-2.35, 2.75], "floor": 0, "floor_slope": 0.126},
  "half_width": {"coefficients": [0, 0.42]},
  "covariance": [[1,0,0,0,0,0,0,0],[0,1,0,0,0,0,0,0],[0,0,1,0,0,0,0,0],[0,0,0,1,0,0,0,0],
                 [0,0,0,0,1,0,0,0],[0,0,0,0,0,1,0,0],[0,0,0,0,0,0,1,0],[0,0,0,0,0,0,0,1]],
  "footprints": {"glass": "matte",
                 "dragged": [{"depth_mm": 1, "outline_mm": [[0, 0], [1, -0.5], [1, 0.5]]},
                             {"depth_mm": 2, "outline_mm": [[0, 0], [2, -1], [2, 1]], "photo": "b.jpg"}],
                 "pressed": [{"depth_mm": 2, "outline_mm": [[0, 0], [1.5, -1], [1.5, 1]], "photo": "c.jpg"}]},
  "max_speed_mm_s": 30,
  "paint": {"narrows_per_m": 0.4, "lasts_mm": 600, "calibrated_mm": [0, 700], "source": "by eye", "assumed": true,
            "covariance": [[0.01, 0], [0, 400]], "degrees_of_freedom": 9, "medium": "ink"},
  "paint_depth_mm": 2})";

const std::string kPlan = R"({"format": "brushsvg/plan", "version": 1, "brush": "flat", "sheet_mm": [100, 50.5],
  "author": "me", "passes": [
    {"stroke": "a", "poses_mm": [[1, 2, 0], [3.5, 2, -1]], "speed_mm_s": 12.5, "layer": "ink", "colour": "#123456",
     "settings": {"dry": true, "order": -3}, "tilt": [[0, 1, 5, 5, -1]], "load": 2, "mood": "calm"},
    {"stroke": "b", "poses_mm": [[7, 8, -2]]}]})";

const std::string kArcs = R"({"format": "brushsvg/plan", "version": 1, "brush": "flat", "sheet_mm": [100, 50],
  "passes": [{"stroke": "a", "arcs": [[1, 3, 15, 10, 1], [3, 4, 12, 11, -1]],
              "poses_mm": [[13, 5, 0], [15, 5, -2], [20, 10, -2], [15, 15, -2], [16, 14, -2], [16, 12, 0]]}]})";

const std::string kMarks = R"({"format": "brushsvg/marks", "version": 1, "outline_mm": [[[0, 0], [1, 0], [0, 1]]],
  "passes": [{"stroke": "a", "pose": [0, 0.5, 1], "contact_mm": [[1, 2], [1.5, 2], [3, 2]],
              "heading_rad": [0, 0.25, -3], "depth_mm": [0, 1, -2], "taut": [false, true, true],
              "outline_mm": [[[0, 0], [4, 0], [0, 4]], [[1, 1], [1, 2], [2, 1]]]}]})";

struct Fault {
    const char *what, *by, *where, *code;
    std::vector<std::string> parts;  // numbers and names that the sentence must contain
};

}  // namespace

TEST_CASE("brush.json: every key is read into its field") {
    const Brush brush = io::read_brush(kBrush);
    CHECK(brush.name == "flat");
    CHECK(brush.depth_range_mm[1] == 4.0);
    CHECK_THROWS_AS(brush.lag.at(50.0), Error);
    CHECK(brush.lag.coefficients == std::vector<double>{1.0, 0.1});
    CHECK(brush.lag.half_interval_95 == std::vector<double>{0.5, 0.1});
    CHECK(*brush.lag.rmse_mm == 0.3);
    CHECK(*brush.lag.degrees_of_freedom == 7.0);
    CHECK((*brush.lag.calibrated_mm)[0] == 1.0);
    CHECK(brush.lag.source == "ruler");
    CHECK(brush.lag.assumed);
    CHECK_FALSE(brush.tip_gap.assumed);
    CHECK_FALSE(brush.tip_gap.rmse_mm.has_value());
    CHECK(brush.tip_gap.floor == -std::numeric_limits<double>::infinity());
    CHECK(brush.tip_to_widest(0.5) == doctest::Approx(0.063));  // floor + floor_slope d
    CHECK(brush.tip_to_widest(2.0) == doctest::Approx(3.15));
    CHECK(brush.covariance.size() == 8);
    CHECK(brush.covariance[7][7] == 1.0);
    REQUIRE(brush.footprints.dragged.size() == 2);
    CHECK(brush.footprints.dragged[1].depth_mm == 2.0);
    CHECK(brush.footprints.dragged[1].outline_mm(1, 1) == -1.0);
    REQUIRE(brush.footprints.pressed.size() == 1);
    CHECK(brush.max_speed_mm_s == 30.0);
    CHECK(brush.paint_depth_mm == 2.0);
    REQUIRE(brush.paint.has_value());
    CHECK(brush.paint->narrows_per_m == 0.4);
    CHECK(*brush.paint->lasts_mm == 600.0);
    CHECK((*brush.paint->calibrated_mm)[1] == 700.0);
    CHECK(brush.paint->source == "by eye");
    CHECK(brush.paint->assumed);
    CHECK(brush.paint->covariance[1][1] == 400.0);
    CHECK(*brush.paint->degrees_of_freedom == 9.0);
    CHECK(brush.paint->extra == R"({"medium":"ink"})");
    CHECK(brush.lag.extra == R"({"note":"wet"})");
    CHECK(brush.extra.find(R"("maker":{"b":1,"a":[2e-05]})") != std::string::npos);
}

TEST_CASE("brush.json: optional keys have the header's defaults") {
    std::string text = kBrush.substr(0, kBrush.find(",\n  \"max_speed")) + "}";
    text = replaced(text, "\"maker\"", "\"covariance_of_another\": 1, \"maker\"");
    const std::size_t from = text.find("\"covariance\""), to = text.find("\"footprints\"");
    const Brush brush = io::read_brush(text.erase(from, to - from));
    CHECK(brush.max_speed_mm_s == 25.0);
    CHECK(brush.paint_depth_mm == 0.0);
    CHECK(brush.kind.empty());
    CHECK(brush.covariance.empty());
    CHECK_FALSE(brush.paint.has_value());
}

TEST_CASE("brush.json: unknown keys of every level and every double are written back with equal bytes") {
    Brush brush = io::read_brush(kBrush);
    brush.lag.coefficients = {1.0 / 3.0, 5e-324, -1.7976931348623157e308, -0.0, 0.1 + 0.2};
    brush.lag.half_interval_95 = {};
    brush.covariance.clear();
    const std::string written = io::write_brush(brush);
    const Brush again = io::read_brush(written);
    CHECK(again.lag.coefficients == brush.lag.coefficients);
    CHECK(again.lag.source == "ruler");
    CHECK(again.lag.assumed);
    CHECK(again.paint->covariance == brush.paint->covariance);
    CHECK(*again.paint->lasts_mm == 600.0);
    CHECK(again.paint->extra == brush.paint->extra);
    CHECK(*again.lag.rmse_mm == 0.3);
    CHECK(*again.lag.degrees_of_freedom == 7.0);
    CHECK_FALSE(again.tip_gap.degrees_of_freedom.has_value());
    CHECK((*again.lag.calibrated_mm)[1] == 4.0);
    CHECK(again.tip_to_widest.floor == 0.0);
    CHECK(again.tip_to_widest.floor_slope == 0.126);
    CHECK(again.footprints.pressed[0].outline_mm == brush.footprints.pressed[0].outline_mm);
    CHECK(io::write_brush(io::read_brush(kBrush)).find("[0, 0, 0, 0, 0, 0, 0, 1]\n  ]") != std::string::npos);
    CHECK(io::write_brush(again) == written);
    CHECK(written.find("-0,") == std::string::npos);
    CHECK(written.find("e-324") == std::string::npos);
    for (const char* kept : {R"("note": "wet")", R"("maker": {"b":1,"a":[2e-05]})", R"("glass": "matte")",
                             R"("depth_mm": 2, "photo": "b.jpg")", R"("depth_mm": 2, "photo": "c.jpg")"}) {
        CAPTURE(kept);
        CHECK(written.find(kept) != std::string::npos);
    }
}

TEST_CASE("brush.json: each error is reported with its key") {
    const Fault faults[] = {
        {"\"brushsvg/brush\"", "\"brushsvg/plan\"", "format", "format-unknown", {"brushsvg/plan"}},
        {"\"brushsvg/brush\"", "7", "format", "wrong-type", {"7"}},
        {"\"version\": 1", "\"version\": 2", "version", "version-unknown", {"2", "brushsvg/brush"}},
        {"\"version\": 1", "\"version\": \"1\"", "version", "wrong-type", {}},
        {"\"version\": 1", "\"versiom\": 1", "version", "key-missing", {}},
        {"\"name\"", "\"nom\"", "name", "key-missing", {}},
        {"\"flat\"", "null", "name", "wrong-type", {"null"}},
        {"\"depth_range_mm\"", "\"x\"", "depth_range_mm", "key-missing", {}},
        {"[0, 4]", "[0]", "depth_range_mm", "wrong-type", {}},
        {"[0, 4]", "[4, 0]", "depth_range_mm", "not-ascending", {}},
        {"\"lag\"", "\"lagg\"", "lag", "key-missing", {}},
        {"\"tip_gap\": {\"coefficients\"", "\"tip_gap\": {\"c\"", "tip_gap.coefficients", "key-missing", {}},
        {"\"half_width\": {\"coefficients\": [0, 0.42]}", "\"half_width\": 3", "half_width", "wrong-type", {"3"}},
        {"[0, 0.52]", "[]", "tip_gap.coefficients", "law-terms", {}},
        {"[0, 0.52]", "[0, \"x\"]", "tip_gap.coefficients[1]", "wrong-type", {}},
        {"[0, 0.52]", "[0, NaN]", "tip_gap.coefficients[1]", "not-json", {"5", "35"}},
        {"[0, 0.52]", "[0, 1e999]", "tip_gap.coefficients[1]", "not-finite", {}},
        {"[0, 0.52]", "0.52", "tip_gap.coefficients", "wrong-type", {"0.52"}},
        {"\"floor\": 0, ", "", "tip_to_widest.floor_slope", "key-missing", {}},
        {"\"floor\": 0", "\"floor\": null", "tip_to_widest.floor", "wrong-type", {"null"}},
        {"\"assumed\": true", "\"assumed\": 1", "lag.assumed", "wrong-type", {}},
        {"[0.5, 0.1]", "[0.5]", "lag.half_interval_95", "sizes-differ", {"2"}},
        {"[[1,0,0,0,0,0,0,0]", "[[1,0,0,0,0,0,0]", "covariance[0]", "covariance-invalid", {"8"}},
        {"[[1,0,0,0,0,0,0,0],", "[", "covariance", "covariance-invalid", {"8", "7"}},
        {"\"narrows_per_m\": 0.4, ", "", "paint.narrows_per_m", "key-missing", {}},
        {"\"lasts_mm\": 600", "\"lasts_mm\": \"long\"", "paint.lasts_mm", "wrong-type", {}},
        {"[0, 700]", "[700, 0]", "paint.calibrated_mm", "not-ascending", {}},
        {"\"dragged\"", "\"dragger\"", "footprints.dragged", "key-missing", {}},
        {"\"depth_mm\": 1", "\"depth_mm\": 0", "footprints.dragged[0].depth_mm", "out-of-range", {"0"}},
        {"\"depth_mm\": 1", "\"depth_mm\": 2", "footprints.dragged[1].depth_mm", "not-ascending", {}},
        {"[1, -0.5], [1, 0.5]", "[1, -0.5]", "footprints.dragged[0].outline_mm", "footprint-invalid", {}},
        {"[2, -1], [2, 1]", "[2, -1], [2, 0], [2, 1]", "footprints.dragged[1].outline_mm", "footprint-invalid", {"4"}},
        {"[1.5, -1]", "[1.5, -1, 0]", "footprints.pressed[0].outline_mm[1]", "wrong-type", {}},
        {"[1.5, -1]", "[1.5, true]", "footprints.pressed[0].outline_mm[1][1]", "wrong-type", {"true"}},
        {"\"max_speed_mm_s\": 30", "\"max_speed_mm_s\": 0", "max_speed_mm_s", "out-of-range", {"0"}},
        {"\"name\"", "\"version\"", "version", "key-twice", {}},
        {"\"paint_depth_mm\": 2}", "\"paint_depth_mm\": 2", "paint_depth_mm", "not-json", {}},
    };
    for (const Fault& fault : faults) {
        CAPTURE(fault.by);
        CHECK(agrees(refusal([&] { io::read_brush(replaced(kBrush, fault.what, fault.by)); }), fault.code, fault.where,
                     fault.parts));
    }
}

TEST_CASE("brush.json: every truncation is refused") {
    for (std::size_t length = 0; length < kBrush.size(); ++length) {
        CAPTURE(length);
        CHECK_THROWS_AS(io::read_brush(kBrush.substr(0, length)), Error);
    }
}

TEST_CASE("brush.json: values that cannot be read back are not written") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    const auto refused = [](auto change) {
        Brush brush = io::read_brush(kBrush);
        change(brush);
        return refusal_of([&] { io::write_brush(brush); }).where();
    };
    CHECK(refused([&](Brush& b) { b.lag.coefficients[1] = nan; }) == "lag");
    CHECK(refused([&](Brush& b) { b.half_width.rmse_mm = infinity; }) == "half_width");
    CHECK(refused([&](Brush& b) { b.tip_gap.floor = infinity; }) == "tip_gap");
    CHECK(refused([&](Brush& b) { b.max_speed_mm_s = infinity; }) == "max_speed_mm_s");
    CHECK(refused([&](Brush& b) { b.footprints.dragged[0].outline_mm(1, 1) = nan; }) == "outline_mm");
    CHECK(refused([&](Brush& b) { b.name = "\xff"; }) == "name");
    CHECK(refused([&](Brush& b) { b.extra = "[]"; }) == "extra");
    CHECK(refused([&](Brush& b) { b.extra = "{\"a\": "; }) == "extra");
    CHECK(refused([&](Brush& b) { b.extra = "{\"footprints\": 1}"; }) == "extra.footprints");
    CHECK(refused([&](Brush& b) { b.lag.extra = "{\"rmse_mm\": 1}"; }) == "lag.extra");
    CHECK(refused([&](Brush& b) { b.footprints.dragged.clear(); }) == "footprints.dragged");
}

TEST_CASE("plan.json: every key is read and written back") {
    const Plan plan = io::read_plan(kPlan);
    CHECK(plan.brush == "flat");
    CHECK(plan.brush_sha256.empty());
    CHECK(plan.sheet_mm == std::array<double, 2>{100.0, 50.5});
    CHECK(plan.extra == R"({"author":"me"})");
    REQUIRE(plan.passes.size() == 2);
    const Pass& pass = plan.passes[0];
    CHECK(pass.stroke.name() == "a");
    CHECK(pass.poses_mm.rows() == 2);
    CHECK(pass.poses_mm(1, 0) == 3.5);
    CHECK(pass.poses_mm(1, 2) == -1.0);
    CHECK(pass.speed_mm_s == 12.5);
    CHECK(pass.layer == "ink");
    CHECK(pass.colour == "#123456");
    CHECK(pass.settings.order == -3);
    CHECK(!pass.settings.passes);
    CHECK(pass.settings.extra == R"({"dry":true})");
    CHECK(pass.load == 2);
    CHECK(pass.extra == R"({"tilt":[[0,1,5,5,-1]],"mood":"calm"})");
    CHECK(plan.passes[1].load == 0);
    CHECK(plan.passes[1].speed_mm_s == 20.0);
    CHECK(!plan.passes[1].settings.order);
    CHECK(plan.passes[1].settings.extra == "{}");
    CHECK(plan.passes[1].poses_mm(0, 2) == -2.0);
    CHECK(io::write_plan(plan) == R"({
  "format": "brushsvg/plan",
  "version": 1,
  "brush": "flat",
  "brush_sha256": "",
  "sheet_mm": [100, 50.5],
  "author": "me",
  "passes": [
    {"stroke": "a", "speed_mm_s": 12.5, "layer": "ink", "colour": "#123456", "settings": {"order":-3,"dry":true},
     "tilt": [[0,1,5,5,-1]],
     "mood": "calm",
     "load": 2,
     "poses_mm": [[1, 2, 0], [3.5, 2, -1]]},
    {"stroke": "b", "speed_mm_s": 20, "layer": "", "colour": "", "settings": {},
     "poses_mm": [[7, 8, -2]]}
  ]
}
)");
}

TEST_CASE("plan.json: each error is reported with its key") {
    const Fault faults[] = {
        {"[3.5, 2, -1]", "[3.5, 2, 1.5]", "passes[0].poses_mm[1]", "above-paper", {"1", "a", "1.5"}},
        {"[3.5, 2, -1]", "[3.5, 2, 1e-300]", "passes[0].poses_mm[1]", "above-paper", {"0"}},
        {"[3.5, 2, -1]", "[3.5, 2]", "passes[0].poses_mm[1]", "wrong-type", {"[x, y, z]", "2"}},
        {"[1, 2, 0]", "[1, 2, 0, 0]", "passes[0].poses_mm[0]", "wrong-type", {"[x, y, z]", "4"}},
        {"[3.5, 2, -1]", "5", "passes[0].poses_mm[1]", "wrong-type", {"[x, y, z]", "5"}},
        {"[3.5, 2, -1]", "[3.5, \"2\", -1]", "passes[0].poses_mm[1][1]", "wrong-type", {}},
        {"[3.5, 2, -1]", "[3.5, [[1, 2, 3]], -1]", "passes[0].poses_mm[1][1]", "wrong-type", {}},
        {"[3.5, 2, -1]", "[3.5, 2, -Infinity]", "passes[0].poses_mm[1][2]", "not-json", {"3"}},
        {"[[7, 8, -2]]", "[]", "passes[1].poses_mm", "pass-empty", {"b"}},
        {"[[7, 8, -2]]", "{}", "passes[1].poses_mm", "wrong-type", {}},
        {"\"poses_mm\": [[7", "\"poses\": [[7", "passes[1].poses_mm", "key-missing", {}},
        {"\"stroke\": \"b\"", "\"id\": \"b\"", "passes[1].stroke", "key-missing", {}},
        {"\"stroke\": \"b\"", "\"stroke\": 4", "passes[1].stroke", "wrong-type", {"4"}},
        {"12.5", "0", "passes[0].speed_mm_s", "out-of-range", {"0"}},
        {"12.5", "2e6", "passes[0].speed_mm_s", "out-of-range", {"1e6", "2000000"}},
        {"[3.5, 2, -1]", "[3.5, 2e6, -1]", "passes[0].poses_mm[1]", "geometry-out-of-range", {"[-1e6, 1e6]"}},
        {"{\"dry\": true, \"order\": -3}", "[]", "passes[0].settings", "wrong-type", {}},
        {"\"order\": -3", "\"order\": \"x\"", "passes[0].settings.order", "wrong-type", {}},
        {"\"order\": -3", "\"order\": 1.5", "passes[0].settings.order", "wrong-type", {"1.5"}},
        {"[100, 50.5]", "[100, 0]", "sheet_mm", "out-of-range", {"(0, 1e6]", "0"}},
        {"[100, 50.5]", "[100, 1e300]", "sheet_mm", "out-of-range", {"(0, 1e6]", "1e+300"}},
        {"[100, 50.5]", "[100]", "sheet_mm", "wrong-type", {}},
        {"\"passes\": [", "\"passes\": [3, ", "passes[0]", "wrong-type", {"3"}},
        {"\"passes\"", "\"parts\"", "passes", "key-missing", {}},
        {"\"brush\":", "\"brosse\":", "brush", "key-missing", {}},
        {"\"load\": 2", "\"load\": \"2\"", "passes[0].load", "wrong-type", {}},
        {"\"load\": 2", "\"load\": 1.5", "passes[0].load", "wrong-type", {"1.5"}},
        {"\"load\": 2", "\"load\": -1", "passes[0].load", "out-of-range", {"a", "0", "-1"}},
        {"\"mood\"", "\"poses_mm\"", "passes[0].poses_mm", "key-twice", {}},
    };
    for (const Fault& fault : faults) {
        CAPTURE(fault.by);
        CHECK(agrees(refusal([&] { io::read_plan(replaced(kPlan, fault.what, fault.by)); }), fault.code, fault.where,
                     fault.parts));
    }
    const Error high = refusal_of([&] { io::read_plan(replaced(kPlan, "[3.5, 2, -1]", "[3.5, 2, 1.5]")); });
    CHECK(*high.value() == 1.5);
    CHECK((*high.range())[1] == 0.0);
}

TEST_CASE("plan.json: arcs are read, and written back as the last key of the pass") {
    const Plan plan = io::read_plan(kArcs);
    const std::vector<Arc>& arcs = plan.passes[0].arcs;
    REQUIRE(arcs.size() == 2);
    CHECK(arcs[0].first == 1);
    CHECK(arcs[0].last == 3);
    CHECK(arcs[0].centre_mm == Eigen::Vector2d(15.0, 10.0));
    CHECK(arcs[0].direction == 1);
    CHECK(arcs[1].first == 3);
    CHECK(arcs[1].direction == -1);
    const std::string written = io::write_plan(plan);
    CHECK(written.find("\"settings\": {},\n     \"arcs\": [[1, 3, 15, 10, 1], [3, 4, 12, 11, -1]],\n"
                       "     \"poses_mm\"") != std::string::npos);
    CHECK(io::write_plan(io::read_plan(written)) == written);
    const std::string none = replaced(kArcs, "[[1, 3, 15, 10, 1], [3, 4, 12, 11, -1]]", "[]");
    CHECK(io::write_plan(io::read_plan(none)).find("arcs") == std::string::npos);
}

TEST_CASE("plan.json: an invalid arc is refused with its number") {
    const char *first = "[1, 3, 15, 10, 1]", *second = "[3, 4, 12, 11, -1]", *one = "passes[0].arcs[0]",
               *two = "passes[0].arcs[1]";
    const Fault faults[] = {
        {"[[1, 3, 15, 10, 1], [3, 4, 12, 11, -1]]", "{}", "passes[0].arcs", "wrong-type", {}},
        {first, "7", one, "wrong-type", {"7"}},
        {first, "[1, 3, 15, 10]", one, "wrong-type", {"4"}},
        {first, "[1, 3, 15, \"10\", 1]", "passes[0].arcs[0][3]", "wrong-type", {}},
        {first, "[1, 2.5, 15, 10, 1]", "passes[0].arcs[0][1]", "wrong-type", {"2.5"}},
        {first, "[1, 1e300, 15, 10, 1]", "passes[0].arcs[0][1]", "wrong-type", {"1e+300"}},
        {first, "[1, 3, 15, 10, 0.5]", "passes[0].arcs[0][4]", "wrong-type", {"0.5"}},
        {first, "[1, 3, 15, 10, 2]", one, "arc-invalid", {"0", "a", "2", "1", "-1"}},
        {first, "[1, 3, 15, 10, -1]", one, "arc-invalid", {"clockwise", "1", "2", "180"}},
        {first, "[-1, 3, 15, 10, 1]", one, "arc-invalid", {"0", "a", "-1", "3", "5"}},
        {second, "[3, 6, 12, 11, -1]", two, "arc-invalid", {"1", "a", "3", "6", "0", "5"}},
        {first, "[3, 3, 15, 10, 1]", one, "arc-invalid", {"3"}},
        {second, "[2, 4, 12, 11, -1]", two, "arc-invalid", {"2", "3"}},
        {first, "[1, 3, 15, 10.01, 1]", one, "arc-invalid", {"2", "-0.00999", "5.01"}},
        {first, "[0, 3, 15, 10, 1]", one, "arc-invalid", {"1", "-0.385165", "5.38516"}},
        {first, "[1, 3, 15, 5, 1]", one, "arc-invalid", {"0", "[0.1, 1e+06]"}},
        {first, "[1, 3, 15, 2e6, 1]", one, "arc-invalid", {"2e+06"}},
        {"[20, 10, -2]", "[20, 10, -2.1]", one, "arc-invalid", {"-2", "1", "-2.1", "2"}},
        {"[20, 10, -2]", "[15, 5, -2]", one, "arc-invalid", {"counter-clockwise", "1", "2"}},
        {"[20, 10, -2]", "[15, 15, -2]", one, "arc-invalid", {"counter-clockwise", "1", "2", "180"}},
    };
    for (const Fault& fault : faults) {
        CAPTURE(fault.by);
        CHECK(agrees(refusal([&] { io::read_plan(replaced(kArcs, fault.what, fault.by)); }), fault.code, fault.where,
                     fault.parts));
    }
    Plan plan = io::read_plan(kArcs);
    plan.passes[0].arcs[1].direction = 1;
    CHECK(refusal_of([&] { io::write_plan(plan); }).where() == "passes[0].arcs[1]");
}

TEST_CASE("plan.json: a z of 0 or below is accepted anywhere, including the ends") {
    CHECK(io::read_plan(replaced(kPlan, "[1, 2, 0]", "[1, 2, -3]")).passes[0].poses_mm(0, 2) == -3.0);
    CHECK(io::read_plan(replaced(kPlan, "[3.5, 2, -1]", "[3.5, 2, -0.0]")).passes[0].poses_mm(1, 2) == 0.0);
}

TEST_CASE("plan.json: numbers are plain decimals rounded to 1e-7") {
    Plan plan = io::read_plan(kPlan);
    plan.passes.resize(1);
    plan.passes[0].poses_mm.resize(3, 3);
    plan.passes[0].poses_mm << 1.0 / 3.0, -2.77e-17, -1e-12, 1e6 / 3.0, 123.45678949, -0.1, 4e-8, -7e-8, 1e-17;
    const std::string written = io::write_plan(plan);
    CHECK(written.find("[[0.3333333, 0, 0], [333333.3333333, 123.4567895, -0.1], [0, -0.0000001, 0]]") !=
          std::string::npos);
    CHECK(io::write_plan(io::read_plan(written)) == written);
}

TEST_CASE("plan.json: values that cannot be read back are not written") {
    const auto refused = [](auto change) {
        Plan plan = io::read_plan(kPlan);
        change(plan);
        return refusal_of([&] { io::write_plan(plan); }).where();
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(refused([&](Plan& p) { p.passes[1].poses_mm(0, 1) = nan; }) == "passes[1].poses_mm[0]");
    CHECK(refused([&](Plan& p) { p.passes[0].poses_mm(1, 2) = 0.01; }) == "passes[0].poses_mm[1]");
    CHECK(refused([&](Plan& p) { p.passes[0].poses_mm.resize(0, 3); }) == "passes[0].poses_mm");
    CHECK(refused([&](Plan& p) { p.passes[0].speed_mm_s = nan; }) == "passes[0].speed_mm_s");
    CHECK(refused([&](Plan& p) { p.passes[0].settings.extra = "7"; }) == "passes[0].settings.extra");
    CHECK(refused([&](Plan& p) { p.passes[0].settings.extra = "{\"order\": 1}"; }) == "passes[0].settings.extra");
    CHECK(refused([&](Plan& p) { p.passes[0].settings.width_mm = nan; }) == "passes[0].settings.width_mm");
    CHECK(refused([&](Plan& p) { p.passes[0].settings.brush = "\xc3"; }) == "passes[0].settings");
    CHECK(refused([&](Plan& p) { p.passes[0].extra = "{\"stroke\": 1}"; }) == "passes[0].extra");
    CHECK(refused([&](Plan& p) { p.passes[0].extra = "{\"load\": 3}"; }) == "passes[0].extra");
    CHECK(refused([&](Plan& p) { p.passes[0].load = -1; }) == "passes[0].load");
    CHECK(refused([&](Plan& p) { p.passes[0].layer = "\xc3"; }) == "passes[0].layer");
    CHECK(refused([&](Plan& p) { p.sheet_mm = {0.0, 10.0}; }) == "sheet_mm");
}

TEST_CASE("plan.json: long passes are broken into lines and read back completely") {
    Plan plan = io::read_plan(kPlan);
    Poses& poses = plan.passes[0].poses_mm;
    poses.resize(20000, 3);
    for (Eigen::Index i = 0; i < poses.rows(); ++i) {
        const double t = 0.01 * double(i);
        poses.row(i) << 50.0 * std::sin(t), 20.0 * std::cos(1.7 * t), -2.0 + std::sin(3.0 * t);
    }
    const std::string written = io::write_plan(plan);
    std::size_t longest = 0;
    for (std::size_t from = 0, to; (to = written.find('\n', from)) != std::string::npos; from = to + 1) {
        longest = std::max(longest, to - from);
    }
    CHECK(longest <= 120);
    CHECK(longest >= 80);
    const Plan again = io::read_plan(written);
    REQUIRE(again.passes[0].poses_mm.rows() == poses.rows());
    CHECK((again.passes[0].poses_mm - poses).cwiseAbs().maxCoeff() <= 0.5e-7 + 1e-12);
}

TEST_CASE("marks.json: rows and rings are read and written back") {
    const Marks marks = io::read_marks(kMarks);
    REQUIRE(marks.passes.size() == 1);
    const PassMarks& pass = marks.passes[0];
    CHECK(pass.stroke == "a");
    CHECK(pass.pose == std::vector<double>{0.0, 0.5, 1.0});
    CHECK(pass.contact_mm(1, 0) == 1.5);
    CHECK(pass.heading_rad[2] == -3.0);
    CHECK(pass.depth_mm[2] == -2.0);
    CHECK(pass.taut == std::vector<unsigned char>{0, 1, 1});
    CHECK(pass.tcp_mm.rows() == 0);
    CHECK(pass.pull == std::vector<double>{1.0, 1.0, 1.0});
    REQUIRE(pass.outline_mm.size() == 2);
    CHECK(pass.outline_mm[1](2, 0) == 2.0);
    CHECK(marks.outline_mm[0](1, 0) == 1.0);
    CHECK(io::write_marks(marks) == R"({
  "format": "brushsvg/marks",
  "version": 1,
  "outline_mm": [
    [[0, 0], [1, 0], [0, 1]]],
  "passes": [
    {"stroke": "a",
     "pose": [0, 0.5, 1],
     "contact_mm": [[1, 2], [1.5, 2], [3, 2]],
     "heading_rad": [0, 0.25, -3],
     "depth_mm": [0, 1, -2],
     "taut": [false, true, true],
     "outline_mm": [
       [[0, 0], [4, 0], [0, 4]],
       [[1, 1], [1, 2], [2, 1]]]}
  ]
}
)");
}

TEST_CASE("marks.json: each error is reported with its key") {
    const Fault faults[] = {
        {"[0, 0.5, 1]", "[0, 0.5]", "passes[0].contact_mm", "sizes-differ", {"a", "3", "2"}},
        {"[0, 0.25, -3]", "[0]", "passes[0].heading_rad", "sizes-differ", {"a", "1", "3"}},
        {"[0, 1, -2]", "[0, 1, -2, 3]", "passes[0].depth_mm", "sizes-differ", {"a", "4", "3"}},
        {"[false, true, true]", "[]", "passes[0].taut", "sizes-differ", {"a", "0", "3"}},
        {"[false, true, true]", "[0, 1, 1]", "passes[0].taut[0]", "wrong-type", {"0"}},
        {"[1.5, 2]", "[1.5]", "passes[0].contact_mm[1]", "wrong-type", {"[x, y]", "1"}},
        {"[4, 0]", "[4, null]", "passes[0].outline_mm[0][1][1]", "wrong-type", {"null"}},
        {"[[0, 0], [1, 0], [0, 1]]", "3", "outline_mm[0]", "wrong-type", {"[x, y]", "3"}},
        {"\"stroke\"", "\"s\"", "passes[0].stroke", "key-missing", {}},
        {"\"version\": 1", "\"version\": 9", "version", "version-unknown", {"9", "brushsvg/marks"}},
    };
    for (const Fault& fault : faults) {
        CAPTURE(fault.by);
        CHECK(agrees(refusal([&] { io::read_marks(replaced(kMarks, fault.what, fault.by)); }), fault.code, fault.where,
                     fault.parts));
    }
    Marks marks = io::read_marks(kMarks);
    marks.passes[0].taut.pop_back();
    CHECK(refusal_of([&] { io::write_marks(marks); }).where() == "passes[0].taut");
    marks = io::read_marks(kMarks);
    marks.passes[0].heading_rad[1] = std::numeric_limits<double>::quiet_NaN();
    CHECK(refusal_of([&] { io::write_marks(marks); }).where() == "heading_rad");
}

TEST_CASE("any reader refuses text that is not an object, not UTF-8, or nested too deeply") {
    CHECK(agrees(refusal([] { io::read_marks("[]"); }), "wrong-type", ""));
    CHECK(agrees(refusal([] { io::read_plan("{\"format\": \"\xff\"}"); }), "not-json", "format"));
    const std::string deep = "{\"a\": " + std::string(500000, '[') + std::string(500000, ']') + "}";
    CHECK(agrees(refusal([&] { io::read_plan(deep); }), "not-json", "a", {"100"}));
    const std::string two_lines = "{\"format\": \"brushsvg/plan\",\n \"brush\" 1}";
    CHECK(agrees(refusal([&] { io::read_plan(two_lines); }), "not-json", "brush", {"2", "10"}));
}
