#include "mark_fit.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "brushsvg/error.hpp"
#include "drop.hpp"
#include "identifiability.hpp"
#include "mark_model.hpp"
#include "mark_problem.hpp"
#include "no_brush.hpp"
#include "noise_covariance.hpp"
#include "realised_path.hpp"
#include "refusal.hpp"

using namespace brushsvg;
using namespace brushsvg::fit;

TEST_CASE("the nearest point on a drop's edge agrees with its densely sampled outline") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> where(-6.0, 10.0);
    for (const Drop& drop : {Drop{3.6, 2.0, 2.0}, Drop{3.6, 2.0, 1.2}, Drop{1.5, 1.0, 1.6}, Drop{0.6, 2.0, 3.0},
                             Drop{3.6, 2.0, 1.2, true}, Drop{1.5, 2.0, 3.0, true}}) {
        std::vector<Eigen::Vector2d> edge;
        for (int i = 0; i <= 20000; ++i) {
            const double t = i / 20000.0, phi = 0.5 * M_PI * (1.0 - t);
            if (drop.round_tail)
                edge.emplace_back(drop.widest * (1.0 - std::cos(phi)), drop.half * std::sin(phi));
            else
                edge.emplace_back(t * drop.widest, t * drop.half);
            edge.emplace_back(drop.widest + drop.front * std::cos(phi), drop.half * std::sin(phi));
        }
        for (int i = 0; i < 50; ++i) {
            const double x = where(random), y = where(random) - 2.0;
            double least = 1e9;
            for (const auto& p : edge) least = std::min(least, (p - Eigen::Vector2d(x, std::abs(y))).norm());
            const NearestEdge found = nearest_edge(drop, x, y);
            CHECK(std::abs(found.distance) == doctest::Approx(least).epsilon(2e-3));
            CHECK(least_distance(drop, x, y) <= found.distance + 1e-9);
            CHECK(found.x == doctest::Approx(found.by_widest * drop.widest + found.by_front * drop.front));
            CHECK(found.y == doctest::Approx(found.by_half * drop.half));
            const Span span = span_inside(drop, x, y, 0.6, -0.8);
            if (found.distance < 0.0) {
                REQUIRE(span.from < 0.0);
                REQUIRE(span.to > 0.0);
            }
            if (span.to > span.from)
                CHECK(nearest_edge(drop, x + 0.6 * span.to, y - 0.8 * span.to).distance ==
                      doctest::Approx(0.0).epsilon(1e-4));
            // a step along the normal increases the distance by its length
            const NearestEdge out = nearest_edge(drop, found.x + 0.01 * found.nx, found.y + 0.01 * found.ny);
            CHECK(out.distance == doctest::Approx(0.01).epsilon(0.05));
            CHECK(least_distance(drop, found.x, found.y) > -0.02);
        }
        for (int i = 0; i < 50; ++i) {
            const Eigen::Vector2d n = Eigen::Vector2d(std::cos(i), std::sin(i));
            double far = -1e9;
            for (const auto& p : edge) far = std::max(far, n.x() * p.x() + std::abs(n.y()) * p.y());
            const NearestEdge found = farthest_edge(drop, n.x(), n.y());
            CHECK(n.x() * found.x + n.y() * found.y == doctest::Approx(far).epsilon(1e-6));
            CHECK(found.x == doctest::Approx(found.by_widest * drop.widest + found.by_front * drop.front));
            CHECK(found.y == doctest::Approx(found.by_half * drop.half));
        }
    }
}

TEST_CASE("along a straight stroke of any width the edge is straight, and crossing sides stay separate") {
    Poses poses(2, 3);
    poses << 0, 0, -1, 40, 0, -1;
    for (const double half : {0.03, 0.1, 0.4, 1.5, 4.0}) {
        MarkLaws laws;
        laws.lag = {3.0};
        laws.tip_gap = {0.0, 0.5};
        laws.half_width = {0.0, half};
        for (const double up : {half, half + 0.2, std::max(half - 0.3, -0.1)}) {  // last: hairlines' sides cross
            Ring ring(4, 2);
            ring << 10, -up, 30, -up, 30, up, 10, up;
            const MarkModel model({PaintedMark{"s", poses, {ring}}}, MarkOptions{});
            const VectorXd x = model.unknowns(laws);
            const Eigen::Vector2d still = Eigen::Vector2d::Zero();
            VectorXd distance;
            REQUIRE(model.distances(0, x.data(), still.data(), distance, nullptr, nullptr));
            const Ring points_in_plan_frame = model.points_in_plan_frame(0, x.data(), still.data());
            const VectorXd width = model.widths(0, x.data(), still.data());
            for (Eigen::Index k = 0; k < points_in_plan_frame.rows(); ++k) {
                if (!(points_in_plan_frame(k, 0) > 11.0 && points_in_plan_frame(k, 0) < 29.0)) continue;
                CHECK(distance[k] == doctest::Approx(up - half).epsilon(2e-3).scale(0.1));
                CHECK(width[k] == doctest::Approx(2.0 * half).epsilon(0.01).scale(0.1));
            }
        }
    }
}

TEST_CASE("points without weight have no effect") {
    Poses along(2, 3), up(3, 3);
    along << 0, 0, -1, 40, 0, -2;
    up << 60, 0, -1, 60, 30, -2, 75, 30, -2;
    Ring ring(8, 2), other(4, 2);
    ring << -4, -1.5, 10, -1.2, 30, -2, 37, -2.1, 38, 0, 37, 2, 30, 1.8, 10, 1.3;
    other << 57, 0, 63, 1, 62, 25, 58, 25;
    MarkOptions options;
    options.turn_rad = options.placement_mm = 0.0;
    MarkLaws laws;
    laws.lag = {3.0, 0.2};
    laws.tip_gap = {0.0, 0.5};
    laws.half_width = {0.0, 0.8};
    MarkProblem alone({{"s", along, {ring}}}, options), both({{"s", along, {ring}}, {"t", up, {other}}}, options);
    both.point_weights[1].setZero();
    for (MarkProblem* fit : {&alone, &both}) {
        fit->start_at(laws);
        fit->correct_displaced_marks();
        fit->solve(10, 1e-9);
        fit->weighing = estimate_weighing(*fit);
    }
    CHECK((both.shared - alone.shared).cwiseAbs().maxCoeff() < 1e-6);
    CHECK((both.displacements_mm[0] - alone.displacements_mm[0]).norm() < 1e-6);
    CHECK(both.loss() == doctest::Approx(alone.loss()));
    CHECK(both.weighing.noise_mm == doctest::Approx(alone.weighing.noise_mm));
    CHECK(both.weighing.points_per_independent == doctest::Approx(alone.weighing.points_per_independent));
    CHECK(covariance(both).isApprox(covariance(alone), 1e-4));
    CHECK(describe_open_unknowns(both) == describe_open_unknowns(alone));
}

/// Returns the matrix of an autocovariance around an outline of n points.
Eigen::MatrixXd around_outline(const std::vector<double>& autocovariance, int n) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
    for (int k = 0; k < n; ++k)
        for (int lag = 0; lag < int(autocovariance.size()); ++lag) {
            out(k, (k + lag) % n) += autocovariance[std::size_t(lag)];
            if (lag) out((k + lag) % n, k) += autocovariance[std::size_t(lag)];
        }
    return out;
}

TEST_CASE("an autocovariance that is cut off gives no negative variance") {
    const auto least_and_sum = [](const std::vector<double>& c, int n) {
        const Eigen::MatrixXd around = around_outline(c, n);
        return std::pair{Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(around).eigenvalues()[0], around.row(0).sum()};
    };
    const std::vector<double> cut{1.0, 0.9, 0.8, 0.7, 0.6, 0.5}, dips{1.0, 0.6, -0.3, 0.3, -0.4};
    CHECK(least_and_sum(cut, 40).first < -0.5);
    for (const auto& c : {cut, dips, std::vector<double>{2.0}})
        for (const int n : {3, 7, 40, 121}) {
            CAPTURE(n);
            const auto [least, sum] = least_and_sum(as_moving_average(c), n);
            CHECK(least > -1e-9);
            CHECK(sum == doctest::Approx(least_and_sum(c, n).second));
        }
    std::vector<double> valid;
    for (int lag = 0; lag < 40; ++lag) valid.push_back(std::pow(0.8, lag));
    const std::vector<double> kept = as_moving_average(valid);
    for (std::size_t lag = 0; lag < valid.size(); ++lag)
        CHECK(kept[lag] == doctest::Approx(valid[lag]).epsilon(1e-3).scale(1.0));
}

TEST_CASE("specks alone are refused") {
    Poses poses(2, 3);
    poses << 0, 0, -1, 40, 0, -1;
    Ring speck(3, 2);
    speck << 0, 0, 0.1, 0, 0.1, 0.1;
    CHECK(agrees(refusal([&] { fit_marks({PaintedMark{"s", poses, {speck}}}, std::nullopt, MarkOptions{}); }),
                 "mark-empty", ""));
}

TEST_CASE("derivatives of edge distances agree with small steps, including events and landings") {
    Poses poses(6, 3);
    poses << 0, 0, 0, 8, 0, -4, 25, 2, -5, 26, 20, -3, 22, 6, -6, 10, 8, -2;
    PaintedMark mark{"s", poses, {}};
    Ring ring(40, 2);
    for (Eigen::Index k = 0; k < 40; ++k)
        ring.row(k) << 14.0 + 16.0 * std::cos(0.157 * double(k)), 7.0 + 12.0 * std::sin(0.157 * double(k));
    mark.outline_mm = {ring};
    MarkOptions options;
    options.spacing_mm = 0.7;
    const MarkModel model({mark}, options);
    MarkLaws laws;
    laws.lag = {3.1, 0.86, 0.31, -0.03};
    laws.tip_gap = {0.0, 0.5};
    laws.half_width = {0.0, 0.42, 0.01};
    VectorXd x = model.unknowns(laws);
    x[model.layout().height()] = 0.13;
    x.tail(3) << 0.3, -0.2, 0.05;
    Eigen::Vector2d moved(0.1, 0.2);
    VectorXd at, up, down;
    RowMajor by = RowMajor::Zero(model.points(0), x.size()), own = RowMajor::Zero(model.points(0), 2);
    REQUIRE(model.distances(0, x.data(), moved.data(), at, &by, &own));
    const double step = 3e-3;
    int wrong = 0;
    for (Eigen::Index i = 0; i < x.size() + 2; ++i) {
        double& value = i < x.size() ? x[i] : moved[i - x.size()];
        value += step;
        model.distances(0, x.data(), moved.data(), up, nullptr, nullptr);
        value -= 2.0 * step;
        model.distances(0, x.data(), moved.data(), down, nullptr, nullptr);
        value += step;
        for (Eigen::Index k = 0; k < at.size(); ++k) {
            const double analytic = i < x.size() ? by(k, i) : own(k, i - x.size());
            // the derivatives neglect how the tangent lines turn; midway between two places of the edge there is a kink
            if (std::abs((up[k] - down[k]) / (2.0 * step) - analytic) > 0.1 * (1.0 + std::abs(analytic))) ++wrong;
        }
    }
    CHECK(wrong <= 0.02 * double(at.size() * (x.size() + 2)));
}

TEST_CASE("the mark's edge moves no faster than the lag grows where the TCP passes the resting patch") {
    Poses poses(3, 3);  // the closer the TCP passes, the more suddenly the footprint turns
    poses << 0, 0, -6, 0, 28, -6, 1, 4, -6;
    MarkLaws laws;
    laws.lag = {3.0, 0.5, 0.05, 0.0};
    laws.tip_gap = {0.0, 0.3};
    laws.half_width = {0.0, 0.4};
    const double lag = 7.8, front = 0.4 * 6.0 * 2.8 - 0.3 * 6.0;
    for (double radius : {front - 0.1, front, front + 0.1}) {
        Ring ring(60, 2);
        for (Eigen::Index k = 0; k < 60; ++k) {
            const double angle = 2.0 * M_PI / 60.0 * double(k);
            ring.row(k) << radius * std::cos(angle), 28.0 - lag + radius * std::sin(angle);
        }
        const MarkModel model({{"s", poses, {ring}}}, {});
        const VectorXd x = model.unknowns(laws);
        const Eigen::Vector2d still = Eigen::Vector2d::Zero();
        VectorXd at;
        RowMajor by(model.points(0), x.size()), own(model.points(0), 2);
        REQUIRE(model.distances(0, x.data(), still.data(), at, &by, &own));
        CHECK(by.leftCols(4).rowwise().sum().cwiseAbs().maxCoeff() < 1.5);
    }
}

TEST_CASE("an arc is followed on its circle, not on its chords") {
    // a half circle from left to right: as 4 poses 60 degrees apart, or as 181 poses
    const auto half_circle = [](Eigen::Index parts) {
        Poses poses(parts + 1, 3);
        for (Eigen::Index k = 0; k <= parts; ++k) {
            const double angle = M_PI * double(k) / double(parts);
            poses.row(k) << -15.0 * std::cos(angle), 15.0 * std::sin(angle), -3.0;
        }
        return poses;
    };
    Ring ring(30, 2);
    for (Eigen::Index k = 0; k < 30; ++k) {
        const double angle = 2.0 * M_PI / 30.0 * double(k);
        ring.row(k) << 16.0 * std::cos(angle), 6.0 + 10.0 * std::sin(angle);
    }
    const Eigen::Vector2d still = Eigen::Vector2d::Zero();
    const auto distances = [&](const Poses& poses, const std::vector<Arc>& arcs) {
        const MarkModel model({{"s", poses, {ring}, arcs}}, {});
        const VectorXd x = model.unknowns({{3.0, 0.2}, {0.0, 0.4}, {0.0, 0.5}});
        VectorXd at;
        RowMajor by = RowMajor::Zero(model.points(0), x.size()), own = RowMajor::Zero(model.points(0), 2);
        REQUIRE(model.distances(0, x.data(), still.data(), at, &by, &own));
        return at;
    };
    const VectorXd truth = distances(half_circle(180), {});
    const Arc arc{0, 3, {0.0, 0.0}, -1};
    CHECK((distances(half_circle(3), {arc}) - truth).cwiseAbs().maxCoeff() < 0.03);
    CHECK((distances(half_circle(3), {}) - truth).cwiseAbs().maxCoeff() > 1.0);
    const auto beyond = [&] { fit_marks({{"s", half_circle(3), {ring}, {{0, 9, {0.0, 0.0}, -1}}}}, std::nullopt, {}); };
    CHECK(agrees(refusal(beyond), "arc-invalid", "s", {"0", "9"}));
}

TEST_CASE("laws with impossible footprints predict nothing, because they would need a million instants") {
    Poses poses(3, 3);
    poses << 0, 0, -3, 30, 0, -6, 30, 25, -6;
    Ring ring(4, 2);
    ring << -9, -3, 33, -3, 33, 25, -9, 25;
    const MarkModel model({{"s", poses, {ring}}}, {});
    const Eigen::Vector2d still = Eigen::Vector2d::Zero();
    for (const double half : {0.4, 4.0, 400.0}) {
        const VectorXd x = model.unknowns({{3.0}, {0.0, 0.3}, {0.0, half}});
        VectorXd at;
        CHECK(model.distances(0, x.data(), still.data(), at, nullptr, nullptr) == (half < 100.0));
    }
}

TEST_CASE("impossible marks are refused, and one of them is named") {
    Poses poses(4, 3);
    poses << 0, 0, 0, 12, 0, -3, 30, 0, -3, 30, 25, -3;
    const auto star = [](int points) {
        Ring out(points, 2);
        for (Eigen::Index k = 0; k < out.rows(); ++k) {
            const double angle = 2.0 * M_PI / points * double(k), radius = k % 2 ? 30.0 : 6.0;
            out.row(k) << 15.0 + radius * std::cos(angle), 10.0 + radius * std::sin(angle);
        }
        return out;
    };
    Ring square(4, 2);
    square << 0, 0, 40, 0, 40, 40, 0, 40;  // huge footprints overlap here, and the work is counted
    const std::string sentence = no_brush_error("this one").what();
    const auto check_refused = [&](const std::function<void()>& does) {
        try {
            does();
            FAIL_CHECK("nothing was refused");
        } catch (const Error& error) {
            CHECK(error.code() == "fit-failed");
            CHECK(error.where() == "this one");
            CHECK(std::string(error.what()) == sentence);
        }
    };
    const auto check_no_fit = [&](const Poses& stroke, const Ring& ring, const MarkOptions& options = {}) {
        check_refused([&] { fit_marks({{"this one", stroke, {ring}}}, std::nullopt, options); });
    };
    // If nothing fits, it is chance where a search ends. The refusal must not depend on it.
    MarkOptions hasty;
    hasty.max_iterations = 1;
    for (const int points : {12, 16, 20, 24, 28}) {
        CAPTURE(points);
        check_no_fit(poses, star(points));
        check_no_fit(poses, star(points), hasty);
    }
    check_no_fit(poses, square);

    // also check each way to detect this on its own
    Poses above = poses;  // none of the lags that are tried predicts a mark
    above.col(2).setConstant(1.0);
    check_no_fit(above, square);
    MarkProblem fit({{"this one", poses, {square}}}, {});
    fit.start_at({{3.0}, {0.0, 0.3}, {0.0, 400.0}});  // laws that predict no mark
    check_refused([&] { estimate_weighing(fit); });
    fit.start_at({{3.0}, {0.0, 0.3}, {0.0, 4.0}});  // more work than the mark of a brush needs
    REQUIRE(std::isfinite(fit.loss()));
    check_refused([&] {
        for (int i = 0; i < 100000; ++i) fit.loss();
    });
}

TEST_CASE("a starting brush that paints no mark is refused") {
    Poses poses(2, 3);
    poses << 0, 0, -3, 30, 0, -3;
    Ring ring(4, 2);
    ring << 0, -2, 30, -2, 30, 2, 0, 2;
    const MarkLaws huge{{3.0}, {0.0, 0.3}, {0.0, 400.0}};
    MarkOptions expected;
    expected.noise_mm = 0.1;
    for (const MarkOptions& options : {MarkOptions{}, expected}) {
        const auto refused = refusal([&] { fit_marks({{"s", poses, {ring}}}, huge, options); });
        CHECK(agrees(refused, "fit-failed", "s"));
        CHECK(std::string(refused->what()) != no_brush_error("s").what());
    }
}

TEST_CASE("data that cannot be fitted are refused") {
    CHECK_THROWS_AS(fit_marks({}, std::nullopt, {}), Error);
    Poses poses(2, 3);
    poses << 0, 0, -3, 30, 0, -3;
    CHECK_THROWS_AS(fit_marks({{"s", poses, {}}}, std::nullopt, {}), Error);
    Ring ring(3, 2);
    ring << 0, 0, 30, 0, NAN, 3;
    CHECK_THROWS_AS(fit_marks({{"s", poses, {ring}}}, std::nullopt, {}), Error);
    ring(2, 0) = 30;
    MarkOptions options;
    options.lag_terms = 5;
    CHECK_THROWS_AS(fit_marks({{"s", poses, {ring}}}, std::nullopt, options), Error);
    options = {};
    options.deepest_mm = 2.0;
    CHECK_THROWS_AS(fit_marks({{"s", poses, {ring}}}, std::nullopt, options), Error);
}

TEST_CASE("a reversing axis stands still for exactly its backlash") {
    Poses poses(6, 3);
    poses << 0.0, 5.0, 0.0, 10.0, 5.0, -1.0, 9.9, 5.0, -1.0, 9.7, 5.0, -1.0, 9.5, 5.0, -1.0, 5.0, 5.0, 0.0;
    const FieldBox box;
    for (const double backlash : {0.4, 0.0, -0.4}) {
        MachineState machine{{}, {0.0, 0.0}, {-1.0, 1.0}, box, false};
        machine.by[MachineIndex::backlash] = machine.by[MachineIndex::backlash + 1] = backlash;
        const auto behind = backlash_offsets(poses, machine, machine.by);
        const double sign = backlash < 0.0 ? -1.0 : 1.0, all = std::abs(backlash);
        const std::array<double, 6> commanded{0.0, 10.0, 9.9, 9.7, 9.5, 5.0};
        // The axis arrived from the right, pulled along by a slot as wide as the backlash.
        double place = commanded[0] + 0.5 * all;
        for (std::size_t i = 0; i < commanded.size(); ++i) {
            place = std::clamp(place, commanded[i] - 0.5 * all, commanded[i] + 0.5 * all);
            CHECK(behind[i].x() == doctest::Approx(sign * (commanded[i] - place)).epsilon(1e-12));
            CHECK(behind[i].y() == doctest::Approx(0.5 * backlash));
        }
    }
}
