#include "brushsvg/lag.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "dual.hpp"

using namespace brushsvg;
using V = Eigen::Vector2d;

namespace {

constexpr double kPi = 3.14159265358979323846;

LagLaw<double> law_of(std::vector<double> coefficients, double hi = 10.0) {
    return make_law({{0.0, hi, coefficients}});
}

LagState<double> taut(const V& tcp, double lag, double theta) {
    LagState<double> s;
    s.heading = V(std::cos(theta), std::sin(theta));
    s.contact = tcp - lag * s.heading;
    s.taut = s.heading_known = true;
    return s;
}

}  // namespace

TEST_CASE("figure 3: r = 3, b = 1, alpha0 = 90 degrees") {
    const auto law = law_of({3.0});
    const double table[][7] = {{0.3, 1.470962578, 0.000996016, -2.985062247, -0.098671978, -3.980082996, 2.942418246},
                               {1, 1.243469712, 0.035461787, -2.840715761, -0.286050950, -3.787621015, 2.502940052},
                               {3, 0.705026844, 0.715217532, -1.944162821, -0.046376624, -2.592217095, 1.603727440},
                               {6, 0.269035991, 3.107917260, -0.797406687, 2.143889680, -1.063208915, 0.940211420},
                               {12, 0.036627182, 9.002012101, -0.109856980, 8.002682801, -0.146475974, 0.448761937}};
    for (const auto& row : table) {
        auto state = taut(V(0, 0), 3.0, kPi / 2);
        advance(law, Move<double>(V(0, 0), V(row[0], 0), 5.0, 5.0), state);
        const double alpha = std::atan2(state.heading.y(), state.heading.x());
        CHECK(std::abs(alpha - row[1]) < 1e-8);
        CHECK((state.contact - V(row[2], row[3])).norm() < 1e-8);
        CHECK((state.contact - 1.0 * state.heading - V(row[4], row[5])).norm() < 1e-8);
        CHECK(std::abs(tip_direction(kPi / 2, alpha, row[0], 3.0, 1.0) - row[6]) < 1e-8);
    }
}

TEST_CASE("depth 2 to 8 over 20 mm with the article's quartic") {
    const auto law = law_of({3.1, 0.86, 0.31, -0.05, 0.0021});
    CHECK(std::abs(lag_exponent(law.pieces[0], 2.0, 8.0, 20.0) - 2.138103176) < 1e-9);
    // only article (7): the loose rule would apply here, since cos(1.2) < dr/ds
    const auto state = state_in_phase(law.pieces[0], Move<double>(V(0, 0), V(20, 0), 2.0, 8.0),
                                      taut(V(0, 0), law.at(2.0), 1.2), 0.0, 1.0);
    CHECK(std::abs(std::atan2(state.heading.y(), state.heading.x()) - 0.160941370) < 1e-8);
}

TEST_CASE("the quadrature's nodes are chosen by the nearest root: fine against many splits") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> depth(0.0, 10.0);
    for (const auto& c : {std::vector<double>{3.1, 0.86, 0.31, -0.05, 0.0021},
                          {0.05, 0.9},
                          {1.0, -0.3, 0.0226},
                          {0.6, 0.0, 0.0, 0.4, 0.02, 0.001}}) {
        const auto law = law_of(c);
        for (int k = 0; k < 200; ++k) {
            const double a = depth(random), b = k % 3 ? depth(random) : a + 1e-3 * depth(random);
            double fine = 0.0;
            for (int i = 0; i < 4096; ++i)
                fine += lag_exponent(law.pieces[0], a + (b - a) * i / 4096, a + (b - a) * (i + 1) / 4096, 1.0 / 4096);
            const double x = lag_exponent(law.pieces[0], a, b, 1.0);
            if (fine < 50.0)
                CHECK(std::abs(x / fine - 1.0) < 1e-11);
            else
                CHECK(x >= 50.0);  // e^-50: nothing remains of the old heading
        }
    }
}

TEST_CASE("figure 12: the patch's distance from the TCP's second line") {
    const auto law = law_of({13.0});
    const double expected[][2] = {{10, 9.918081}, {20, 5.336474}, {40, 1.196081}, {80, 0.055257}};
    for (const auto& row : expected) {
        auto state = taut(V(0, 0), 13.0, kPi / 2);
        advance(law, Move<double>(V(0, 0), V(row[0], 0), 5.0, 5.0), state);
        CHECK(std::abs(std::abs(state.contact.y()) - row[1]) < 1e-6);
    }
}

TEST_CASE("loose: the patch rests for -2 r cos(psi0), then psi is pi - psi0 on the same side") {
    const auto law = law_of({5.0});
    for (double psi0 : {1.8, 2.5, -2.0, 3.0}) {
        auto state = taut(V(0, 0), 5.0, psi0);
        const V contact = state.contact;
        const double rest = -2.0 * 5.0 * std::cos(psi0);
        advance(law, Move<double>(V(0, 0), V(rest * 0.999, 0), 2.0, 2.0), state);
        CHECK((state.contact - contact).norm() == 0.0);
        CHECK_FALSE(state.taut);
        advance(law, Move<double>(V(rest * 0.999, 0), V(rest, 0), 2.0, 2.0), state);
        const double psi = std::atan2(state.heading.y(), state.heading.x());
        CHECK(std::abs(psi - std::copysign(kPi - std::abs(psi0), psi0)) < 1e-9);
    }
}

TEST_CASE("pressing faster than 0.62 mm per mm loosens a settled drag, inside a move too") {
    const auto law = law_of({3.1, 0.86, 0.31, -0.05, 0.0021});
    const auto press = [&](double slope, double from) {
        auto state = taut(V(0, 0), law.at(from), 0.0);
        int loose = 0;
        advance(law, Move<double>(V(0, 0), V(4, 0), from, from + 4 * slope), state,
                [&](const auto&, const auto&, const LagState<double>& start, double, double) { loose += !start.taut; });
        return loose;
    };
    // dr/dd is greatest, 1.61, at depth 2.66: there the limit is 1 / 1.61 mm per mm
    CHECK(press(0.60, 1.0) == 0);
    CHECK(press(0.70, 1.2) > 0);
}

TEST_CASE("a plain vertical lift drags a tail of r(d) - r(0)") {
    const auto law = law_of({3.1, 0.86, 0.31, -0.05, 0.0021});
    for (const auto& [depth, tail] : {std::pair{3.0, 4.2}, {6.0, 8.2}, {10.0, 10.6}}) {
        auto state = taut(V(0, 0), law.at(depth), 0.0);
        const V before = state.contact;
        advance(law, Move<double>(V(0, 0), V(0, 0), depth, 0.0), state);
        CHECK(std::abs((state.contact - before).norm() - tail) < 0.06);
        CHECK(state.taut);
    }
}

TEST_CASE("on a circle smaller than the lag the patch comes to rest at r - R from the centre") {
    const auto law = law_of({5.0});
    const double R = 3.0;
    auto state = taut(V(R, 0), 5.0, kPi / 2);
    for (int k = 0; k < 200000; ++k) {
        const double a = 2 * kPi * k / 2000, b = 2 * kPi * (k + 1) / 2000;
        advance(law, Move<double>(R * V(std::cos(a), std::sin(a)), R * V(std::cos(b), std::sin(b)), 2.0, 2.0), state);
    }
    CHECK(std::abs(state.contact.norm() - 2.0) < 1e-2);
}

TEST_CASE("both roots inside one move are found: tightening between two loose ends") {
    // the lever first grows more slowly than the TCP moves away, then faster
    const auto law = law_of({2.0, 0.0, 0.0, 0.02});
    LagState<double> state = touch_down<double>(V(0, 0));
    int phases = 0, taut_phases = 0;
    advance(law, Move<double>(V(0, 0), V(8, 0), 0.0, 8.0), state,
            [&](const auto&, const auto&, const LagState<double>& start, double, double) {
                ++phases;
                taut_phases += start.taut;
            });
    CHECK(phases == 3);
    CHECK(taut_phases == 1);
    CHECK_FALSE(state.taut);
    CHECK(state.contact.x() > 0.1);
}

TEST_CASE("a rigid pen: p = q, heading = direction of motion, no loose rule") {
    const auto law = law_of({0.0});
    CHECK(law.rigid);
    LagState<double> state = touch_down<double>(V(0, 0));
    advance(law, Move<double>(V(0, 0), V(5, 0), 0.2, 0.2), state);
    advance(law, Move<double>(V(5, 0), V(1, 0), 0.2, 0.2), state);
    CHECK(state.contact == V(1, 0));
    CHECK(state.heading == V(-1, 0));
}

TEST_CASE("a lag that vanishes at depth 0 turns with the motion there") {
    const auto law = law_of({0.0, 0.8});
    auto state = taut(V(0, 0), 0.8, 1.0);
    advance(law, Move<double>(V(0, 0), V(10, 0), 1.0, 0.0), state);
    CHECK((state.contact - V(10, 0)).norm() < 1e-9);
    CHECK(std::abs(state.heading.y()) < 1e-12);
}

TEST_CASE("dual numbers carry derivatives through drags and events") {
    const auto plain = law_of({3.1, 0.86, 0.31, -0.05, 0.0021});
    LagLaw<Dual> law;
    law.pieces.resize(1);
    auto& piece = law.pieces[0];
    const auto& from = plain.pieces[0];
    piece.lo = from.lo, piece.hi = from.hi, piece.degree = from.degree;
    for (int i = 0; i <= from.degree; ++i) piece.coefficients[i] = from.coefficients[i];
    piece.roots = from.roots, piece.max_slope = from.max_slope, piece.max_third_derivative = from.max_third_derivative;

    // A path with a reversal: taut, loose, taut again. The derivative is by the depth of the second half.
    const auto path = [](auto scalar, auto depth, const auto& law_) {
        using T = decltype(scalar);
        using W = Vec2<T>;
        LagState<T> s = touch_down<T>(W(T(0.0), T(0.0)));
        const W q[] = {W(T(0.0), T(0.0)), W(T(12.0), T(0.0)), W(T(20.0), T(3.0)), W(T(4.0), T(5.0)),
                       W(T(-20.0), T(-3.0))};
        const T d[] = {T(0.0), T(3.0), depth, depth, T(2.0)};
        for (int i = 0; i < 4; ++i) advance(law_, Move<T>(q[i], q[i + 1], d[i], d[i + 1]), s);
        return s;
    };
    const double h = 1e-5;
    const V up = path(0.0, 4.0 + h, plain).contact, down = path(0.0, 4.0 - h, plain).contact;
    const auto dual = path(Dual(0.0), Dual(4.0, 1.0), law);
    CHECK(std::abs(dual.contact.x().v - (up.x() - down.x()) / (2 * h)) < 1e-6);
    CHECK(std::abs(dual.contact.y().v - (up.y() - down.y()) / (2 * h)) < 1e-6);
    CHECK(std::abs(dual.contact.y().v) > 1e-3);
}
