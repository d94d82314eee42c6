#include "brushsvg/paint_loads.hpp"

#include <cmath>

#include "brushsvg/compensate.hpp"
#include "brushsvg/coverage.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/region.hpp"
#include "brushsvg/simulate.hpp"
#include "round6.hpp"

using namespace brushsvg;

namespace {

/// Return a wave with a corner in its middle, at constant or increasing depth.
Pass wave(const Brush& brush, double half_width0, double half_width1) {
    Stroke stroke;
    stroke.id = "wave";
    stroke.middle_mm.resize(3, 8);
    stroke.middle_mm << 20, 40, 40, 80, 60, 0, 80, 40,  //
        80, 40, 90, 60, 100, 60, 110, 40,               //
        110, 40, 110, 60, 110, 80, 110, 100;
    stroke.half_width = {{0.0, half_width0}, {1.0, half_width1}};
    return compensate(stroke, brush).pass;
}

Rings painted(const std::vector<Pass>& passes, const Brush& brush) {
    Rings all;
    for (const Pass& pass : passes)
        for (const Ring& ring : outline(simulate(pass, brush), brush)) all.push_back(ring);
    return unite(all);
}

double length(const Pass& pass) {
    double sum = 0.0;
    for (Eigen::Index i = 1; i < pass.poses_mm.rows(); ++i)
        sum += (pass.poses_mm.row(i) - pass.poses_mm.row(i - 1)).norm();
    return sum;
}

}  // namespace

TEST_CASE("no gap shows where a stroke was interrupted") {
    const Brush brush = shipped("round-6");
    for (const auto& [h0, h1] : {std::pair{1.5, 1.5}, std::pair{0.8, 2.5}, std::pair{3.0, 0.6}}) {
        const Pass whole = wave(brush, h0, h1);
        const Rings meant = painted({whole}, brush);
        for (double every : {25.0, 40.0, 90.0}) {
            const std::vector<Pass> parts = split_into_loads(whole, brush, {every, every, 5.0});
            CHECK(parts.size() >= std::size_t(length(whole) / every));
            const Rings found = painted(parts, brush);
            CAPTURE(h0);
            CAPTURE(every);
            CHECK(found.size() == meant.size());
            CHECK(overlap(found, meant) > 0.995);
        }
    }
}

TEST_CASE("loads are no longer than the paint lasts, and are named and complete") {
    const Brush brush = shipped("round-6");
    const Pass whole = wave(brush, 1.5, 1.5);
    const std::vector<Pass> parts = split_into_loads(whole, brush, {15.0, 40.0, 5.0});
    REQUIRE(parts.size() >= 4);
    const double lift = 7.5;  // length of the lift, which goes back over its own patch
    CHECK(length(parts[0]) < 15.0 + lift);
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if (k > 0) CHECK(parts[k].stroke.name() == "wave+" + std::to_string(k + 1));
        CHECK(parts[k].load == int(k) + 1);
        if (k > 0) CHECK(length(parts[k]) < 40.0 + lift);
        CHECK(parts[k].poses_mm(0, 2) == 0.0);
        CHECK(parts[k].poses_mm(parts[k].poses_mm.rows() - 1, 2) == 0.0);
        CHECK(parts[k].speed_mm_s == whole.speed_mm_s);
    }
    CHECK(parts.front().stroke.name() == "wave");
    CHECK(parts.back().poses_mm.bottomRows<1>() == whole.poses_mm.bottomRows<1>());
}

TEST_CASE("a paint that lasts leaves the pass unchanged") {
    const Brush brush = shipped("round-6");
    const Pass whole = wave(brush, 1.5, 1.5);
    const std::vector<Pass> parts = split_into_loads(whole, brush, {1000.0, 1000.0, 5.0});
    REQUIRE(parts.size() == 1);
    CHECK(parts[0].poses_mm == whole.poses_mm);
    CHECK(parts[0].load == 0);
}

TEST_CASE("a straight line has possible stops between its few poses") {
    const Brush brush = shipped("round-6");
    Stroke stroke;
    stroke.id = "line";
    stroke.middle_mm.resize(1, 8);
    stroke.middle_mm << 20, 50, 140, 50, 260, 50, 380, 50;
    for (const double h : {0.2, 1.5}) {  // at the first depth the patch is tiny
        stroke.half_width = {{0.0, h}, {1.0, h}};
        const Pass whole = compensate(stroke, brush).pass;
        REQUIRE(whole.poses_mm.rows() < 20);
        const std::vector<Pass> parts = split_into_loads(whole, brush, {100.0, 100.0, 5.0});
        CHECK(parts.size() >= 4);
        for (const Pass& part : parts) {
            CHECK(length(part) < 100.0 + 7.0);
            CHECK(part.poses_mm.rows() < 30);
        }
        for (const Pass& part : parts)  // the direction between two nearly equal poses is arbitrary
            for (Eigen::Index i = 1; i < part.poses_mm.rows(); ++i)
                CHECK((part.poses_mm.row(i) - part.poses_mm.row(i - 1)).norm() > 1e-6);
        const Rings found = painted(parts, brush);
        CHECK(found.size() == 1);
        CHECK(overlap(found, painted({whole}, brush)) > 0.995);
    }
}

TEST_CASE("arcs stay whole in their load") {
    const Brush brush = shipped("round-6");
    Stroke stroke;
    stroke.id = "v";
    stroke.middle_mm.resize(2, 8);
    stroke.middle_mm << 20, 80, 30, 60, 40, 40, 50, 20, 50, 20, 46, 40, 42, 60, 38, 80;
    stroke.half_width = {{0.0, 1.5}, {1.0, 1.5}};
    const Pass whole = compensate(stroke, brush).pass;
    REQUIRE(whole.arcs.size() == 1);
    const Rings meant = painted({whole}, brush);
    for (double every = 20.0; every < 90.0; every += 3.0) {
        const std::vector<Pass> parts = split_into_loads(whole, brush, {every, every, 4.0});
        std::size_t arcs = 0;
        for (const Pass& part : parts) {
            for (std::size_t k = 0; k < part.arcs.size(); ++k) CHECK_NOTHROW(check_arc(part, k, ""));
            arcs += part.arcs.size();
        }
        CHECK(arcs >= 1);
        CHECK(overlap(painted(parts, brush), meant) > 0.99);
    }
}

TEST_CASE("a long bend is cut inside its arcs") {
    const Brush brush = shipped("round-6");
    Stroke stroke;
    stroke.id = "o";
    const double reach = 4.0 / 3.0 * std::tan(std::acos(-1.0) / 8.0);
    stroke.middle_mm.resize(4, 8);
    Eigen::Vector2d spoke(50, 0);
    for (int k = 0; k < 4; ++k) {
        const Eigen::Vector2d centre(100, 100), next(-spoke.y(), spoke.x());
        stroke.middle_mm.row(k) << (centre + spoke).transpose(), (centre + spoke + reach * next).transpose(),
            (centre + next + reach * spoke).transpose(), (centre + next).transpose();
        spoke = next;
    }
    stroke.half_width = {{0.0, 1.5}};
    const Pass whole = compensate(stroke, brush).pass;
    REQUIRE(!whole.arcs.empty());
    const std::vector<Pass> parts = split_into_loads(whole, brush, {60.0, 60.0, 4.0});
    CHECK(parts.size() >= 5);
    for (const Pass& part : parts) {
        for (std::size_t k = 0; k < part.arcs.size(); ++k) CHECK_NOTHROW(check_arc(part, k, ""));
        CHECK(length(part) < 60.0 + 12.0);
    }
    CHECK(overlap(painted(parts, brush), painted({whole}, brush)) > 0.99);
}

TEST_CASE("impossible lengths of paint are refused") {
    const Brush brush = shipped("round-6");
    const Pass whole = wave(brush, 1.5, 1.5);
    CHECK_THROWS_AS(split_into_loads(whole, brush, {10.0, 8.0, 5.0}), Error);
    CHECK_THROWS_AS(split_into_loads(whole, brush, {-1.0, 80.0, 5.0}), Error);
    CHECK_THROWS_AS(split_into_loads(whole, brush, {10.0, std::nan(""), 5.0}), Error);
}

TEST_CASE("a stroke of more than a thousand loads is refused") {
    const Brush brush = shipped("round-6");
    Pass line;
    line.poses_mm.resize(2, 3);
    line.poses_mm << 0, 0, -2, 150000, 0, -2;
    CHECK_THROWS_AS(split_into_loads(line, brush, {100.0, 100.0, 1.0}), Error);
}

TEST_CASE("a brush that turns in place is not interrupted") {
    const Brush brush = shipped("round-6");
    Stroke dot;
    dot.id = "dot";
    dot.middle_mm.resize(1, 8);
    dot.middle_mm << 50, 50, 50, 50, 50, 50, 50, 50;
    dot.half_width = {{0.0, 3.0}};
    CompensateOptions options;
    options.start = Terminal::round;
    const Pass whole = compensate(dot, brush, options).pass;
    REQUIRE(whole.arcs.size() == 1);
    REQUIRE(length(whole) > 30.0);
    for (const double first : {5.0, 15.0, 25.0}) CHECK(split_into_loads(whole, brush, {first, 80.0, 1.0}).size() == 1);
}

TEST_CASE("a brush that still trails loosely is not interrupted") {
    const Brush brush = shipped("round-6");
    Pass line;  // pressed on the spot: the patch rests until the lag is drawn out
    line.poses_mm.resize(4, 3);
    line.poses_mm << 10, 10, 0, 10, 10, -3, 70, 10, -3, 70, 10, 0;
    const std::vector<Pass> parts = split_into_loads(line, brush, {4.0, 40.0, 0.0});
    REQUIRE(parts.size() > 1);
    CHECK(parts[0].poses_mm.col(0).maxCoeff() > 10.0 + 0.95 * brush.lag(3.0));
}
