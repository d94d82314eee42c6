#include "many_strokes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "brushsvg/error.hpp"
#include "brushsvg/lag_arc.hpp"
#include "marks/pass_walk.hpp"
#include "refusal.hpp"
#ifdef BRUSHSVG_HIGHWAY
#include <hwy/targets.h>
#endif

using namespace brushsvg;
using Eigen::Index;
using V = Eigen::Vector2d;

namespace {

constexpr double kPi = 3.14159265358979323846, kSame = 1e-12;

struct Row {
    double x, y, depth, turn = 0.0;  ///< turn: from here to the next row
};
using Rows = std::vector<Row>;

LagLaw<double> law_of(std::vector<double> coefficients) { return make_law({{0.0, 10.0, coefficients}}); }
const std::vector<double> kRound6{3.1, 0.86, 0.31, -0.05, 0.0021};

/// One stroke as a pass is walked, advance() by advance(): the states at its rows.
struct OneByOne {
    const LagLaw<double>& law;
    std::vector<LagState<double>> at;
    LagState<double> state;

    OneByOne(const LagLaw<double>& lag, const Rows& rows) : law(lag), at(rows.size()) {
        struct Way {
            const Rows& rows;
            std::vector<Arc> arcs;
            Index count() const { return Index(rows.size()); }
            V tcp(Index i) const { return {rows[std::size_t(i)].x, rows[std::size_t(i)].y}; }
            double depth(Index i) const { return rows[std::size_t(i)].depth; }
            double turn(const Arc&, Index i) const { return rows[std::size_t(i)].turn; }
        } way{rows, {}};
        for (std::size_t i = 0; i < rows.size(); ++i)
            if (rows[i].turn != 0.0) way.arcs.push_back({Index(i), Index(i) + 1, {0.0, 0.0}, 1});
        if (rows[0].depth < 0.0) at[0].contact = way.tcp(0);
        walk_pass<double>(way, false, *this);
        // a walk that ends below is lifted on the spot, which is no row
        if (rows.back().depth > 0.0) at.back() = before_last;
    }
    bool is_done() const { return false; }
    void above(Index i, const AboveStretch<double>& stretch, double, bool touches) {
        if (touches) return;
        state.contact = stretch.to;
        state.taut = false;
        at[std::size_t(i) + 1] = state;
    }
    void touch(Index i, double share, const V& tcp) {
        const V heading = state.heading;
        state = touch_down<double>(tcp);
        state.heading = heading;
        at[std::size_t(i) + (share > 0.0 ? 1 : 0)] = state;
    }
    template <class Motion>
    void move(const Motion& m, Index i, double begin, double end) {
        if (std::size_t(i) + 1 == at.size() && begin == end) before_last = state;
        advance(law, m, state);
        at[std::size_t(i) + (end > 0.0 ? 1 : 0)] = state;
    }
    LagState<double> before_last;
};

ManyWays ways_of(const std::vector<Rows>& strokes) {
    const Index rows = Index(strokes[0].size()), lanes = Index(strokes.size());
    ManyWays out;
    for (Lanes* numbers : {&out.x_mm, &out.y_mm, &out.depth_mm}) numbers->resize(rows, lanes);
    out.turn_rad.resize(rows - 1, lanes);
    for (Index lane = 0; lane < lanes; ++lane)
        for (Index i = 0; i < rows; ++i) {
            const Row& row = strokes[std::size_t(lane)][std::size_t(i)];
            out.x_mm(i, lane) = row.x;
            out.y_mm(i, lane) = row.y;
            out.depth_mm(i, lane) = row.depth;
            if (i + 1 < rows) out.turn_rad(i, lane) = row.turn;
        }
    if ((out.turn_rad == 0.0).all()) out.turn_rad.resize(0, 0);
    return out;
}

/// What holds with every kind of vector instructions that this machine has, and without.
void with_each(const std::function<void()>& check) {
#ifdef BRUSHSVG_HIGHWAY
    const auto only = [](int64_t target) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    };
    hwy::SetSupportedTargetsForTest(0);
    for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
        CAPTURE(hwy::TargetName(target));
        only(target);
        check();
    }
    only(0);
#else
    check();
#endif
}

/// Farthest that a lane is from its stroke by itself, and headings before the first one left out.
void hold_against(const std::vector<Rows>& strokes, const std::vector<LagLaw<double>>& lags, const ManyStates& many) {
    for (Index lane = 0; lane < many.taut.cols(); ++lane) {
        const Rows& rows = strokes[strokes.size() == 1 ? 0 : std::size_t(lane)];
        const LagLaw<double>& law = lags[lags.size() == 1 ? 0 : std::size_t(lane)];
        const OneByOne alone(law, rows);
        CAPTURE(lane);
        bool headed = false;  // since it was set down
        for (Index i = 0; i < many.taut.rows(); ++i) {
            CAPTURE(i);
            const LagState<double>& one = alone.at[std::size_t(i)];
            REQUIRE((V(many.contact_x_mm(i, lane), many.contact_y_mm(i, lane)) - one.contact).norm() <= kSame);
            REQUIRE(bool(many.taut(i, lane)) == one.taut);
            headed = headed || one.heading_known || (one.taut && !law.rigid);
            if (headed) REQUIRE((V(many.heading_x(i, lane), many.heading_y(i, lane)) - one.heading).norm() <= kSame);
            if (rows[std::size_t(i)].depth < 0.0) headed = false;
        }
    }
}

/// Wanders, presses, stands still, turns on the spot, lifts and comes down again; arcs where requested.
Rows random_stroke(std::mt19937& random, int count, bool arcs) {
    std::uniform_real_distribution<double> share(0.0, 1.0);
    std::normal_distribution<double> normal;
    Rows rows;
    double heading = 2.0 * kPi * share(random);
    Row at{10.0 * normal(random), 10.0 * normal(random), share(random) < 0.3 ? -2.0 : 8.0 * share(random)};
    for (int i = 0; i < count; ++i) {
        rows.push_back(at);
        const double what = share(random);
        if (what < 0.06) {  // on the spot: pressed or lifted a little
            at.depth = std::max(0.0, std::min(9.9, at.depth + normal(random)));
            continue;
        }
        if (what < 0.1) continue;         // nothing at all
        if (what < 0.12) heading += kPi;  // back the way it came
        if (what < 0.16) heading += normal(random);
        heading += 0.1 * normal(random);
        const double length = what < 0.2 ? 1e-9 : what < 0.25 ? 8.0 * share(random) : 0.5;
        at.x += length * std::cos(heading);
        at.y += length * std::sin(heading);
        if (what > 0.97)
            at.depth = -1.0;
        else if (at.depth < 0.0)
            at.depth = what > 0.5 ? 3.0 : -0.5;
        else if (what > 0.9)
            at.depth = what > 0.93 ? 0.0 : 9.0 * share(random);
        else if (arcs && what > 0.6 && length > 0.1 && rows.back().depth >= 0.0)
            rows.back().turn = (what > 0.75 ? 1.0 : -1.0) * (0.1 + 2.0 * share(random));
        else
            at.depth = std::clamp(at.depth + 0.05 * normal(random), 0.0, 9.9);
    }
    return rows;
}

}  // namespace

TEST_CASE("many strokes at once are the same as one after the other") {
    const std::vector<LagLaw<double>> laws{
        law_of(kRound6),                                         // one polynomial
        law_of({4.0}),                                           // always as long
        law_of({0.0, 1.1}),                                      // no lever at depth 0
        law_of({0.5, -0.2, 0.0217}),                             // roots close by: more nodes
        make_law({{0.0, 2.0, {1.0}}, {2.0, 10.0, {0.0, 0.5}}}),  // a kink
        law_of({0.0}),                                           // a pen
    };
    std::mt19937 random(4);
    for (const bool arcs : {false, true}) {
        std::vector<Rows> strokes;
        std::vector<LagLaw<double>> each;
        for (int lane = 0; lane < 61; ++lane) {  // no whole number of vectors
            strokes.push_back(random_stroke(random, 300, arcs));
            each.push_back(laws[std::size_t(lane) % laws.size()]);
        }
        with_each([&] { hold_against(strokes, each, follow_many(ways_of(strokes), each)); });
        for (const LagLaw<double>& law : laws)
            with_each([&] { hold_against(strokes, {law}, follow_many(ways_of(strokes), {law})); });
        const std::vector<Rows> one{strokes[5]};
        with_each([&] { hold_against(one, each, follow_many(ways_of(one), each)); });
    }
}

TEST_CASE("a quarter turn of the lag on a straight line, by the closed form") {
    // tan(alpha/2) = exp(-s/r) tan(alpha0/2), whichever lane: r from 1 to 4, taut at alpha0 = 90 degrees
    std::vector<LagLaw<double>> lags;
    for (int k = 0; k < 13; ++k) lags.push_back(law_of({1.0 + 0.25 * k}));
    Rows rows{{0.0, -20.0, 1.0}, {0.0, 0.0, 1.0}};  // drawn out upwards first
    for (int i = 1; i <= 20; ++i) rows.push_back({0.5 * i, 0.0, 1.0});
    with_each([&] {
        const ManyStates many = follow_many(ways_of({rows}), lags);
        for (Index lane = 0; lane < 13; ++lane)
            for (Index i = 2; i < many.taut.rows(); ++i) {
                // drawn out over the whole way up but for where it was set down: not quite upright
                const double r = 1.0 + 0.25 * double(lane), s = 0.5 * double(i - 1);
                const double alpha = std::atan2(many.heading_y(i, lane), many.heading_x(i, lane));
                CHECK(std::abs(std::tan(0.5 * alpha) - std::exp(-s / r)) < 1e-12);
                CHECK(std::abs(many.contact_x_mm(i, lane) - (s - r * std::cos(alpha))) < 1e-12);
            }
    });
}

TEST_CASE("a dab, and a brush that never moves") {
    const Rows dab{{5.0, 6.0, -1.0}, {5.0, 6.0, 3.0}, {5.0, 6.0, -1.0}, {5.0, 6.0, -1.0}};
    const ManyStates many = follow_many(ways_of({dab}), {law_of(kRound6), law_of({2.0})});
    CHECK((many.contact_x_mm == 5.0).all());
    CHECK((many.contact_y_mm == 6.0).all());
    CHECK((many.heading_x == 1.0).all());
    CHECK((many.taut == 0).all());
}

TEST_CASE("rows before the first motion take the first heading") {
    const Rows rows{{0.0, 0.0, 0.0}, {0.0, 0.0, 2.0}, {0.0, 1.0, 2.0}, {0.0, 9.0, 2.0}};
    const ManyStates many = follow_many(ways_of({rows}), {law_of({3.0})});
    CHECK((many.heading_x.abs() < 1e-15).all());
    CHECK((many.heading_y - 1.0).abs().maxCoeff() < 1e-15);
    Rows twice = rows;
    for (const Row& row : {Row{0.0, 9.0, -1.0}, {3.0, 9.0, -1.0}, {3.0, 9.0, 0.0}, {3.0, 9.0, 2.0}, {9.0, 9.0, 2.0}})
        twice.push_back(row);
    const ManyStates again = follow_many(ways_of({twice}), {law_of({3.0})});
    CHECK(again.heading_y.topRows(6).minCoeff() > 1.0 - 1e-15);
    CHECK(again.heading_x.bottomRows(3).minCoeff() > 1.0 - 1e-15);
}

TEST_CASE("memory of an earlier call changes nothing") {
    std::mt19937 random(9);
    ManyStates out;
    const std::vector<LagLaw<double>> law{law_of(kRound6)};
    for (int lanes : {5, 5, 3}) {
        std::vector<Rows> strokes;
        for (int k = 0; k < lanes; ++k) strokes.push_back(random_stroke(random, 40, false));
        follow_many(ways_of(strokes), law, out);
        CHECK(out.taut.cols() == lanes);
        hold_against(strokes, law, out);
    }
}

TEST_CASE("many ways that nothing can be computed with") {
    const ManyWays good = ways_of({Rows{{0.0, 0.0, 1.0}, {1.0, 0.0, 1.0}, {2.0, 0.0, 1.0}}});
    const std::vector<LagLaw<double>> law{law_of(kRound6)};
    const auto refused = [&](const std::function<void(ManyWays&)>& spoil) {
        ManyWays ways = good;
        spoil(ways);
        return refusal([&] { follow_many(ways, law); });
    };
    CHECK(!refusal([&] { follow_many(good, law); }));
    CHECK(agrees(refusal([&] { follow_many(ManyWays{}, law); }), "sizes-differ", ""));
    CHECK(agrees(refusal([&] { follow_many(good, {}); }), "sizes-differ", ""));
    CHECK(agrees(refusal([&] { follow_many(good, {LagLaw<double>{}}); }), "law-terms", ""));
    CHECK(agrees(refused([](ManyWays& w) { w.y_mm.resize(2, 1); }), "sizes-differ", ""));
    CHECK(agrees(refused([](ManyWays& w) { w.turn_rad = Lanes::Zero(3, 1); }), "sizes-differ", ""));
    CHECK(agrees(refused([](ManyWays& w) { w.x_mm(2, 0) = std::numeric_limits<double>::quiet_NaN(); }), "not-finite",
                 "", {"2"}));
    CHECK(agrees(refused([](ManyWays& w) { w.y_mm(0, 0) = -2e6; }), "geometry-out-of-range", "", {"0", "2e+06"}));
    CHECK(agrees(refused([](ManyWays& w) { w.depth_mm(1, 0) = 10.5; }), "depth-out-of-range", "",
                 {"10.500", "1", "[0, 10.0]"}));
    CHECK(agrees(refused([](ManyWays& w) {
                     w.turn_rad = Lanes::Zero(2, 1);
                     w.turn_rad(1, 0) = 7.0;
                 }),
                 "out-of-range", "", {"1", "7.000"}));
    CHECK(agrees(refused([](ManyWays& w) {
                     w.turn_rad = Lanes::Constant(2, 1, 0.1);
                     w.depth_mm(2, 0) = 2.0;
                 }),
                 "arc-invalid", "", {"1"}));
    const ManyWays two = ways_of({Rows{{0.0, 0.0, 1.0}}, Rows{{1.0, 0.0, 1.0}}});
    CHECK(agrees(refusal([&] { follow_many(two, {law[0], law[0], law[0]}); }), "sizes-differ", "", {"2", "3"}));
}
