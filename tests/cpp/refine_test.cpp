#include "refine.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "brushsvg/coverage.hpp"
#include "brushsvg/region.hpp"
#include "brushsvg/simulate.hpp"
#include "brushsvg/target_mark.hpp"
#include "painted_edge.hpp"
#include "patch_path.hpp"
#include "refusal.hpp"
#include "round6.hpp"

using namespace brushsvg;
using namespace brushsvg::fit;
using V = Eigen::Vector2d;

namespace {

constexpr double kPi = 3.14159265358979323846;

Stroke line() { return stroke_of(polyline({V(20, 20), V(50, 28)}), {{0.0, 1.7}}); }
Stroke taper() { return stroke_of(polyline({V(20, 20), V(60, 20)}), {{0.0, 2.6}, {1.0, 0.6}}); }
Stroke corner() { return stroke_of(polyline({V(20, 50), V(50, 50), V(44, 20)}), {{0.0, 1.7}}); }
Stroke hook() { return stroke_of(polyline({V(50, 60), V(50, 20), V(41, 28)}), {{0.0, 2.0}, {1.0, 1.0}}); }
/// Return a blunt head across the line. The pointed footprint must come in from the side.
Stroke head() {
    Stroke s = stroke_of(polyline({V(39, 38), V(30.5, 30)}), {{0.0, 3.1}, {1.0, 0.6}});
    Ring target(9, 2);
    target << 30, 29.3, 38, 31.5, 44, 33, 45, 34.5, 44.5, 37, 38.5, 44, 36, 45, 34.5, 44, 29.5, 30.5;
    s.target_mm = {target};
    return s;
}
Stroke curve() {
    Cubics middle(1, 8);
    middle << 20, 20, 20, 45, 50, 45, 45, 22;
    return stroke_of(middle, {{0.0, 1.2}, {0.5, 2.6}, {1.0, 1.4}});
}

Stroke turned(Stroke s, double angle) {
    for (Eigen::Index i = 0; i < s.middle_mm.rows(); ++i)
        for (int k = 0; k < 4; ++k) {
            const V p = s.middle_mm.row(i).segment<2>(2 * k).transpose() - V(40, 40);
            s.middle_mm.row(i).segment<2>(2 * k) << 40 + std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                40 + std::sin(angle) * p.x() + std::cos(angle) * p.y();
        }
    return s;
}

Stroke mirrored(Stroke s) {
    for (int k : {1, 3, 5, 7}) s.middle_mm.col(k) = 80.0 - s.middle_mm.col(k).array();
    return s;
}

/// Return the overlap as the report computes it.
double overlap_of(const Stroke& stroke, const Pass& pass, const Brush& brush) {
    return overlap(outline(simulate(pass, brush), brush), target_outline(stroke, 0.01));
}

Eigen::VectorXd anything(int n, std::mt19937& random) {
    std::normal_distribution<double> normal(0.0, 0.2);
    Eigen::VectorXd x(n);
    for (double& value : x) value = normal(random);
    return x;
}

PatchPath path_of(const Stroke& stroke, const Brush& brush, int controls) {
    CompensateOptions all_poses;
    all_poses.few_poses = false;
    return PatchPath(patch_path(compensate(stroke, brush, all_poses).pass, brush, 0.5, 500), controls, {0.5, 10.0});
}

}  // namespace

TEST_CASE("the path of the patch without changes equals the closed form") {
    const Brush brush = shipped("round-6");
    for (const Stroke& s : {line(), taper(), corner(), curve()}) {
        const PatchPath path = path_of(s, brush, 8);
        const PatchSamples samples = path.at(Eigen::VectorXd::Zero(path.unknowns()));
        for (std::size_t i = 0; i < samples.size(); ++i) {
            CHECK((samples[i].contact_mm - path.base()[i].contact_mm).norm() < 1e-9);
            CHECK(samples[i].depth_mm == path.base()[i].depth_mm);
        }
        Pass pass;
        pass.poses_mm = poses_along(samples, brush, 0.025);
        CHECK(overlap_of(s, pass, brush) ==
              doctest::Approx(overlap_of(s, compensate(s, brush).pass, brush)).epsilon(0.01));
    }
}

TEST_CASE("derivatives of path and edge agree with differences") {
    const Brush brush = shipped("round-6");
    std::mt19937 random(5);
    const Stroke s = curve();
    const PatchPath path = path_of(s, brush, 7);
    PaintedEdge edge(brush, 0.02);
    const Rings target = target_outline(s, 0.5);
    const double h = 1e-6;
    for (int trial = 0; trial < 3; ++trial) {
        const Eigen::VectorXd x = 0.3 * anything(path.unknowns(), random);
        const PatchSamples samples = path.at(x);
        // the slopes of one sample's x, y, heading or depth by all unknowns
        const auto row = [&](std::size_t sample, int of) {
            std::vector<Eigen::Vector4d> one(samples.size(), Eigen::Vector4d::Zero());
            one[sample][of] = 1.0;
            return path.slope(samples, one);
        };
        for (std::size_t i = 0; i < samples.size(); i += 7) {
            const Eigen::VectorXd by_x = row(i, 0), by_y = row(i, 1), by_heading = row(i, 2), by_depth = row(i, 3);
            for (int k = 0; k < path.unknowns(); ++k) {
                const PatchSamples after = path.at(x + h * Eigen::VectorXd::Unit(path.unknowns(), k));
                const V moved = (after[i].contact_mm - samples[i].contact_mm) / h;
                CHECK(moved.x() == doctest::Approx(by_x[k]).epsilon(1e-4).scale(1.0));
                CHECK(moved.y() == doctest::Approx(by_y[k]).epsilon(1e-4).scale(1.0));
                CHECK((after[i].heading_rad - samples[i].heading_rad) / h ==
                      doctest::Approx(by_heading[k]).epsilon(1e-4).scale(1.0));
                CHECK((after[i].depth_mm - samples[i].depth_mm) / h ==
                      doctest::Approx(by_depth[k]).epsilon(1e-4).scale(1.0));
            }
        }
        for (Eigen::Index j = 0; j < target[0].rows(); j += 3) {
            const V p = target[0].row(j).transpose();
            edge.place_footprints(samples);
            const EdgePoint found = edge.nearest(p, 0);
            const SampleSlope slope = edge.slope(p, found);
            const auto difference = [&](PatchSample change) {
                PatchSamples after = samples;
                PatchSample& one = after[found.sample];
                one.contact_mm += change.contact_mm;
                one.heading_rad += change.heading_rad;
                one.depth_mm += change.depth_mm;
                edge.place_footprints(after);
                return (edge.nearest(p, found.sample).distance_mm - found.distance_mm) / h;
            };
            CHECK(difference({V(h, 0), 0, 0}) == doctest::Approx(slope.x()).epsilon(1e-3).scale(1.0));
            CHECK(difference({V(0, h), 0, 0}) == doctest::Approx(slope.y()).epsilon(1e-3).scale(1.0));
            CHECK(difference({V(0, 0), h, 0}) == doctest::Approx(slope[2]).epsilon(1e-3).scale(1.0));
            CHECK(difference({V(0, 0), 0, h}) == doctest::Approx(slope[3]).epsilon(1e-3).scale(1.0));
        }
    }
}

TEST_CASE("sums of squared derivatives agree with the whole table, at both limits of the depth") {
    const Brush brush = shipped("round-6");
    std::mt19937 random(9);
    for (const Stroke& s : {line(), corner(), curve()}) {
        const PatchPath path = path_of(s, brush, 9);
        PatchSamples samples = path.at(0.3 * anything(path.unknowns(), random));
        samples[2].depth_mm = 0.5;
        samples[5].depth_mm = 10.0;
        std::vector<Eigen::Matrix4d> blocks;
        Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(path.unknowns(), path.unknowns());
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const Eigen::Matrix4d root = Eigen::Map<const Eigen::Matrix4d>(anything(16, random).data());
            blocks.push_back(root.transpose() * root);
            Eigen::MatrixXd slopes(4, path.unknowns());
            for (int of = 0; of < 4; ++of) {
                std::vector<Eigen::Vector4d> one(samples.size(), Eigen::Vector4d::Zero());
                one[i][of] = 1.0;
                slopes.row(of) = path.slope(samples, one).transpose();
            }
            expected += slopes.transpose() * blocks.back() * slopes;
        }
        CHECK((path.curvature(samples, blocks) - expected).cwiseAbs().maxCoeff() <
              1e-12 * expected.cwiseAbs().maxCoeff());
    }
}

TEST_CASE("the nearest edge is found among all edges, with any of them left out") {
    const Brush brush = shipped("round-6");
    std::mt19937 random(10);
    std::uniform_real_distribution<double> place(10.0, 60.0);
    const PatchPath path = path_of(curve(), brush, 8);
    const PatchSamples samples = path.at(0.3 * anything(path.unknowns(), random));
    PaintedEdge edge(brush, 0.02);
    edge.place_footprints(samples);
    const Rings target = target_outline(curve(), 0.01);
    const FilledRings edges(target);
    for (int trial = 0; trial < 300; ++trial) {
        const V p(place(random), place(random));
        double least = 1e9, other = 1e9;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            PaintedEdge alone(brush, 0.02);
            alone.place_footprints({samples[i]});
            least = std::min(least, alone.nearest(p, 0).distance_mm);
        }
        CHECK(edge.nearest(p, std::size_t(trial) % samples.size()).distance_mm == doctest::Approx(least).epsilon(1e-9));
        int crossed = 0;
        for (const Ring& ring : target)
            for (Eigen::Index i = 0; i < ring.rows(); ++i) {
                const V a = ring.row(i).transpose(), b = ring.row((i + 1) % ring.rows()).transpose();
                const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
                other = std::min(other, (p - a - t * (b - a)).norm());
                crossed += (a.y() > p.y()) != (b.y() > p.y()) &&
                           p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y());
            }
        CHECK(edges.nearest(p).distance_mm == doctest::Approx(crossed % 2 ? -other : other).epsilon(1e-9));
    }
}

TEST_CASE("for any unknowns the brush follows the computed path") {
    const Brush brush = shipped("round-6");
    std::mt19937 random(6);
    for (const Stroke& s : {line(), taper(), corner(), hook(), curve()}) {
        const PatchPath path = path_of(s, brush, 8);
        const PatchSamples samples = path.at(anything(path.unknowns(), random));
        Pass pass;
        pass.poses_mm = poses_along(samples, brush, 1e-3);
        const PassMarks marks = simulate(pass, brush);
        double farthest = 0.0;
        for (const PatchSample& sample : samples) {
            double nearest = 1e9;
            for (Eigen::Index i = 0; i + 1 < marks.contact_mm.rows(); ++i) {
                const V a = marks.contact_mm.row(i).transpose(), d = marks.contact_mm.row(i + 1).transpose() - a;
                const double t =
                    d.squaredNorm() > 0 ? std::clamp((sample.contact_mm - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
                nearest = std::min(nearest, (sample.contact_mm - a - t * d).norm());
            }
            farthest = std::max(farthest, nearest);
        }
        CHECK(farthest < 0.1);
    }
}

TEST_CASE("a line, a taper, a corner, a hook, a curve and a blunt head are painted better") {
    const Brush brush = shipped("round-6");
    struct Case {
        Stroke stroke;
        double at_least;  // slightly below the overlap that was reached
    };
    for (const Case& each : {Case{line(), 0.971},
                             {taper(), 0.965},
                             {corner(), 0.979},
                             {hook(), 0.970},
                             {curve(), 0.982},
                             {head(), 0.81}}) {
        const double closed = overlap_of(each.stroke, compensate(each.stroke, brush).pass, brush);
        const RefinedPass r = refine(each.stroke, brush);
        const double refined = overlap_of(each.stroke, r.plan.pass, brush);
        MESSAGE(closed << " -> " << refined);
        CHECK(r.is_improved);
        CHECK(refined > closed);
        CHECK(refined >= each.at_least);
        CHECK(std::abs(r.overlap - refined) < 0.003);
        CHECK(std::abs(r.overlap_closed - closed) < 0.003);
        CHECK(r.plan.tracking_error.largest_mm > 0.0);
    }
}

TEST_CASE("refined plans are never worse and within the brush's depths on random strokes, also rotated and mirrored") {
    const Brush brush = shipped("round-6");
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(10.0, 70.0), half(0.5, 3.5);
    for (int trial = 0; trial < 12; ++trial) {
        Cubics middle(1, 8);
        for (int k = 0; k < 8; ++k) middle(0, k) = place(random);
        const Stroke s = stroke_of(middle, {{0.0, half(random)}, {0.4, half(random)}, {1.0, half(random)}});
        const double closed = overlap_of(s, compensate(s, brush).pass, brush);
        const RefinedPass r = refine(s, brush);
        const double refined = overlap_of(s, r.plan.pass, brush);
        CHECK(refined >= closed);
        CHECK(r.plan.pass.poses_mm.col(2).maxCoeff() <= 0.0);
        CHECK(-r.plan.pass.poses_mm.col(2).minCoeff() <= brush.depth_range_mm[1]);
        if (trial % 4) continue;
        CHECK(std::abs(refine(turned(s, 0.7), brush).overlap - r.overlap) < 0.01);
        CHECK(std::abs(refine(mirrored(s), brush).overlap - r.overlap) < 0.01);
    }
}

TEST_CASE("the same stroke gives the same plan, to the last bit") {
    const Brush brush = shipped("round-6");
    CHECK(refine(curve(), brush).plan.pass.poses_mm == refine(curve(), brush).plan.pass.poses_mm);
}

TEST_CASE("dabs, hairlines, closed lines, pens and threads are painted or left unchanged") {
    const Brush brush = shipped("round-6");
    Stroke ring = stroke_of(polyline({V(30, 30), V(60, 30), V(60, 60), V(30, 60), V(30, 30)}), {{0.0, 1.5}});
    ring.closed = true;
    for (const Stroke& s : {stroke_of(polyline({V(30, 30), V(30, 30)}), {{0.0, 2.0}}),
                            stroke_of(polyline({V(30, 30), V(32, 30)}), {{0.0, 2.0}}),
                            stroke_of(polyline({V(30, 30), V(60, 30)}), {{0.0, 0.1}}), ring,
                            stroke_of(polyline({V(0, 30), V(4000, 30)}), {{0.0, 0.5}})}) {
        const RefinedPass r = refine(s, brush);
        CHECK(r.overlap >= r.overlap_closed);
        CHECK(r.plan.pass.poses_mm.allFinite());
    }
    const Brush pen = shipped("rigid");
    CHECK_FALSE(refine(line(), pen).is_improved);
    CHECK(refine(line(), pen).plan.pass.poses_mm == compensate(line(), pen).pass.poses_mm);
}

TEST_CASE("rings without points or area in a target outline change nothing") {
    const Brush brush = shipped("round-6");
    Stroke with_empty = head(), flat = line();
    with_empty.target_mm.insert(with_empty.target_mm.begin(), Ring(0, 2));
    CHECK(refine(with_empty, brush).plan.pass.poses_mm == refine(head(), brush).plan.pass.poses_mm);
    Ring thread(3, 2);
    thread << 20, 20, 50, 20, 35, 20;
    flat.target_mm = {thread};
    CHECK_FALSE(refine(flat, brush).is_improved);
    flat.target_mm = {Ring(0, 2)};
    CHECK_FALSE(refine(flat, brush).is_improved);
}

TEST_CASE("refined plans keep paint and tool on the sheet") {
    const Brush brush = shipped("round-6");
    // the target mark's end is on the edge of the sheet; the closed form begins 0.9 mm inside of it
    const Stroke s = stroke_of(polyline({V(1.7, 20), V(40, 20)}), {{0.0, 1.7}});
    RefineOptions on_sheet;
    on_sheet.sheet_mm = {60.0, 40.0};
    const RefinedPass kept = refine(s, brush, on_sheet);
    CHECK(painted_bounds(simulate(kept.plan.pass, brush), brush)[0] >=
          std::min(0.0, painted_bounds(simulate(compensate(s, brush).pass, brush), brush)[0]));
    on_sheet.sheet_mm = {60.0, 20.0};  // half of the mark is outside: no further than before
    const RefinedPass half = refine(s, brush, on_sheet);
    CHECK(painted_bounds(simulate(half.plan.pass, brush), brush)[3] <=
          painted_bounds(simulate(compensate(s, brush).pass, brush), brush)[3] + 1e-9);
}

TEST_CASE("a sheet without a size is refused, none has no limits") {
    const Brush brush = shipped("round-6");
    RefineOptions options;
    options.iterations = 1;
    CHECK_FALSE(refusal([&] { refine(line(), brush, options); }));
    for (const double side : {-3.0, 0.0, std::nan("")}) {
        options.sheet_mm = {side, 60.0};
        CHECK(agrees(refusal([&] { refine(line(), brush, options); }), "out-of-range", "sheet_mm"));
    }
}
