#include "brushsvg/compensate.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "brushsvg/coverage.hpp"
#include "brushsvg/region.hpp"
#include "brushsvg/simulate.hpp"
#include "brushsvg/target_mark.hpp"
#include "inverse/middle_line.hpp"
#include "round6.hpp"

using namespace brushsvg;
using V = Eigen::Vector2d;

namespace {

constexpr double kPi = 3.14159265358979323846;

/// Return the contact at every pose, from the first row at that pose.
Ring at_poses(const PassMarks& marks) {
    Ring out = Ring::Zero(Eigen::Index(marks.pose.back()) + 1, 2);
    for (std::size_t i = marks.pose.size(); i-- > 0;)
        if (marks.pose[i] == std::floor(marks.pose[i])) out.row(Eigen::Index(marks.pose[i])) = marks.contact_mm.row(i);
    return out;
}

double overlap_of(const Stroke& stroke, const Pass& pass, const Brush& brush) {
    return overlap(outline(simulate(pass, brush, 0.01), brush), target_outline(stroke));
}

}  // namespace

TEST_CASE("turns up to 90 degrees are exact, and larger ones have the geometric error") {
    const Brush brush = shipped("round-6");
    const double e = brush.lever_to_widest(4.0);
    for (double degrees : {0.0, 30.0, 60.0, 89.9, 120.0, 150.0, 180.0}) {
        const double a = degrees * kPi / 180;
        const Stroke s = stroke_of(polyline({V(20, 20), V(60, 20), V(60 + 40 * std::cos(a), 20 + 40 * std::sin(a))}),
                                   {{0.0, brush.half_width(4.0)}});
        for (double tolerance : {0.5, 0.05, 1e-3, 1e-5}) {
            const CompensatedPass c = compensate(s, brush, {Compensation::closed, tolerance});
            const double remains = degrees > 90.0 ? e * (1.0 - std::cos(a - kPi / 2)) : 0.0;
            CHECK(c.tracking_error.largest_mm <= remains + tolerance);
            CHECK(c.tracking_error.largest_mm >= remains - tolerance);
            CHECK(c.tracking_error.has_turn_in_place == (degrees > 90.0));
        }
    }
}

TEST_CASE("a turn in place is one arc about the resting contact, with the same mark as its chords") {
    const Brush brush = shipped("round-6");
    CompensateOptions dense;  // with few poses, bends would be arcs as well
    dense.few_poses = false;
    for (double degrees : {120.0, 179.0, -150.0})
        for (double depth : {4.0, 1.0}) {  // the widest section is ahead of the contact, then behind it
            const double a = degrees * kPi / 180;
            const Stroke s =
                stroke_of(polyline({V(20, 20), V(60, 20), V(60 + 40 * std::cos(a), 20 + 40 * std::sin(a))}),
                          {{0.0, brush.half_width(depth)}});
            Pass pass = compensate(s, brush, dense).pass;
            REQUIRE(pass.arcs.size() == 1);
            const Arc arc = pass.arcs[0];
            CHECK(arc.direction == (degrees > 0 ? 1 : -1));
            const V from = pass.poses_mm.row(arc.first).head<2>().transpose(),
                    to = pass.poses_mm.row(arc.last).head<2>().transpose();
            CHECK((from - arc.centre_mm).norm() == doctest::Approx(brush.lag(depth)));
            CHECK(std::abs(std::remainder(turn_between(arc, from, to) - a, 2 * kPi)) < 1.7);
            const TrackingError exact = tracking_error_of(pass, s, brush, 0.05);
            const Ring with = at_poses(simulate(pass, brush, 1e-3));
            // rounded to 1e-4 mm, as in the text of a program
            Pass rounded = pass;
            rounded.poses_mm = (pass.poses_mm.array() * 1e4).round() / 1e4;
            rounded.arcs[0].centre_mm = (arc.centre_mm.array() * 1e4).round() / 1e4;
            pass.arcs.clear();
            CHECK((at_poses(simulate(pass, brush, 1e-3)) - with).rowwise().norm().maxCoeff() < 1e-3);
            CHECK((at_poses(simulate(rounded, brush, 1e-3)) - with).rowwise().norm().maxCoeff() < 1e-3);
            CHECK(std::abs(tracking_error_of(pass, s, brush, 0.05).largest_mm - exact.largest_mm) < 1e-3);
        }
    const Stroke bend = stroke_of(polyline({V(20, 20), V(60, 20), V(60, 60)}), {{0.0, brush.half_width(4.0)}});
    CHECK(compensate(bend, brush, dense).pass.arcs.empty());
    // a corner at changing depth gets no arc, because the circle would not close
    const Stroke taper = stroke_of(polyline({V(20, 20), V(60, 20), V(30, 40)}), {{0.0, 0.8}, {1.0, 2.0}});
    const Pass tapered = compensate(taper, brush).pass;
    for (std::size_t k = 0; k < tapered.arcs.size(); ++k) CHECK_NOTHROW(check_arc(tapered, k, ""));
    const Pass constant = compensate(bend, brush, {Compensation::constant, 0.05, 7.0}).pass;
    REQUIRE(constant.arcs.size() == 1);
    CHECK(constant.arcs[0].centre_mm == V(60, 20));
    CHECK((V(constant.poses_mm.row(constant.arcs[0].first).head<2>().transpose()) - V(67, 20)).norm() < 1e-9);
    CHECK((V(constant.poses_mm.row(constant.arcs[0].last).head<2>().transpose()) - V(60, 27)).norm() < 1e-9);
    CHECK(compensate(bend, brush, {Compensation::none}).pass.arcs.empty());
}

TEST_CASE("tapers across the depth at which the lever changes its sign, and a 0.5 mm line, are exact") {
    const Brush brush = shipped("round-6");
    Cubics wave(2, 8);
    wave << 20, 40, 40, 75, 50, 70, 60, 45, 60, 45, 70, 20, 90, 15, 110, 40;
    for (double tolerance : {0.5, 0.05, 1e-3, 1e-5}) {
        const Stroke taper = stroke_of(wave, {{0.0, 0.125}, {0.3, 2.0}, {0.6, 0.125}, {1.0, 2.0}});
        CHECK(compensate(taper, brush, {Compensation::closed, tolerance}).tracking_error.largest_mm <= tolerance);
        const Stroke hair = stroke_of(wave, {{0.0, 0.25}});
        CHECK(compensate(hair, brush, {Compensation::closed, tolerance}).tracking_error.largest_mm <= tolerance);
    }
}

TEST_CASE("on a straight line, P runs e behind the middle") {
    const Brush brush = shipped("round-6");
    const Stroke s = stroke_of(polyline({V(20, 20), V(80, 20)}), {{0.0, brush.half_width(4.0)}});
    const Pass pass = compensate(s, brush, {Compensation::closed, 1e-5}).pass;
    const PassMarks m = simulate(pass, brush, 1e-3);
    for (std::size_t i = 0; i < m.pose.size(); ++i) CHECK(std::abs(m.contact_mm(i, 1) - 20.0) < 1e-6);
}

TEST_CASE("the mark starts at the tip, half a width before the path, and ends at the footprint's front") {
    const Brush brush = shipped("round-6");
    const double h = brush.half_width(5.0);
    const Stroke s = stroke_of(polyline({V(30, 20), V(90, 20)}), {{0.0, h}});
    const Pass pass = compensate(s, brush, {}).pass;
    CHECK(pass.poses_mm(0, 2) == 0.0);
    CHECK(pass.poses_mm(pass.poses_mm.rows() - 1, 2) == 0.0);
    const auto box = painted_bounds(simulate(pass, brush, 0.01), brush);
    CHECK(std::abs(box[0] - (30.0 - h)) < 0.02);
    CHECK(std::abs(box[2] - (90.0 + h)) < 0.02);
    CHECK(std::abs(box[3] - (20.0 + h)) < 0.02);
}

TEST_CASE("compensation is better than none and than the best constant lag on a curved stroke") {
    const Brush brush = shipped("round-6");
    Cubics wave(2, 8);
    wave << 20, 40, 30, 75, 50, 70, 60, 45, 60, 45, 70, 20, 90, 15, 100, 40;
    const Stroke s = stroke_of(wave, {{0.0, 0.6}, {0.5, 2.8}, {1.0, 0.6}});
    const double none = overlap_of(s, compensate(s, brush, {Compensation::none}).pass, brush);
    const double closed = overlap_of(s, compensate(s, brush, {}).pass, brush);
    double best = 0.0;
    for (double lag = 4.0; lag < 11.0; lag += 0.25)
        best = std::max(best, overlap_of(s, compensate(s, brush, {Compensation::constant, 0.05, lag}).pass, brush));
    CHECK(none < 0.5);
    CHECK(best > none);
    CHECK(closed > best + 0.03);
    CHECK(closed > 0.9);
}

TEST_CASE("without compensation the TCP follows the line, and a constant lag runs ahead of it") {
    const Brush brush = shipped("round-6");
    const Stroke s = stroke_of(polyline({V(20, 20), V(60, 20), V(60, 50)}), {{0.0, brush.half_width(4.0)}});
    const Poses none = compensate(s, brush, {Compensation::none}).pass.poses_mm;
    Poses expected(5, 3);
    expected << 20, 20, 0, 20, 20, -4, 60, 20, -4, 60, 50, -4, 60, 50, 0;
    CHECK((none - expected).norm() < 1e-9);
    const Poses constant = compensate(s, brush, {Compensation::constant}).pass.poses_mm;
    const double r0 = brush.lag(4.0);
    CHECK((constant.row(0) - Eigen::RowVector3d(20, 20, 0)).norm() < 1e-9);
    CHECK((constant.row(1) - Eigen::RowVector3d(20 + r0, 20, -4)).norm() < 1e-9);
    CHECK((constant.row(2) - Eigen::RowVector3d(60 + r0, 20, -4)).norm() < 1e-9);
    CHECK((constant.row(constant.rows() - 1) - Eigen::RowVector3d(60, 50 + r0, 0)).norm() < 1e-9);
    for (Eigen::Index i = 2; i < constant.rows() - 2; ++i)  // on an arc of radius r0 about the corner
        CHECK((constant.row(i).head<2>() - Eigen::RowVector2d(60, 20)).norm() == doctest::Approx(r0));
}

TEST_CASE("a dot or a mark shorter than a footprint is one landing") {
    const Brush brush = shipped("round-6");
    const Stroke dot = stroke_of(polyline({V(50, 50), V(50, 50)}), {{0.0, 2.0}});
    const CompensatedPass c = compensate(dot, brush, {});
    CHECK(c.tracking_error.largest_mm < 1e-9);
    CHECK(overlap_of(dot, c.pass, brush) > 0.7);
    const Stroke dash = stroke_of(polyline({V(50, 50), V(51, 50)}), {{0.0, 2.0}});
    const CompensatedPass short_one = compensate(dash, brush, {});
    CHECK(short_one.tracking_error.largest_mm < 1e-9);
    CHECK(std::abs(painted_bounds(simulate(short_one.pass, brush, 0.01), brush)[2] - 53.0) < 0.02);
}

TEST_CASE("a rigid pen stays on the line at its own depth") {
    const Brush pen = shipped("rigid");
    const Stroke s = stroke_of(polyline({V(20, 20), V(60, 20), V(20, 21)}), {{0.0, 3.0}});
    const CompensatedPass c = compensate(s, pen, {});
    CHECK(c.tracking_error.largest_mm < 1e-9);
    CHECK(c.pass.poses_mm.rows() == 5);
    CHECK(c.pass.poses_mm(2, 2) == -pen.paint_depth_mm);
}

TEST_CASE("a brush whose lag grows as fast as its depth is pressed before it runs") {
    Brush brush = shipped("round-6");
    brush.lag.coefficients = {0.5, 0.0, 0.2};
    const Stroke s = stroke_of(polyline({V(30, 30), V(80, 30)}), {{0.0, brush.half_width(5.0)}});
    const CompensatedPass c = compensate(s, brush, {});
    CHECK(c.tracking_error.within_tolerance);
    const PassMarks m = simulate(c.pass, brush, 0.01);
    std::size_t first = 0;
    while (!m.taut[first]) ++first;
    CHECK((m.contact_mm.row(first) - m.contact_mm.row(0)).norm() < 1e-9);  // the contact rests during the landing
}

TEST_CASE("a straight line needs only a landing, one move and a lift") {
    const Brush brush = shipped("round-6");
    const Poses poses = compensate(stroke_of(polyline({V(20, 20), V(60, 20)}), {{0.0, 1.5}}), brush).pass.poses_mm;
    CHECK(poses.rows() <= 6);
    CHECK(poses(3, 2) > poses(2, 2));  // the lift begins at the last pose at full depth
    CHECK(poses(3, 0) < poses(2, 0));
}

TEST_CASE("random smooth strokes are within tolerance, and the contact rests during landing and lift") {
    const Brush brush = shipped("round-6");
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int k = 0; k < 40; ++k) {
        // the heading varies slowly enough for the widest section: radius of curvature above 3 mm
        Cubics c(3, 8);
        V p(100, 100);
        double heading = 6.28 * unit(random);
        for (int i = 0; i < 3; ++i) {
            const double turn = 2.0 * unit(random) - 1.0, length = 20 + 20 * unit(random);
            const V a(std::cos(heading), std::sin(heading)), b(std::cos(heading + turn), std::sin(heading + turn));
            const V q = p + length * 0.5 * (a + b);
            c.row(i) << p.transpose(), (p + length / 3 * a).transpose(), (q - length / 3 * b).transpose(),
                q.transpose();
            p = q;
            heading += turn;
        }
        std::vector<WidthKnot> widths;
        for (double at : {0.0, 0.2, 0.5, 0.7, 1.0}) widths.push_back({at, 0.125 + 2.5 * unit(random)});
        const Stroke s = stroke_of(c, widths);
        for (double tolerance : {0.05, 1e-3}) {
            const CompensatedPass out = compensate(s, brush, {Compensation::closed, tolerance});
            CHECK_MESSAGE(out.tracking_error.largest_mm <= tolerance,
                          "stroke " << k << " misses by " << out.tracking_error.largest_mm);
        }
        const PassMarks m = simulate(compensate(s, brush, {}).pass, brush, 0.01);
        std::size_t last = m.taut.size() - 1;
        while (!m.taut[last]) --last;
        CHECK((m.contact_mm.row(m.contact_mm.rows() - 1) - m.contact_mm.row(last)).norm() < 1e-9);
        CHECK(m.depth_mm[last] > 0.0);
    }
}

TEST_CASE("a line of very many short cubics is followed like one of few") {
    const Brush brush = shipped("round-6");
    const auto bow = [&](int n) {
        std::vector<V> points;
        for (int k = 0; k <= n; ++k)
            points.emplace_back(60 - 40 * std::cos(2.0 * k / n), 40 + 40 * std::sin(2.0 * k / n));
        return compensate(stroke_of(polyline(points), {{0.0, brush.half_width(4.0)}}), brush).tracking_error;
    };
    CHECK(bow(200).largest_mm < 0.05);
    CHECK(bow(15000).largest_mm < 0.05);
}

TEST_CASE("a round start turns over while its patch rests") {
    const Brush brush = shipped("round-6");
    const double h = brush.half_width(4.0);
    const Stroke s = stroke_of(polyline({V(30, 20), V(70, 20)}), {{0.0, h}});
    CompensateOptions options;
    options.start = Terminal::round;
    const CompensatedPass begun = compensate(s, brush, options);
    CHECK(begun.tracking_error.within_tolerance);
    const PassMarks marks = simulate(begun.pass, brush);
    const auto turns = find_turn_overs(marks);
    REQUIRE(turns.size() == 1);
    const auto contact = [&](std::size_t row) { return V(marks.contact_mm.row(Eigen::Index(row)).transpose()); };
    CHECK((contact(turns[0].first) - contact(turns[0].last)).norm() < 1e-6);
    CHECK(std::abs(marks.heading_rad[turns[0].first - 1]) == doctest::Approx(kPi));
    CHECK(std::abs(marks.heading_rad[turns[0].last]) < 1e-6);
    const auto bounds = painted_bounds(marks, brush);
    CHECK(bounds[0] == doctest::Approx(30.0 - h).epsilon(1e-3));  // the front reaches as far as a round cap
    CHECK(overlap_of(s, begun.pass, brush) > 0.99);
    CHECK(overlap_of(s, compensate(s, brush).pass, brush) < 0.98);
    CHECK(find_turn_overs(simulate(compensate(s, brush).pass, brush)).empty());

    const Brush pen = shipped("rigid");
    const Stroke line = stroke_of(polyline({V(30, 20), V(70, 20)}), {{0.0, pen.half_width(pen.paint_depth_mm)}});
    CHECK(compensate(line, pen, options).pass.poses_mm == compensate(line, pen).pass.poses_mm);
}

TEST_CASE("unpaintable strokes are refused, and unmeasured depths cause one warning") {
    const Brush brush = shipped("round-6");
    const Cubics line = polyline({V(20, 20), V(60, 20)});
    CHECK_THROWS_AS(compensate(stroke_of(line, {{0.0, 5.0}}), brush, {}), Error);
    CHECK(compensate(stroke_of(line, {{0.0, 0.2}, {1.0, 0.3}}), brush, {}).warnings.size() == 1);
    CHECK(compensate(stroke_of(line, {{0.0, 1.0}}), brush, {}).warnings.empty());
    CHECK_THROWS_AS(compensate(stroke_of(line, {{0.0, 1.0}}), brush, {Compensation::closed, 0.0}), Error);
}

namespace {

/// Return the plan of a dot of this half width, and its greatest depth [mm].
std::pair<CompensatedPass, double> dot_of_half_width(double half_width_mm, Terminal start) {
    CompensateOptions options;
    options.start = start;
    const Stroke stroke = stroke_of(polyline({V(20, 20), V(20, 20)}), {{0.0, half_width_mm}});
    CompensatedPass found = compensate(stroke, shipped("round-6"), options);
    const double depth_mm = -found.pass.poses_mm.col(2).minCoeff();
    return {found, depth_mm};
}

}  // namespace

TEST_CASE("the warning about a dot uses the depth of its turn, not the depth of an equally wide line") {
    int less = 0;
    for (const Terminal start : {Terminal::round, Terminal::automatic, Terminal::pointed})
        for (double half_mm = 0.3; half_mm <= 4.2; half_mm += 0.02) {
            const auto [found, depth_mm] = dot_of_half_width(half_mm, start);
            const bool as_line = shipped("round-6").depth_for_half_width(half_mm, "") < 1.0;
            less += depth_mm < 0.999 && !as_line;
            CHECK_MESSAGE(found.warnings.size() == (depth_mm < 0.999), half_mm, " ", depth_mm);
        }
    CHECK(less > 3);
}

namespace {

/// Return a hook whose line runs back on itself at its end. There the lengths of its parts do not add up to its length.
Stroke hook() {
    Cubics middle(1, 8);
    middle << 23.89, 32.82, 21.99, 29.27, 20.52, 26.64, 21.19, 28.07;
    return stroke_of(middle,
                     {{0.0, 4.0}, {0.764, 4.0}, {0.8679, 2.9156}, {0.9236, 1.8313}, {0.9514, 0.53}, {1.0, 0.53}});
}

}  // namespace

TEST_CASE("steps around a cusp terminate at any tolerance") {
    const Stroke stroke = hook();
    const Brush brush = shipped("round-6");
    const Line line(stroke, brush);
    for (const double tolerance : {1e-2, 3.5e-3, 1.4e-3, 1e-4, 1e-5}) {
        Samples samples = line.coarse_samples(0.0, line.length(), {});
        int rounds = 0;
        std::size_t most = 0;
        refine_steps(line, samples, tolerance, [&](Samples& all) {
            ++rounds;
            most = std::max(most, all.size());
            REQUIRE(rounds < 100);
            for (Sample& sample : all) {
                sample.heading = line.tangent(sample);
                sample.contact = sample.middle;
                sample.tcp = sample.middle + brush.lag(sample.depth) * sample.heading;
            }
        });
        CAPTURE(tolerance);
        CHECK(rounds <= 25);  // each round splits a step in three, down to 1e-9 of the parameter
        CHECK(most < 20000);
    }
}

TEST_CASE("a hook has a plan of normal size") {
    const CompensatedPass found = compensate(hook(), shipped("round-6"));
    CHECK(found.pass.poses_mm.rows() < 200);
    CHECK(found.tracking_error.largest_mm < 0.1);
}

TEST_CASE("the reported error is the measured one, also for plans made with a finer tolerance") {
    Cubics curled(3, 8);
    curled << 43.75, 41.75, 26.5, 40.5, 45.5, 22.75, 36.75, 50.25,  //
        36.75, 50.25, 33, 36.75, 26, 50.25, 30.75, 56.25,           //
        30.75, 56.25, 49, 48.5, 27.25, 64, 29.25, 70.5;
    Brush pen;  // of constant width; the distance of its tip grows with the depth
    pen.name = "pen", pen.kind = "pen";
    pen.depth_range_mm = {0.247, 10.588};
    pen.lag.coefficients = {0.0};
    pen.half_width.coefficients = {0.369};
    pen.tip_gap.coefficients = pen.tip_to_widest.coefficients = {0.0, 0.645};
    pen.paint_depth_mm = 4.31;
    Ring drop(5, 2);
    drop << 0.0, 0.0, 6.83, -0.369, 7.286, -0.1845, 7.286, 0.1845, 6.83, 0.369;
    pen.footprints.dragged.push_back({10.588, drop});
    Stroke stroke = stroke_of(curled, {{0.0, 0.369}});
    stroke.start_covered = true;
    for (const double tolerance_mm : {0.05, 0.15, 0.25, 0.367, 0.6}) {
        const CompensatedPass made = compensate(stroke, pen, {Compensation::closed, tolerance_mm});
        const TrackingError seen = tracking_error_of(made.pass, stroke, pen, tolerance_mm);
        CHECK_MESSAGE(std::abs(seen.largest_mm - made.tracking_error.largest_mm) < 1e-9, "at " << tolerance_mm);
    }
}

TEST_CASE("a stroke whose thin start has its widest section at the tip is narrowed in a finite number of steps") {
    // Steps were a share of the distance from the tip to the widest section at the start. Where it is 0, the search
    // never ended, and its widths filled the memory.
    Brush brush = shipped("round-6");
    brush.tip_to_widest.floor_slope = 0.0;
    CompensateOptions options;
    options.start = Terminal::automatic;
    const Stroke comma = stroke_of(polyline({V(20, 50), V(80, 50)}), {{0.0, 0.3}, {0.009, 1.5}, {1.0, 1.5}});
    const CompensatedPass found = compensate(comma, brush, options);
    CHECK(found.pass.poses_mm.rows() > 2);
    CHECK(found.pass.poses_mm.rows() < 200);
    CHECK(found.pass.poses_mm.allFinite());
}

TEST_CASE("a stroke that is thinner than a picture's finest pixel at one end is compensated") {
    // The pixels in which its end styles are compared were a share of that width, and refused as too fine.
    CompensateOptions options;
    options.start = options.end = Terminal::automatic;
    for (const double thin_mm : {5e-6, 1e-8, 1e-300})
        for (const bool is_start : {true, false}) {
            const std::vector<WidthKnot> widths{{0.0, is_start ? thin_mm : 1.5}, {1.0, is_start ? 1.5 : thin_mm}};
            const Stroke taper = stroke_of(polyline({V(20, 50), V(80, 50)}), widths);
            CHECK(compensate(taper, shipped("round-6"), options).tracking_error.largest_mm < 0.1);
        }
}
