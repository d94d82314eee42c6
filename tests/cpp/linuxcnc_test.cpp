#include "linuxcnc.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <string>

#include "brush_json.hpp"
#include "brushsvg/error.hpp"
#include "plan_json.hpp"

using namespace brushsvg;

namespace {

std::string file(const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    REQUIRE(!text.str().empty());
    return text.str();
}

const Brush& round6() {
    static const Brush brush = io::read_brush(file(std::string(BRUSHES_DIR) + "/round-6.json"));
    return brush;
}

Plan golden_plan() { return io::read_plan(file(std::string(GOLDEN_DIR) + "/flat_machine.plan.json")); }

std::string code_of(const std::function<void(Plan&, Brush&, posts::FlatCell&)>& change) {
    Plan plan = golden_plan();
    Brush brush = round6();
    posts::FlatCell cell;
    change(plan, brush, cell);
    try {
        posts::linuxcnc(plan, brush, cell);
    } catch (const Error& error) {
        return error.code();
    }
    return "";
}

}  // namespace

TEST_CASE("the program equals the golden file that Python is compared with") {
    CHECK(posts::linuxcnc(golden_plan(), round6()) == file(std::string(GOLDEN_DIR) + "/flat_machine.ngc"));
}

TEST_CASE("a machine with other numbers and another name is written") {
    Plan plan = golden_plan();
    Brush brush = round6();
    plan.brush = brush.name = "B\xC3\xBCrste u\xCC\x88\xC3\xB8";
    posts::FlatCell cell;
    cell.safe_mm = 15.0;
    cell.clearance_mm = 2.0;
    cell.approach_mm_s = 20.0;
    cell.press_mm_s = 5.0;
    cell.paint_mm_s = 40.0;
    cell.travel_mm_s = 8.0;
    cell.acceleration_mm_s2 = 300.0;
    cell.blending_mm = 0.0;
    cell.name = "bench";
    CHECK(posts::linuxcnc(plan, brush, cell,
                          "Wei\xC3\x9F\t(\xC5\x81\xC3\xB3"
                          "d\xC5\xBA)") == file(std::string(GOLDEN_DIR) + "/flat_bench.ngc"));
}

TEST_CASE("values that would misguide a machine are refused") {
    using posts::FlatCell;
    const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
    CHECK(code_of([](Plan&, Brush&, FlatCell&) {}) == "");
    CHECK(code_of([](Plan& plan, Brush&, FlatCell&) { plan.passes.clear(); }) == "nothing-to-paint");
    CHECK(code_of([](Plan& plan, Brush&, FlatCell&) { plan.passes[0].poses_mm.resize(0, 3); }) == "pass-empty");
    CHECK(code_of([](Plan&, Brush& brush, FlatCell&) { brush.name = "mine"; }) == "options-contradict");
    CHECK(code_of([](Plan& plan, Brush&, FlatCell&) {
              plan.passes[2].tool_axes = Poses::Zero(plan.passes[2].poses_mm.rows(), 3);
              plan.passes[2].tool_axes.rowwise() = Eigen::RowVector3d(0.6, 0.0, 0.8);
          }) == "tilt-unsupported");
    CHECK(code_of([](Plan& plan, Brush&, FlatCell&) { plan.sheet_mm = {0.0, 50.0}; }) == "out-of-range");
    CHECK(code_of([](Plan& plan, Brush&, FlatCell&) { plan.sheet_mm = {50.0, 120.0}; }) == "out-of-range");
    CHECK(code_of([](Plan& plan, Brush&, FlatCell&) { plan.passes[0].arcs[0].centre_mm.x() += 1.0; }) == "arc-invalid");
    CHECK(code_of([](Plan& plan, Brush&, FlatCell&) { plan.passes[2].poses_mm.col(2).setZero(); }) == "never-pressed");
    for (const double value : {nan, inf, -inf}) {
        CHECK(code_of([=](Plan& plan, Brush&, FlatCell&) { plan.passes[2].poses_mm(1, 0) = value; }) != "");
        CHECK(code_of([=](Plan& plan, Brush&, FlatCell&) { plan.passes[2].speed_mm_s = value; }) == "out-of-range");
        for (double FlatCell::* field :
             {&FlatCell::safe_mm, &FlatCell::clearance_mm, &FlatCell::lowest_mm, &FlatCell::margin_mm,
              &FlatCell::approach_mm_s, &FlatCell::press_mm_s, &FlatCell::paint_mm_s, &FlatCell::blending_mm,
              &FlatCell::travel_mm_s, &FlatCell::acceleration_mm_s2})
            CHECK(code_of([=](Plan&, Brush&, FlatCell& cell) { cell.*field = value; }) == "out-of-range");
    }
    CHECK(code_of([](Plan&, Brush&, FlatCell& cell) { cell.name.clear(); }) == "name-invalid");
    for (const double z : {0.1, -10.5, -25.0})
        CHECK(code_of([=](Plan& plan, Brush&, FlatCell&) { plan.passes[2].poses_mm(1, 2) = z; }) == "out-of-range");
    for (const double speed : {0.0, -1.0, 26.0})
        CHECK(code_of([=](Plan& plan, Brush&, FlatCell&) { plan.passes[2].speed_mm_s = speed; }) == "out-of-range");
}

TEST_CASE("only the part of a circle that is run must be inside the margin of the sheet") {
    const double c = 20.0 * std::cos(1.0), s = 20.0 * std::sin(1.0);
    const auto plan_of = [](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
        Plan plan;
        plan.brush = "round-6";
        plan.sheet_mm = {100.0, 60.0};
        Pass pass;
        pass.stroke = StrokeId("o");
        pass.poses_mm.resize(2, 3);
        pass.poses_mm << from.transpose(), -2, to.transpose(), -2;
        pass.arcs = {{0, 1, {115, 30}, 1}};
        plan.passes = {pass};
        return plan;
    };
    const Plan right = plan_of({115 + c, 30 - s}, {115 + c, 30 + s});  // reaches x = 135, but its poses are inside
    CHECK_THROWS_AS(posts::linuxcnc(right, round6()), Error);
    posts::FlatCell cell;
    cell.margin_mm = 36.0;
    CHECK(posts::linuxcnc(right, round6(), cell).find("G3") != std::string::npos);
    const Plan left = plan_of({115 - c, 30 + s}, {115 - c, 30 - s});  // the other part of the circle
    CHECK(posts::linuxcnc(left, round6()).find("G3") != std::string::npos);
}

TEST_CASE("the slowest speed is a millionth of a millimetre in a second") {
    const auto at = [](double speed) {
        return code_of([=](Plan&, Brush&, posts::FlatCell& cell) { cell.travel_mm_s = speed; });
    };
    CHECK(at(1.5e-6) == "");
    CHECK(at(0.5e-6) == "out-of-range");
}

TEST_CASE("a long comment is cut, and its unreadable characters are replaced") {
    Plan plan = golden_plan();
    plan.passes[0].stroke = StrokeId(std::string(150, 'a'));
    plan.passes[1].stroke = StrokeId(
        "b\x01\x7F\xCD\xAF"
        "c");  // U+036F: an accent without a letter
    const std::string text = posts::linuxcnc(plan, round6());
    const std::string begin = "(stroke 1 of 3: ";
    CHECK(text.find(begin + std::string(118 + 1 - begin.size() - 3, 'a') + "...)\n") != std::string::npos);
    CHECK(text.find("(stroke 2 of 3: b??c)\n") != std::string::npos);
}

TEST_CASE("a comment cannot become a command") {
    Plan plan = golden_plan();
    plan.passes[0].stroke = StrokeId("a) M2\n(\xC3\xA9");
    const std::string text = posts::linuxcnc(plan, round6());
    CHECK(text.find("(stroke 1 of 3: a] M2 [e)\n") != std::string::npos);
}
