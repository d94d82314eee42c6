#include "regions/star_union.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "apart.hpp"

using namespace brushsvg;

TEST_CASE("rings visible from one point become one ring, with any shared edges and corners") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::size_t before = 0, after = 0;
    for (int trial = 0; trial < 500; ++trial) {
        CAPTURE(trial);
        Rings rings;
        for (int i = 0; i < 2 + trial % 9; ++i) {
            const double x = 30.0 + 0.3 * any(random), y = 20.0 + 0.3 * any(random), angle = 3.0 * any(random);
            const double length = 1.0 + 0.9 * any(random), width = 0.3 + 0.25 * any(random);
            Ring points(3 + trial % 17, 2);
            for (Eigen::Index k = 0; k < points.rows(); ++k) {
                const double u = length * any(random), v = width * any(random);
                points.row(k) << x + u * std::cos(angle) - v * std::sin(angle),
                    y + u * std::sin(angle) + v * std::cos(angle);
            }
            if (trial % 3 == 0) points = ((4.0 * points).array().round() / 4.0).matrix().eval();  // rounded to a grid
            const Ring hull = convex_hull(points);
            if (hull.rows() < 3) continue;
            rings.push_back(hull);
            const std::size_t n = rings.size();
            if (trial % 4 == 0 && n > 1)
                rings[n - 2] = convex_hull(both(hull, rings[n - 2]));  // neighbouring rings share edges
        }
        if (rings.empty()) continue;
        const Rings fewer = unite_stars(rings).rings;
        before += rings.size();
        after += fewer.size();
        CHECK(apart(rings, fewer) < 1e-5);
        CHECK(fill(rings, FillRule::nonzero).size() == fill(fewer, FillRule::nonzero).size());
    }
    CHECK(after < 0.65 * double(before));
}

TEST_CASE("rings without a common visible point, and holes with their rings, stay unchanged") {
    Ring box(4, 2), far(4, 2);
    box << 0, 0, 4, 0, 4, 4, 0, 4;
    far = box.array() + 10.0;
    Ring hole = (0.25 * box).array() + 1.0;
    hole = hole.colwise().reverse().eval();
    CHECK(unite_stars({}).rings.empty());
    CHECK(unite_stars({box, box, box}).rings.size() == 1);
    CHECK(area(unite_stars({box, box, box}).rings) == doctest::Approx(16.0));
    CHECK(unite_stars({box, far}).rings.size() == 2);
    const Rings with_hole = unite_stars({box, box, hole, box}).rings;
    CHECK(with_hole.size() == 4);
    CHECK(area({with_hole[2]}) == doctest::Approx(-1.0));
    Ring twice(8, 2);  // runs round the box twice: not a star, although every corner turns to the left
    twice << box, box;
    CHECK(unite_stars({twice, box}).rings.size() == 2);
    const double nan = std::nan("");
    Ring broken = box;
    broken(2, 1) = nan;
    CHECK(unite_stars({broken, box}).rings.size() == 2);
}
