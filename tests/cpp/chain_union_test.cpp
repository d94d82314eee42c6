#include "regions/chain_union.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "apart.hpp"
#include "boxes.hpp"

using namespace brushsvg;

TEST_CASE("touching neighbours become one ring, with any shared edges and corners") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::size_t before = 0, after = 0;
    int with_holes = 0;
    for (int trial = 0; trial < 600; ++trial) {
        CAPTURE(trial);
        Rings rings;
        double x = 30.0, y = 20.0, heading = 3.0 * any(random);
        for (int i = 0; i < 2 + trial % 23; ++i) {
            heading += 0.8 * any(random);
            x += std::cos(heading);
            y += std::sin(heading);
            Ring points(4 + trial % 17, 2);
            for (Eigen::Index k = 0; k < points.rows(); ++k)
                points.row(k) << x + 1.5 * any(random), y + 1.5 * any(random);
            if (trial % 3 == 0) points = ((2.0 * points).array().round() / 2.0).matrix().eval();  // rounded to a grid
            const Ring hull = convex_hull(points);
            if (hull.rows() < 3) continue;
            rings.push_back(hull);
            const std::size_t n = rings.size();
            if (trial % 4 == 0 && n > 1)
                rings[n - 2] = convex_hull(both(hull, rings[n - 2]));  // neighbouring rings share edges
        }
        if (rings.empty()) continue;
        const Rings target = fill(rings, FillRule::nonzero), fewer = unite_chain(rings, 1e5).value();
        before += rings.size();
        after += fewer.size();
        const Rings found = fill(fewer, FillRule::nonzero);
        CHECK(apart(rings, fewer) < 1e-5);
        CHECK(found.size() == target.size());
        with_holes += target.size() > 1 && area({target[1]}) < 0.0;
        for (const Ring& ring : fewer) {
            // the ring may touch itself, but does not cross itself
            CHECK(area(fill({ring}, FillRule::evenodd)) == doctest::Approx(area({ring})).epsilon(1e-6));
            CHECK(ring.col(0).maxCoeff() == ring(0, 0));
        }
    }
    CHECK(after < 0.2 * double(before));
    CHECK(with_holes > 20);
}

TEST_CASE("rings that enclose a hole, are apart or reach too far are not joined") {
    const auto count = [](const Rings& rings) { return unite_chain(rings, 1e5).value().size(); };
    const auto area_of = [](const Rings& rings) { return area(unite_chain(rings, 1e5).value()); };
    const Ring all = box(0, 0, 4, 4);
    CHECK(area_of({all}) == doctest::Approx(16.0));
    CHECK(area_of({all, all, box(1, 1, 3, 3)}) == doctest::Approx(16.0));
    CHECK(area_of({box(1, 1, 3, 3), all}) == doctest::Approx(16.0));
    CHECK(area_of({all, box(3, 1, 7, 2), box(5, 1, 6, 10)}) == doctest::Approx(27.0));
    CHECK(count({all, box(3, 1, 7, 2), box(5, 1, 6, 10)}) == 1);
    CHECK(count({}) == 0);
    CHECK(count({box(0, 0, 1e-6, 1e-6)}) == 0);
    CHECK(count({all, box(5, 0, 9, 4)}) == 2);
    CHECK(count({box(0, 0, 9, 1), box(8, 0, 9, 9), box(0, 8, 9, 9), box(0, 0, 1, 9)}) == 2);
    CHECK_FALSE(unite_chain({box(0, 0, 1e4, 1), all}, 1e5));
    CHECK_FALSE(unite_chain({box(0, 0, std::nan(""), 1), all}, 1e5));
}
