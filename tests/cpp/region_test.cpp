#include "brushsvg/region.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "brushsvg/error.hpp"
#include "refusal.hpp"

using namespace brushsvg;

namespace {

Ring box(double x, double y, double w, double h) {
    Ring r(4, 2);
    r << x, y, x + w, y, x + w, y + h, x, y + h;
    return r;
}

}  // namespace

TEST_CASE("union, area and overlap of boxes") {
    CHECK(area(unite({box(0, 0, 4, 4), box(2, 2, 4, 4)})) == doctest::Approx(28.0));
    CHECK(unite({box(0, 0, 1, 1), box(5, 5, 1, 1)}).size() == 2);
    CHECK(overlap({box(0, 0, 2, 2)}, {box(1, 0, 2, 2)}) == doctest::Approx(2.0 / 6.0));
    CHECK(overlap({}, {}) == 1.0);
    CHECK(overlap({box(0, 0, 1, 1)}, {}) == 0.0);
}

TEST_CASE("a frame has an outer ring counter-clockwise and a hole clockwise, both unclosed") {
    const Rings frame = unite({box(0, 0, 10, 1), box(0, 9, 10, 1), box(0, 0, 1, 10), box(9, 0, 1, 10)});
    REQUIRE(frame.size() == 2);
    CHECK(area({frame[0]}) == doctest::Approx(100.0));
    CHECK(area({frame[1]}) == doctest::Approx(-64.0));
    for (const Ring& ring : frame) CHECK((ring.row(0) - ring.row(ring.rows() - 1)).norm() > 0.5);
}

TEST_CASE("a union keeps holes unless another shape covers them") {
    Ring hole = box(3, 3, 4, 4);
    hole = hole.colwise().reverse().eval();
    const Rings frame{box(0, 0, 10, 10), hole};
    CHECK(area(unite({frame[0], frame[1], box(20, 0, 1, 1)})) == doctest::Approx(85.0));
    CHECK(area(unite({frame[0], frame[1], box(2, 2, 6, 6)})) == doctest::Approx(100.0));
    CHECK(overlap(frame, {box(0, 0, 10, 10)}) == doctest::Approx(0.84));
}

TEST_CASE("clockwise rings are refused, except in fill") {
    const Ring square = box(0, 0, 4, 4), turned = square.colwise().reverse();
    CHECK(area({turned}) == doctest::Approx(-16.0));
    CHECK(agrees(refusal([&] { overlap({turned}, {turned}); }), "outline-clockwise", ""));
    CHECK_THROWS_AS(overlap({square}, {turned}), Error);
    CHECK_THROWS_AS(intersect({turned}, {square}), Error);
    CHECK_THROWS_AS(unite({turned}), Error);
    CHECK(area(fill({turned}, FillRule::nonzero)) == doctest::Approx(16.0));
    CHECK(unite({square, turned}).empty());  // the hole is as large as the shape
}

TEST_CASE("the intersection of a box with a large shape with holes is correct at any place") {
    // A folded comb with many corners. Its teeth reach past the box on all sides, and it has a hole larger than the
    // box.
    Rings shape;
    Ring comb(402, 2);
    for (int k = 0; k < 200; ++k) comb.row(k) << 0.5 * k, (k % 2 ? -3.0 : 0.0);
    comb.row(200) << 100.0, 0.0;
    for (int k = 0; k < 200; ++k) comb.row(201 + k) << 100.0 - 0.5 * k, (k % 2 ? 53.0 : 50.0);
    comb.row(401) << 0.0, 50.0;
    shape.push_back(comb);
    shape.push_back(box(40.0, 20.0, 20.0, 10.0).colwise().reverse().eval());
    std::mt19937 random(7);
    std::uniform_real_distribution<double> x(-3.0, 101.0), y(-6.0, 54.0), size(0.3, 12.0);
    for (int k = 0; k < 200; ++k) {
        const Ring small = box(x(random), y(random), size(random), size(random));
        // the common area, computed differently: from the area of the union
        const double both = area({small}) + area(shape) - area(unite({small, shape[0], shape[1]}));
        const bool is_on_hole = area(intersect({small}, {box(40.0, 20.0, 20.0, 10.0)})) > 0.0;
        if (!is_on_hole) CHECK(std::abs(area(intersect(shape, {small})) - both) < 1e-3);
        CHECK(std::abs(area(intersect({small}, shape)) - area(intersect(shape, {small}))) < 1e-3);
        const double on_hole = area(intersect({small}, {box(40.0, 20.0, 20.0, 10.0)}));
        CHECK(std::abs(area(intersect(shape, {small})) + on_hole - area(intersect({comb}, {small}))) < 1e-3);
    }
}

TEST_CASE("many shapes far from the origin are united") {
    Rings boxes;
    for (int i = 0; i < 300; ++i) boxes.push_back(box(5000 + 0.3 * i, 5000 + 0.1 * i, 1, 1));
    // a staircase: one box and 299 steps of 1 - 0.7 * 0.9 each
    CHECK(area(unite(boxes)) == doctest::Approx(1.0 + 299 * (1.0 - 0.7 * 0.9)).epsilon(1e-4));
}

TEST_CASE("the convex hull of a square with points inside is the square") {
    Ring points(6, 2);
    points << 0, 0, 2, 0, 2, 2, 0, 2, 1, 1, 1, 0;
    const Ring hull = convex_hull(points);
    CHECK(hull.rows() == 4);
    CHECK(area({hull}) == doctest::Approx(4.0));
}

namespace {

/// Return a convex shape with 40 corners, longer than wide, with one corner sharper than the others.
Ring leaf(double x, double y, double heading, double size) {
    Ring r(40, 2);
    for (int k = 0; k < 40; ++k) {
        const double a = 2 * 3.14159265358979 * k / 40;
        const double u = size * (1.8 * std::cos(a) + (k == 0 ? 0.4 : 0.0)), v = size * std::sin(a);
        r.row(k) << x + u * std::cos(heading) - v * std::sin(heading),
            y + u * std::sin(heading) + v * std::cos(heading);
    }
    return r;
}

struct Swept {
    Rings whole, pieces;
    std::size_t corners = 0;
};

Swept swept(const Rings& chain) {
    Swept found;
    Rings hulls;
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        Ring points(chain[i].rows() + chain[i + 1].rows(), 2);
        points << chain[i], chain[i + 1];
        hulls.push_back(convex_hull(points));
    }
    found.whole = unite(hulls);
    const Rings pieces = pieces_between(chain);
    for (const Ring& piece : pieces) found.corners += std::size_t(piece.rows());
    found.pieces = unite(pieces);
    return found;
}

}  // namespace

TEST_CASE("pieces between shapes cover the hulls, with few corners where the shape moves on") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (int trial = 0; trial < 60; ++trial) {
        CAPTURE(trial);
        const double step = trial % 3 == 0 ? 1.5 : 0.05, turn = trial % 4 == 0 ? 1.0 : 0.05;
        const double growth = trial % 5 == 0 ? 0.5 : 0.02;
        double x = 50, y = 50, heading = 0, size = 1;
        Rings chain;
        for (int i = 0; i < 2 + trial; ++i) {
            if (trial % 7 != 0 || i % 3 == 0) {  // only every third ring moves on
                x += step * std::cos(heading), y += step * std::sin(heading);
                heading += turn * any(random);
                size = std::max(0.0, size + growth * any(random));
            }
            chain.push_back(leaf(x, y, heading, size));
        }
        const Swept found = swept(chain);
        CHECK(area(found.pieces) == doctest::Approx(area(found.whole)).epsilon(1e-6));
        CHECK(overlap(found.pieces, found.whole) > 1.0 - 1e-5);
        CHECK(found.pieces.size() == found.whole.size());
    }
    Rings straight;
    for (int i = 0; i < 100; ++i) straight.push_back(leaf(0.05 * i, 0.02 * i, 0.4, 1.0));
    CHECK(swept(straight).corners < 100 * 9);
    CHECK(pieces_between({}).empty());
    CHECK(pieces_between({box(0, 0, 1, 1)}).size() == 1);
    // a ring inside another one, and a ring that is only a point
    CHECK(area(unite(pieces_between({box(0, 0, 4, 4), box(1, 1, 1, 1), box(0, 0, 4, 4)}))) == doctest::Approx(16.0));
    CHECK(area(unite(pieces_between({leaf(0, 0, 0, 0), leaf(0, 0, 0, 0)}))) == doctest::Approx(0.0));
}

TEST_CASE("outlines are filled by the rule for any direction and any crossings") {
    const Ring outer = box(0, 0, 10, 10), inner = box(3, 3, 4, 4);
    const Ring turned = inner.colwise().reverse();
    CHECK(area(fill({outer, inner}, FillRule::nonzero)) == doctest::Approx(100.0));
    CHECK(area(fill({outer, turned}, FillRule::nonzero)) == doctest::Approx(84.0));
    CHECK(area(fill({turned, outer}, FillRule::nonzero)) == doctest::Approx(84.0));
    for (const Ring& hole : {inner, turned})
        CHECK(area(fill({outer, hole}, FillRule::evenodd)) == doctest::Approx(84.0));
    CHECK(area(fill({outer.colwise().reverse()}, FillRule::nonzero)) == doctest::Approx(100.0));
    CHECK(area(fill({outer, outer, outer}, FillRule::nonzero)) == doctest::Approx(100.0));
    CHECK(area(fill({outer, outer}, FillRule::evenodd)) == 0.0);
    CHECK(area(fill({outer, outer, outer}, FillRule::evenodd)) == doctest::Approx(100.0));
    CHECK(fill({}, FillRule::nonzero).empty());
}

TEST_CASE("any odd number of contours is filled") {
    Rings same, nested;
    double rings_area = 0.0;
    for (int n = 1; n <= 41; ++n) {
        same.push_back(box(0, 0, 10, 10));
        nested.push_back(box(n, n, 100 - 2 * n, 100 - 2 * n));
        rings_area += (n % 2 == 1 ? 1 : -1) * (100.0 - 2 * n) * (100.0 - 2 * n);
        CHECK(area(fill(same, FillRule::evenodd)) == doctest::Approx(n % 2 == 1 ? 100.0 : 0.0));
        CHECK(area(fill(nested, FillRule::evenodd)) == doctest::Approx(rings_area));
    }
    Ring star(71, 2);  // its outline runs 35 times round the middle
    for (int i = 0; i < 71; ++i) {
        const double a = 35.0 * 2.0 * 3.14159265358979323846 * i / 71;
        star.row(i) << 50.0 * std::cos(a), 50.0 * std::sin(a);
    }
    CHECK_THROWS_AS(fill({star}, FillRule::evenodd), Error);
}

TEST_CASE("outlines that cross themselves fill both lobes of an eight, and the middle of a star by its rule") {
    Ring eight(4, 2);
    eight << 0, 0, 10, 10, 10, 0, 0, 10;
    CHECK(area(fill({eight}, FillRule::nonzero)) == doctest::Approx(50.0));
    CHECK(area(fill({eight}, FillRule::evenodd)) == doctest::Approx(50.0));
    Ring star(5, 2);
    for (int i = 0; i < 5; ++i) {
        const double a = 4.0 * 3.14159265358979323846 * i / 5;
        star.row(i) << 10.0 * std::cos(a), 10.0 * std::sin(a);
    }
    const double whole = area(fill({star}, FillRule::nonzero)), rays = area(fill({star}, FillRule::evenodd));
    CHECK(whole == doctest::Approx(112.2570).epsilon(1e-4));        // 10 r^2 sin(36) sin(18) / sin(126)
    CHECK(whole - rays == doctest::Approx(34.6894).epsilon(1e-4));  // the pentagon inside
}

TEST_CASE("distances and crossings of coordinates that are not finite are refused") {
    const Ring sound = Ring::Random(4, 2);
    Ring damaged = sound;
    damaged(1, 1) = std::nan("");
    for (const auto& [ring, points] : {std::pair(damaged, sound), std::pair(sound, damaged)}) {
        CHECK(agrees(refusal([&] { clearance({ring}, points); }), "not-finite", ""));
        CHECK(agrees(refusal([&] { first_crossings({ring}, points, points); }), "not-finite", ""));
    }
    CHECK(agrees(refusal([&] { first_crossings({sound}, sound, damaged); }), "not-finite", ""));
}

TEST_CASE("three pieces of which Boost makes nothing are united") {
    // Found by the fuzzer: the diagonal of the first two runs along the corners of the third. All of the area was lost.
    Ring first(7, 2), second(4, 2), third(5, 2);
    first << 40, 40, -29.47624, -16.1259, -40, 40, -40, -40, -39.98293, -39.98293, -24.99977, -40, -27.36826, -27.36826;
    second << 40, 40, 39.68627, 39.68627, 39.68627, 39.66674, 40, 39.68627;
    third << 39.68627, 39.68627, -22.00656, -17.56435, -11.96124, -29.87411, 3.24407, -29.10628, 27.075, -22.28489;
    const double whole = 2788.7149;  // by GEOS
    CHECK(std::abs(area(unite({first, second, third})) - whole) < 1e-3);
    CHECK(std::abs(area(fill({first, second, third}, FillRule::nonzero)) - whole) < 1e-3);
}
