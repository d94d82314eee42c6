#include "brushsvg/target_mark.hpp"

#include <doctest/doctest.h>

#include "round6.hpp"

using namespace brushsvg;
using V = Eigen::Vector2d;

namespace {

constexpr double kPi = 3.14159265358979323846;

}  // namespace

TEST_CASE("the target mark of a straight stroke is a stadium, of a dot a disc, of a closed ring a ring") {
    Stroke s;
    s.id = "s";
    s.middle_mm = polyline({V(0, 0), V(30, 0)});
    s.half_width = {{0.0, 2.0}};
    CHECK(area(target_outline(s)) == doctest::Approx(30 * 4 + kPi * 4).epsilon(2e-4));
    s.middle_mm = polyline({V(3, 3), V(3, 3)});
    CHECK(area(target_outline(s)) == doctest::Approx(kPi * 4).epsilon(2e-4));
    s.middle_mm = polyline({V(0, 0), V(30, 0), V(30, 30), V(0, 30), V(0, 0)});
    const Rings ring = target_outline(s);
    REQUIRE(ring.size() == 2);
    CHECK(area({ring[0]}) > 0.0);
    CHECK(area({ring[1]}) == doctest::Approx(-26.0 * 26.0).epsilon(1e-4));
}

TEST_CASE("a drawn outline is its own target") {
    Stroke s;
    Ring triangle(3, 2);
    triangle << 0, 0, 4, 0, 0, 3;
    s.target_mm = {triangle};
    CHECK(target_outline(s)[0] == triangle);
}

TEST_CASE("pieces of the target mark cover it, as convex rings") {
    Stroke s;
    s.id = "s";
    s.middle_mm = polyline({V(0, 0), V(30, 0), V(30, 20)});
    s.half_width = {{0.0, 2.0}, {1.0, 1.0}};
    const Rings pieces = target_pieces(s);
    for (const Ring& piece : pieces) {
        CHECK(area({piece}) > 0.0);
        CHECK(area({convex_hull(piece)}) == doctest::Approx(area({piece})));
    }
    CHECK(overlap(unite(pieces), target_outline(s)) == doctest::Approx(1.0));
}

TEST_CASE("pieces near a window include all that meet it, and few more") {
    Stroke curved = stroke_of(polyline({V(20, 20), V(55, 50)}), {{0.0, 0.4}, {0.5, 2.0}, {1.0, 3.0}});
    curved.middle_mm.resize(1, 8);
    curved.middle_mm << 20, 20, 60, 0, 0, 60, 55, 50;
    const Rings all = target_pieces(curved, 0.01);
    for (double x = 0.0; x < 60.0; x += 6.0) {
        const Window window{x, 25.0, 6.0, 6.0};
        const Rings near = target_pieces_near(curved, window, 0.01);
        CHECK(near.size() < all.size());
        std::size_t next = 0;
        for (const Ring& piece : all) {
            const bool meets = piece.col(0).minCoeff() <= x + 6.0 && piece.col(0).maxCoeff() >= x &&
                               piece.col(1).minCoeff() <= 31.0 && piece.col(1).maxCoeff() >= 25.0;
            const bool is_next = next < near.size() && near[next].rows() == piece.rows() && near[next] == piece;
            CHECK((is_next || !meets));
            next += is_next;
        }
        CHECK(next == near.size());
    }
}
