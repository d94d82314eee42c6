#include "brushsvg/lag_arc.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "dual.hpp"

using namespace brushsvg;
using V = Eigen::Vector2d;

namespace {

constexpr double kPi = 3.14159265358979323846;

LagLaw<double> law_of(std::vector<double> coefficients) { return make_law({{0.0, 10.0, coefficients}}); }

V unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Return an arc from a point in direction phi.
ArcMove<double> arc_of(const V& from, double phi, double radius, double turn) {
    return {from, unit(phi), radius, turn, 2.0};
}

LagState<double> taut(const V& tcp, double lag, double theta) {
    LagState<double> s;
    s.heading = unit(theta);
    s.contact = tcp - lag * s.heading;
    s.taut = s.heading_known = true;
    return s;
}

double psi_of(const ArcMove<double>& arc, double t, const LagState<double>& state) {
    const V d = arc.direction(t);
    return std::atan2(d.x() * state.heading.y() - d.y() * state.heading.x(), state.heading.dot(d));
}

/// Return (begin, taut) of each phase.
std::vector<std::pair<double, bool>> phases(const LagLaw<double>& law, const ArcMove<double>& arc,
                                            LagState<double>& state) {
    std::vector<std::pair<double, bool>> out;
    double last = 0.0;
    advance(law, arc, state, [&](const auto&, const auto&, const auto& start, double begin, double end) {
        CHECK(begin == last);
        CHECK(end > begin);
        last = end;
        out.emplace_back(begin, start.taut);
    });
    CHECK(last == 1.0);
    return out;
}

}  // namespace

TEST_CASE("the TCP's place on an arc and its chord are inverse at every radius and turn") {
    for (double radius : {0.1, 3.0, 1e3, 1e6})
        for (double turn : {1e-9, 0.01, -0.2, 1.0, -3.0, 3.14}) {
            const ArcMove<double> arc = arc_of({3, 4}, 0.7, radius, turn);
            const V centre = arc.from + (turn > 0 ? radius : -radius) * V(-arc.along.y(), arc.along.x());
            const V target = centre + rotated(V(arc.from - centre), turn);
            CHECK((arc.tcp(1.0) - target).norm() < 1e-15 * radius + 1e-14);
            if (radius * std::abs(turn) < 1e-5) continue;
            const ArcMove<double> same = arc_between<double>(arc.from, arc.tcp(1.0), turn, 2.0);
            CHECK(std::abs(same.radius / radius - 1.0) < 1e-8);
            CHECK((same.along - arc.along).norm() < 1e-8);
            CHECK((same.tcp(1.0) - arc.tcp(1.0)).norm() < 1e-13 * (1.0 + radius * std::abs(turn)));
            CHECK(same.length == doctest::Approx(radius * std::abs(turn)));
        }
}

TEST_CASE("a loose brush with its lever drawn out becomes taut no earlier than the arc starts") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> angle(-kPi, kPi), length(1.0, 20.0), place(-200.0, 200.0);
    const LagLaw<double> law = law_of({8.0});
    for (int i = 0; i < 20000; ++i) {
        const V tcp(place(random), place(random));
        const double phi = angle(random), turn = 0.3 * angle(random);
        LagState<double> state = taut(tcp, 8.0, phi + 0.4 * angle(random));
        state.taut = false;
        advance(law, arc_of(tcp, phi, length(random), turn), state,
                [](const auto&, const auto&, const auto&, double begin, double end) {
                    REQUIRE(begin >= 0.0);
                    REQUIRE(begin < end);
                    REQUIRE(end <= 1.0);
                });
    }
}

TEST_CASE("an arc of the TCP: the printed value, straight ahead, and where it settles") {
    CHECK(std::abs(drag_arc(0.7, 1.0 / 40, 8.0, 60.0) - -0.200791034) < 1e-9);
    CHECK(std::abs(drag_arc(1.2, 0.0, 3.0, 2.0) - 2 * std::atan(std::tan(0.6) * std::exp(-2.0 / 3))) < 1e-14);
    CHECK(std::abs(std::sin(drag_arc(0.3, 0.1, 4.0, 500.0)) + 0.4) < 1e-12);
    CHECK(std::abs(std::sin(drag_arc(0.3, 0.1, 4.0, 1e5)) + 0.4) < 1e-12);  // where a cosh would overflow
    // the value at |k| r = 1 is the limit from both sides
    CHECK(std::abs(drag_arc(0.2, 0.25, 4.0, 3.0) - drag_arc(0.2, 0.25 + 1e-9, 4.0, 3.0)) < 1e-7);
    CHECK(std::abs(drag_arc(0.2, 0.25, 4.0, 3.0) - drag_arc(0.2, 0.25 - 1e-9, 4.0, 3.0)) < 1e-7);
}

TEST_CASE("taut along an arc: contact and heading give the same value in both directions") {
    const auto law = law_of({8.0});
    for (double side : {1.0, -1.0}) {
        const auto arc = arc_of({5, -3}, 2.0, 40.0, side * 60.0 / 40);
        auto state = taut(arc.from, 8.0, 2.0 + side * 0.7);
        CHECK(phases(law, arc, state).size() == 1);
        CHECK(std::abs(psi_of(arc, 1.0, state) - side * -0.200791034) < 1e-9);
        CHECK((arc.tcp(1.0) - 8.0 * state.heading - state.contact).norm() < 1e-12);
    }
}

TEST_CASE("a circle smaller than the lag: psi passes 90 degrees, then the patch rests at r - R from the centre") {
    const double r = 5.0;
    const auto law = law_of({r});
    for (double side : {1.0, -1.0})
        for (double R : {0.5, 3.0, 4.9, 4.9999})
            for (double psi0 : {-1.2, 0.0, 0.9, kPi / 2}) {
                const auto arc = arc_of({R, 0}, side * kPi / 2, R, side * 2000 * kPi);
                auto state = taut(arc.from, r, side * (kPi / 2 + psi0));
                const auto found = phases(law, arc, state);
                REQUIRE(found.size() == 2);
                CHECK(found[0].second);
                CHECK_FALSE(state.taut);
                CHECK(std::abs(state.contact.norm() - (r - R)) < 1e-9);
                // s from psi0 = 90 to -90 degrees is the integral of dpsi / (k + sin(psi)/r) = pi / sqrt(k^2 - 1/r^2)
                if (psi0 == kPi / 2)
                    CHECK(found[1].first * arc.length ==
                          doctest::Approx(kPi / std::sqrt(1 / (R * R) - 1 / (r * r))).epsilon(1e-9));
            }
}

TEST_CASE("pushed: the patch rests until q is as far from it again, on the other side of the line through the centre") {
    const auto law = law_of({5.0});
    for (double R : {3.0, 12.0, 1e4})
        for (double psi0 : {1.7, 2.5, 3.1, -1.7, -2.6}) {
            auto state = taut({0, 0}, 5.0, psi0);
            const V p = state.contact, centre(0, R);
            const V across = (p - centre).normalized();
            // q0 mirrored in the line from the centre through p
            const V mirrored = centre + 2.0 * across * across.dot(-centre) + centre;
            double turn = std::atan2(mirrored.x(), R - mirrored.y());
            if (turn < 0.0) turn += 2 * kPi;
            const auto arc = arc_of({0, 0}, 0.0, R, 1.001 * turn);
            const auto found = phases(law, arc, state);
            REQUIRE(found.size() >= 2);
            CHECK_FALSE(found[0].second);
            CHECK(found[1].second);
            CHECK(std::abs(found[1].first - 1 / 1.001) < 1e-9);
            // in steps that end while the patch rests
            state = taut({0, 0}, 5.0, psi0);
            LagState<double> whole = state;
            advance(law, arc_of({0, 0}, 0.0, R, 0.4 * turn), state);
            CHECK(state.contact == p);
            CHECK_FALSE(state.taut);
            const auto first = arc_of({0, 0}, 0.0, R, 0.4 * turn);
            advance(law, arc_of(first.tcp(1.0), 0.4 * turn, R, 0.7 * turn), state);
            advance(law, arc_of({0, 0}, 0.0, R, 1.1 * turn), whole);
            CHECK((state.contact - whole.contact).norm() < 1e-9);
        }
}

TEST_CASE("a turn in place: the patch rests at |k| r = 1, and a rounded radius shifts it by a few times the rounding") {
    const double r = 9.0;
    const auto law = law_of({r});
    for (double side : {1.0, -1.0})
        for (double off : {0.0, 1e-12, -1e-12, 1e-7, -1e-7, 1e-4, -1e-4, 1e-3})
            for (double turn : {0.3, kPi, 2 * kPi}) {
                const V p(100, 50);
                auto state = taut(p + r * unit(0.3), r, 0.3);
                // move straight to the circle about p, then round it in steps of 0.2 rad
                const int n = int(std::ceil(turn / 0.2));
                advance(law, Move<double>(p + r * unit(0.3), p + (r + off) * unit(0.3), 2.0, 2.0), state);
                for (int k = 0; k < n; ++k)
                    advance(law,
                            arc_between<double>(p + (r + off) * unit(0.3 + side * turn * k / n),
                                                p + (r + off) * unit(0.3 + side * turn * (k + 1) / n), side * turn / n,
                                                2.0),
                            state);
                const double bound = std::max(0.0, off) * (1.0 + 0.5 * turn * turn) + 1e-12;
                CHECK((state.contact - p).norm() < bound);
                if (off > 1e-8) CHECK((state.contact - p).norm() > off);
            }
}

TEST_CASE("two arcs are one, and chords become the arc as they shrink") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> angle(-kPi, kPi), part(0.05, 0.95), radius(1.0, 30.0), turn(-6.0, 6.0);
    const auto law = law_of({5.0});
    int loose = 0;
    for (int k = 0; k < 200; ++k) {
        const double R = k % 4 == 0 ? 5.0 + 1e-3 * part(random) : radius(random), all = turn(random),
                     phi = angle(random), c = part(random);
        auto one = taut({1, 2}, 5.0, angle(random));
        auto two = one, chords = one;
        const auto arc = arc_of({1, 2}, phi, R, all);
        advance(law, arc, one);
        advance(law, arc_of({1, 2}, phi, R, c * all), two);
        advance(law, arc_of(arc.tcp(c), phi + c * all, R, (1 - c) * all), two);
        CHECK((one.contact - two.contact).norm() < 1e-7);
        loose += !one.taut;
        constexpr int n = 20000;
        for (int i = 0; i < n; ++i)
            advance(law, Move<double>(arc.tcp(double(i) / n), arc.tcp(double(i + 1) / n), 2.0, 2.0), chords);
        CHECK((one.contact - chords.contact).norm() < 2e-3);
    }
    CHECK(loose > 10);
}

TEST_CASE("from touch-down the first arc sets the heading, and pulls the lever out to its length") {
    const auto law = law_of({5.0});
    auto state = touch_down<double>({0, 0});
    const auto arc = arc_of({0, 0}, 0.0, 20.0, 2.0);
    const auto found = phases(law, arc, state);
    REQUIRE(found.size() == 2);
    CHECK_FALSE(found[0].second);
    CHECK(found[1].first * 2.0 == doctest::Approx(2.0 * std::asin(2.5 / 20.0)));  // the chord is r
    state = touch_down<double>({0, 0});
    CHECK(phases(law, arc_of({0, 0}, 0.0, 2.4, 20.0), state).size() == 1);  // no chord is that long
    CHECK(state.contact == V(0, 0));
}

TEST_CASE("arcs without lag: a rigid pen, and a lag that vanishes at depth 0") {
    for (const auto& law : {law_of({0.0}), law_of({0.0, 0.8})}) {
        auto state = touch_down<double>({0, 0});
        ArcMove<double> arc = arc_of({0, 0}, 0.5, 3.0, -2.0);
        arc.depth_from = 0.0;
        advance(law, arc, state);
        CHECK((state.contact - arc.tcp(1.0)).norm() < 1e-14);
        CHECK((state.heading - arc.direction(1.0)).norm() < 1e-14);
    }
}

TEST_CASE("dual numbers carry derivatives along arcs, through loosening and tightening") {
    const auto plain = law_of({5.0});
    LagLaw<Dual> law;
    law.pieces.resize(1);
    law.pieces[0].hi = 10.0;
    law.pieces[0].coefficients[0] = 5.0;
    // Taut, loose on a small circle, then pushed on another one and taut again. The derivative is by the first radius.
    const auto path = [](auto scalar, auto radius, const auto& law_) {
        using T = decltype(scalar);
        using W = Vec2<T>;
        LagState<T> s = touch_down<T>(W(T(0.0), T(0.0)));
        advance(law_, Move<T>(W(T(0.0), T(0.0)), W(T(12.0), T(0.0)), T(2.0), T(2.0)), s);
        const ArcMove<T> a(W(T(12.0), T(0.0)), W(T(1.0), T(0.0)), radius, T(4.0), T(2.0));
        advance(law_, a, s);
        const ArcMove<T> b(a.tcp(T(1.0)), a.direction(T(1.0)), T(30.0), T(-1.2), T(2.0));
        advance(law_, b, s);
        return s;
    };
    const double h = 1e-5;
    const V up = path(0.0, 3.0 + h, plain).contact, down = path(0.0, 3.0 - h, plain).contact;
    const auto dual = path(Dual(0.0), Dual(3.0, 1.0), law);
    CHECK(dual.taut);
    CHECK(std::abs(dual.contact.x().v - (up.x() - down.x()) / (2 * h)) < 1e-6);
    CHECK(std::abs(dual.contact.y().v - (up.y() - down.y()) / (2 * h)) < 1e-6);
    CHECK(std::abs(dual.contact.y().v) > 1e-3);
}
