#include "marks/follow_lag.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "brushsvg/simulate.hpp"
#include "refusal.hpp"
#include "round6.hpp"

using namespace brushsvg;
using Eigen::Index;

namespace {

/// Return a pass with a line, a circle's arc and a corner. The brush is set down, lifted, set down on the way, and
/// lifted on the spot.
Pass pass_with_arc() {
    Pass pass;
    pass.stroke = "s";
    pass.poses_mm.resize(9, 3);
    const double turn = 0.8, radius = 12.0;
    pass.poses_mm << 0, 0, -1, 10, 0, -4, 10 + radius * std::sin(turn), radius * (1 - std::cos(turn)), -4,
        10 + radius * std::sin(2 * turn), radius * (1 - std::cos(2 * turn)), -4, 15, 20, -2, 12, 22, 3, 8, 22, 2, 0, 20,
        -3, -6, 15, -3;
    pass.arcs.push_back({1, 3, {10.0, radius}, 1});
    return pass;
}

LagLaw<double> law_of(const Brush& brush) {
    return make_law(pieces(brush.lag, brush.depth_range_mm[0], brush.depth_range_mm[1]));
}

}  // namespace

TEST_CASE("following the brush's own lag along its marks gives the simulated rows") {
    const Brush brush = shipped("round-6");
    const Pass pass = pass_with_arc();
    const PassMarks marks = simulate(pass, brush, 0.02, true, true);
    const FollowedRows again = follow_lag(pass, marks, law_of(brush));
    REQUIRE(again.contact_mm.rows() == marks.contact_mm.rows());
    CHECK((again.contact_mm - marks.contact_mm).cwiseAbs().maxCoeff() < 1e-9);
    for (Index i = 0; i < marks.contact_mm.rows(); ++i) {
        CAPTURE(i);
        CHECK(std::abs(again.heading(i, 0) - std::cos(marks.heading_rad[std::size_t(i)])) < 1e-9);
        CHECK(std::abs(again.heading(i, 1) - std::sin(marks.heading_rad[std::size_t(i)])) < 1e-9);
    }
}

TEST_CASE("following another lag along these marks gives its own simulation at the poses") {
    const Brush brush = shipped("round-6");
    Brush other = brush;
    for (double& c : other.lag.coefficients) c *= 1.2;
    const Pass pass = pass_with_arc();
    const PassMarks marks = simulate(pass, brush, 0.02, true, true), own = simulate(pass, other, 0.02, true, true);
    const FollowedRows followed = follow_lag(pass, marks, law_of(other));
    int compared = 0;
    for (std::size_t i = 0; i < marks.pose.size(); ++i)
        for (std::size_t k = 0; k < own.pose.size(); ++k) {
            if (marks.pose[i] != std::floor(marks.pose[i]) || own.pose[k] != marks.pose[i]) continue;
            if (own.depth_mm[k] != marks.depth_mm[i]) continue;
            CHECK(std::abs(followed.contact_mm(Index(i), 0) - own.contact_mm(Index(k), 0)) < 1e-9);
            CHECK(std::abs(followed.contact_mm(Index(i), 1) - own.contact_mm(Index(k), 1)) < 1e-9);
            ++compared;
        }
    CHECK(compared >= 9);
}

TEST_CASE("marks that do not match their pass are refused") {
    const Brush brush = shipped("round-6");
    Pass pass = pass_with_arc();
    PassMarks marks = simulate(pass, brush, 0.02, true, true);
    const LagLaw<double> law = law_of(brush), shallow = make_law(pieces(brush.lag, 0.0, 3.5));
    CHECK(agrees(refusal([&] { follow_lag(pass, marks, shallow); }), "depth-out-of-range", "s"));
    marks.pose.back() = 99.0;
    CHECK(agrees(refusal([&] { follow_lag(pass, marks, law); }), "not-ascending", "s"));
    marks.depth_mm.pop_back();
    CHECK(agrees(refusal([&] { follow_lag(pass, marks, law); }), "sizes-differ", "s"));
    pass.arcs.clear();
    pass.tool_axes.setZero(pass.poses_mm.rows(), 3);
    pass.tool_axes.col(2).setConstant(std::sqrt(0.99));
    pass.tool_axes.col(0).setConstant(0.1);
    CHECK(agrees(refusal([&] { follow_lag(pass, marks, law); }), "tilt-unsupported", "s"));
}
