// Every input of the fits gives Error or finite numbers, without a crash or a hang.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "angles.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/coverage.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/simulate.hpp"
#include "law_fit.hpp"
#include "mark_fit.hpp"
#include "round6.hpp"

using namespace brushsvg;
using namespace brushsvg::fit;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
const std::vector<double> kNever{kNan, kInf, -kInf, 1e300, -1e300, 5.5e9};

bool is_refused(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& e) {
        CHECK(std::string(e.what()).size() > 10);
        return true;
    }
    return false;
}

struct Values {
    std::vector<double> depth{1, 2, 3, 4, 5, 6}, value{3, 4, 5, 6.5, 7, 8};
    LawShape shape{{0.0, 10.0}, 2};
};

struct Drag {
    AngleSeries series{1.5, {1, 3, 6}, {1.2, 0.9, 0.5}, {2.3, 2.0, 1.6}};
    Lines lines = Lines::total;
};

/// Marks of corners at three depths, painted by a brush.
struct Sheet {
    std::vector<PaintedMark> marks;
    MarkOptions options;
    std::optional<MarkLaws> start;
    Sheet() {
        const Brush brush = shipped("round-6");
        for (const double depth : {2.0, 5.0, 8.0}) {
            Pass pass;
            pass.stroke = "s" + std::to_string(marks.size());
            pass.poses_mm.resize(4, 3);
            pass.poses_mm << 0, 0, 0, 12, 0, -depth, 30, 0, -depth, 30, 25, -depth;
            marks.push_back({pass.stroke, pass.poses_mm, outline(simulate(pass, brush), brush)});
        }
        options.spacing_mm = 3.0;
        options.max_iterations = 5;
    }
};

template <class Given, class Call>
void each_is_refused(const std::vector<std::pair<std::string, std::function<void(Given&)>>>& changes, Call&& call) {
    Given sound;
    CHECK(!is_refused([&] { call(sound); }));
    for (const auto& [what, change] : changes) {
        CAPTURE(what);
        Given given;
        change(given);
        CHECK(is_refused([&, &g = given] { call(g); }));
    }
}

}  // namespace

TEST_CASE("fit_law refuses invalid measurements") {
    std::vector<std::pair<std::string, std::function<void(Values&)>>> changes{
        {"nothing", [](Values& v) { v.depth = v.value = {}; }},
        {"nothing, smoothed", [](Values& v) { v.depth = v.value = {}, v.shape.smoothing = 1.0; }},
        {"more depths", [](Values& v) { v.depth.push_back(7.0); }},
        {"one depth", [](Values& v) { v.depth.assign(6, 3.0); }},
        {"range that falls", [](Values& v) { v.shape.range_mm = {10.0, 0.0}; }},
        {"range of nothing", [](Values& v) { v.shape.range_mm = {3.0, 3.0}; }},
        {"degree -1", [](Values& v) { v.shape.degree = -1; }},
        {"degree 9", [](Values& v) { v.shape.degree = 9; }},
        {"nothing to fit", [](Values& v) { v.shape.degree = 0, v.shape.through_zero = true; }},
        {"smoothing below 0", [](Values& v) { v.shape.smoothing = -1.0; }},
        {"floor above all", [](Values& v) { v.shape.floor = kInf; }},
    };
    for (const double x : kNever) {
        changes.push_back({"depth", [x](Values& v) { v.depth[2] = x; }});
        changes.push_back({"value", [x](Values& v) { v.value[2] = x; }});
        changes.push_back({"range", [x](Values& v) { v.shape.range_mm[1] = x; }});
        changes.push_back({"smoothing", [x](Values& v) { v.shape.smoothing = x; }});
        if (x != -kInf) changes.push_back({"floor", [x](Values& v) { v.shape.floor = x; }});
    }
    for (const Norm norm : {Norm::squares, Norm::absolute})
        each_is_refused<Values>(changes, [&](Values& v) {
            v.shape.norm = norm;
            const LawFit found = fit_law(v.depth, v.value, v.shape);
            for (const double c : found.law.coefficients) CHECK(std::isfinite(c));
        });
}

TEST_CASE("a law with a floor through a hundred thousand depths needs little memory") {
    Values v;
    v.shape.floor = 0.0;
    v.depth.clear();
    v.value.clear();
    for (int i = 0; i < 100000; ++i) {
        v.depth.push_back(1e-4 * i);
        v.value.push_back(v.depth.back() - 1.0);
    }
    const LawFit found = fit_law(v.depth, v.value, v.shape);
    CHECK(found.law(5.0) == doctest::Approx(4.0));
}

TEST_CASE("from_angles refuses invalid drags") {
    std::vector<std::pair<std::string, std::function<void(Drag&)>>> changes{
        {"nothing", [](Drag& d) { d.series.s_mm = d.series.alpha = d.series.beta = {}; }},
        {"fewer angles", [](Drag& d) { d.series.alpha.pop_back(); }},
        {"more directions", [](Drag& d) { d.series.beta.push_back(1.0); }},
        {"reversed", [](Drag& d) { d.series.alpha = {1.6, 1.7, 1.8}; }},
        {"nothing moved", [](Drag& d) { d.series.s_mm.assign(3, 0.0); }},
        {"hardly turned", [](Drag& d) { d.series.alpha.assign(3, std::nextafter(1.5, 0.0)); }},
    };
    for (const double x : kNever) {
        changes.push_back({"s", [x](Drag& d) { d.series.s_mm[1] = x; }});
        changes.push_back({"alpha", [x](Drag& d) { d.series.alpha[1] = x; }});
        changes.push_back({"beta", [x](Drag& d) { d.series.beta[1] = x; }});
        changes.push_back({"alpha0", [x](Drag& d) { d.series.alpha0 = x; }});
    }
    for (const Lines lines : {Lines::plain, Lines::total})
        each_is_refused<Drag>(changes, [&](Drag& d) {
            const FromAngles found = from_angles(d.series, lines);
            CHECK(std::isfinite(found.lag_mm + found.tip_gap_mm));
        });
}

TEST_CASE("fit_marks refuses invalid sheets") {
    std::vector<std::pair<std::string, std::function<void(Sheet&)>>> changes{
        {"no mark", [](Sheet& s) { s.marks = {}; }},
        {"no pose", [](Sheet& s) { s.marks[1].poses_mm.resize(0, 3); }},
        {"no ring", [](Sheet& s) { s.marks[1].outline_mm = {}; }},
        {"a ring of nothing", [](Sheet& s) { s.marks[1].outline_mm[0].resize(0, 2); }},
        {"clockwise", [](Sheet& s) { s.marks[1].outline_mm[0] = s.marks[1].outline_mm[0].colwise().reverse().eval(); }},
        {"far away", [](Sheet& s) { s.marks[1].outline_mm[0] *= 2e5; }},
        {"a stroke of a kilometre", [](Sheet& s) { s.marks[1].poses_mm(1, 0) = 1e6; }},
        {"no terms", [](Sheet& s) { s.options.half_width_terms = 0; }},
        {"five terms", [](Sheet& s) { s.options.lag_terms = 5; }},
        {"minus three terms of a ratio", [](Sheet& s) { s.options.widest_terms = -3; }},
        {"no terms of the other ratio", [](Sheet& s) { s.options.front_terms = 0; }},
        {"no iterations", [](Sheet& s) { s.options.max_iterations = -1; }},
        {"start of nothing", [](Sheet& s) { s.start = MarkLaws{{kNan}, {}, {}}; }},
    };
    for (const double x : {kNan, kInf, -kInf, 1e300, -1.0}) {
        const bool is_far = !(x == -1.0);
        if (is_far) changes.push_back({"pose", [x](Sheet& s) { s.marks[0].poses_mm(1, 1) = x; }});
        if (is_far) changes.push_back({"outline", [x](Sheet& s) { s.marks[0].outline_mm[0](1, 1) = x; }});
        changes.push_back({"deepest", [x](Sheet& s) { s.options.deepest_mm = x; }});
        changes.push_back({"spacing", [x](Sheet& s) { s.options.spacing_mm = x; }});
        changes.push_back({"widest", [x](Sheet& s) { s.options.widest_per_half.value = x; }});
        if (is_far) changes.push_back({"height", [x](Sheet& s) { s.options.height_mm.value = x; }});
        if (x > 0.0) continue;  // a huge sigma is valid: nothing is known
        changes.push_back({"front's sigma", [x](Sheet& s) { s.options.front_per_half.sigma = x; }});
        changes.push_back({"placement", [x](Sheet& s) { s.options.placement_mm = x; }});
        changes.push_back({"turn", [x](Sheet& s) { s.options.turn_rad = x; }});
        changes.push_back({"displacement", [x](Sheet& s) { s.options.displacement_mm = x; }});
        changes.push_back({"noise", [x](Sheet& s) { s.options.noise_mm = x; }});
    }
    changes.push_back({"fine spacing", [](Sheet& s) { s.options.spacing_mm = 1e-300; }});
    each_is_refused<Sheet>(changes, [](Sheet& s) {
        const MarkFit found = fit_marks(s.marks, s.start, s.options);
        for (const double c : found.laws.lag) CHECK(std::isfinite(c));
        for (const auto& row : found.covariance)
            for (const double c : row) CHECK(std::isfinite(c));
    });
}

TEST_CASE("fits can be cancelled, and leave no state behind") {
    Sheet sheet;
    sheet.options.spacing_mm = 0.2;
    const MarkLaws start{{4.0, 0.5}, {0.0, 0.5}, {0.0, 0.4}};
    Values v;
    v.shape.floor = 0.0;
    v.shape.norm = Norm::absolute;
    for (int i = 0; i < 5000; ++i) {
        v.depth.push_back(1.0 + 0.1 * (i % 80));
        v.value.push_back(2.0 + std::sin(0.1 * i));
    }
    const std::vector<std::pair<std::string, std::function<void()>>> calls{
        {"law", [&] { fit_law(v.depth, v.value, v.shape); }},
        {"marks", [&] { fit_marks(sheet.marks, std::nullopt, sheet.options); }},
        {"marks from laws", [&] { fit_marks(sheet.marks, start, sheet.options); }}};
    for (const auto& [what, call] : calls) {
        CAPTURE(what);
        int asked = 0;
        {
            const CancelWhen second([&] { return ++asked == 2; });
            CHECK_THROWS_AS(call(), Cancelled);
        }
        CHECK(asked == 2);
    }
    Sheet small;  // the buffers that threads keep must not change the result
    const MarkFit after = fit_marks(small.marks, std::nullopt, small.options);
    CHECK(after.laws.lag == fit_marks(small.marks, std::nullopt, small.options).laws.lag);
}
