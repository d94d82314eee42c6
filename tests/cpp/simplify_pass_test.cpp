#include "brushsvg/simplify_pass.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <random>

#include "brushsvg/compensate.hpp"
#include "brushsvg/coverage.hpp"
#include "brushsvg/region.hpp"
#include "brushsvg/simulate.hpp"
#include "inverse/traced_pass.hpp"
#include "round6.hpp"

using namespace brushsvg;
using V = Eigen::Vector2d;

namespace {

double uniform(std::mt19937& random, double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
}

/// Return a chain of cubics with bends, some corners, and a changing width.
Stroke random_stroke(std::mt19937& random) {
    Stroke stroke;
    stroke.id = "s";
    const int count = 1 + int(random() % 4);
    stroke.middle_mm.resize(count, 8);
    V at(50, 50);
    double heading = uniform(random, -3, 3);
    for (int i = 0; i < count; ++i) {
        if (random() % 2) heading += uniform(random, -1.4, 1.4);
        const double turn = uniform(random, -1.2, 1.2), length = uniform(random, 3, 40);
        const V d0(std::cos(heading), std::sin(heading));
        const V chord(std::cos(heading + turn), std::sin(heading + turn));
        const V d1(std::cos(heading + 2 * turn), std::sin(heading + 2 * turn)), to = at + length * chord;
        stroke.middle_mm.row(i) << at.transpose(), (at + 0.35 * length * d0).transpose(),
            (to - 0.35 * length * d1).transpose(), to.transpose();
        at = to;
        heading += 2 * turn;
    }
    stroke.half_width = {{0.0, uniform(random, 0.2, 4.0)}, {0.6, uniform(random, 0.2, 4.0)}, {1.0, 1.5}};
    return stroke;
}

double deepest(const Pass& pass) { return -pass.poses_mm.col(2).minCoeff(); }

}  // namespace

TEST_CASE("fewer poses keep the mark within the tolerance, and its ends and depth unchanged") {
    const Brush brush = shipped("round-6");
    std::mt19937 random(7);
    long before = 0, after = 0;
    for (int k = 0; k < 120; ++k) {
        const Stroke stroke = random_stroke(random);
        const double tolerance = k % 3 ? 0.05 : 0.01;
        CompensateOptions options;
        options.tolerance_mm = tolerance;
        const CompensatedPass few = compensate(stroke, brush, options);
        options.few_poses = false;
        const CompensatedPass many = compensate(stroke, brush, options);
        CAPTURE(k);
        const double missed = many.tracking_error.largest_mm;
        CHECK(few.tracking_error.largest_mm <= (missed <= tolerance ? tolerance : missed + 0.1 * tolerance));
        CHECK(few.tracking_error.has_turn_in_place == many.tracking_error.has_turn_in_place);
        CHECK(deepest(few.pass) <= deepest(many.pass) + 1e-9);
        CHECK((few.pass.poses_mm.row(0) - many.pass.poses_mm.row(0)).norm() < tolerance);
        CHECK((few.pass.poses_mm.bottomRows(1) - many.pass.poses_mm.bottomRows(1)).norm() < tolerance);
        CHECK(overlap(outline(simulate(few.pass, brush), brush), outline(simulate(many.pass, brush), brush)) > 0.95);
        before += many.pass.poses_mm.rows();
        after += few.pass.poses_mm.rows();
    }
    CHECK(after < 0.55 * before);
}

TEST_CASE("a pass simplified twice stays close to itself, and keeps arcs, landings and lifts") {
    const Brush brush = shipped("round-6");
    Stroke stroke;
    stroke.id = "s";
    stroke.middle_mm = polyline({V(20, 20), V(60, 20), V(25, 45)});  // 145 degrees: an arc in place
    stroke.half_width = {{0.0, 2.0}};
    CompensateOptions options;
    options.few_poses = false;
    const Pass pass = compensate(stroke, brush, options).pass;
    const Pass thin = simplify_pass(pass, brush, 0.05);
    REQUIRE(!pass.arcs.empty());
    for (std::size_t k = 0; k < thin.arcs.size(); ++k) CHECK_NOTHROW(check_arc(thin, k, "s"));
    for (const Arc& turn : pass.arcs) {
        const auto kept = std::find_if(thin.arcs.begin(), thin.arcs.end(),
                                       [&](const Arc& arc) { return arc.centre_mm == turn.centre_mm; });
        REQUIRE(kept != thin.arcs.end());
        CHECK(kept->last - kept->first == turn.last - turn.first);
        CHECK(thin.poses_mm.row(kept->first) == pass.poses_mm.row(turn.first));
    }
    CHECK(thin.poses_mm.topRows(2) == pass.poses_mm.topRows(2));
    CHECK(thin.poses_mm.bottomRows(5) == pass.poses_mm.bottomRows(5));
    CHECK(simplify_pass(thin, brush, 0.05).poses_mm.rows() <= thin.poses_mm.rows());
}

TEST_CASE("a pen keeps its corners and its reversals with few poses") {
    const Brush pen = shipped("rigid");
    const auto kept = [&](const std::vector<V>& line, const std::vector<V>& corners) {
        const Stroke stroke = stroke_of(polyline(line), {{0.0, 0.5}});
        const Pass pass = compensate(stroke, pen, {}).pass;
        const auto passes = [&](const V& corner) {
            return ((pass.poses_mm.leftCols<2>().rowwise() - corner.transpose()).rowwise().norm().array() < 0.05).any();
        };
        return std::all_of(corners.begin(), corners.end(), passes);
    };
    const std::vector<std::vector<V>> lines = {{V(10, 10), V(40, 10), V(40, 40), V(10, 40), V(10, 10)},
                                               {V(10, 10), V(20, 10), V(15, 18), V(10, 10)},
                                               {V(10, 20), V(10, 10), V(2, 10), V(2, 20), V(9.99, 20)},
                                               {V(10, 10), V(60, 10), V(20, 10)}};
    for (const std::vector<V>& line : lines) CHECK(kept(line, line));
    // a spike on a line of many poses; the brush would smooth it out
    std::vector<V> spike{V(0, 10)};
    for (int k = 0; k < 120; ++k) {
        spike.push_back(V(0.5 * k + 0.5, 10));
        if (k == 77) spike.insert(spike.end(), {V(39, 12), V(39, 10)});
    }
    CHECK(kept(spike, {V(39, 12)}));
}

TEST_CASE("tight bends and cusps have no more poses than necessary") {
    const Brush brush = shipped("round-6");
    Cubics bends(3, 8);
    for (int k = 0; k < 3; ++k) {
        const double x = 20 + 9 * k;
        bends.row(k) << x, 30, x + 3, 38, x + 6, 22, x + 9, 30;
    }
    CHECK(compensate(stroke_of(bends, {{0.0, 0.5}}), brush, {}).pass.poses_mm.rows() < 250);  // originally 443
    const Cubics cusps = polyline({V(90, 50), V(100, 90), V(110, 50), V(120, 90), V(130, 50)});
    CHECK(compensate(stroke_of(cusps, {{0.0, 1.0}}), brush, {}).pass.poses_mm.rows() < 160);  // originally 189
}

TEST_CASE("a pass that cannot be simplified is accepted") {
    const Brush brush = shipped("round-6"), pen = shipped("rigid");
    Pass pass;
    pass.stroke = "s";
    CHECK(simplify_pass(pass, brush, 0.05).poses_mm.rows() == 0);
    pass.poses_mm.resize(3, 3);
    pass.poses_mm << 1, 1, 0, 1, 1, -3, 1, 1, 0;
    CHECK(simplify_pass(pass, brush, 0.05).poses_mm == pass.poses_mm);
    pass.poses_mm.resize(400, 3);
    for (int i = 0; i < 400; ++i)
        pass.poses_mm.row(i) << 40 * std::cos(i * 0.01), 40 * std::sin(i * 0.01), i % 399 ? -1.0 : 0.0;
    const Pass drawn = simplify_pass(pass, pen, 0.05);
    CHECK(drawn.poses_mm.rows() < 60);
    for (Eigen::Index i = 0; i < drawn.poses_mm.rows(); ++i)
        CHECK(std::abs(drawn.poses_mm.row(i).head<2>().norm() - 40.0) < 0.05);
}

TEST_CASE("edges without a direction of motion show nothing") {
    // Where no move kept the edges' direction, the edges were uninitialised memory, so plans differed from run to run.
    alignas(Edges) volatile unsigned char memory[sizeof(Edges)];
    for (volatile unsigned char& byte : memory) byte = 0x3f;
    const Edges* edges = new (const_cast<unsigned char*>(memory)) Edges;
    for (const int side : {0, 1}) {
        CHECK(!edges->is_visible[side]);
        CHECK(edges->direction[side].norm() == 0.0);
    }
}
