// Unions, intersections and fills keep to the arithmetic of areas.
#include "brushsvg/region.hpp"
#include "fuzzed_input.hpp"

using namespace brushsvg;

namespace {

Rings rings_from(fuzz::Input& in) {
    Rings rings;
    const int count = in.integer(0, 4);
    for (int i = 0; i < count; ++i) {
        Ring ring(in.integer(0, 10), 2);
        for (Eigen::Index k = 0; k < ring.rows(); ++k) ring.row(k) << in.coordinate(), in.coordinate();
        if (ring.rows() > 0 && in.chance(64)) ring(0, 0) = in.wild(1e5);
        rings.push_back(ring);
    }
    return rings;
}

double length_of(const Rings& rings) {
    double length = 0.0;
    for (const Ring& ring : rings)
        if (ring.rows() > 2) length += length_around(ring);  // others have no area and are not read
    return length;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in(data, size);
    return fuzz::refusing([&] {
        in.choose_grid();
        const FillRule rule = in.chance(2) ? FillRule::evenodd : FillRule::nonzero;
        const Rings drawn_a = rings_from(in), drawn_b = rings_from(in);
        const Rings a = fill(drawn_a, rule), b = fill(drawn_b, rule);
        // coordinates are kept to 1e-5 mm: an outline that moves by so much changes its area by its length
        const double rounding = 1e-4 * (1.0 + length_of(drawn_a) + length_of(drawn_b));
        const auto near = [&](double x, double y) { return std::abs(x - y) <= rounding; };
        fuzz::require(area(a) >= -rounding && area(b) >= -rounding, "a filled shape has an area");
        fuzz::require(near(area(fill(a, rule)), area(a)), "what was filled stays as it is",
                      area(fill(a, rule)) - area(a));
        const Rings both = intersect(a, b);
        Rings all = a;
        all.insert(all.end(), b.begin(), b.end());
        const Rings together = unite(all);
        fuzz::require(near(area(both) + area(together), area(a) + area(b)),
                      "the areas of union and intersection add up to those of both shapes",
                      area(both) + area(together) - area(a) - area(b));
        fuzz::require(near(area(both), area(intersect(b, a))), "an intersection is the same from either side");
        const double share = overlap(a, b);
        fuzz::require(share >= 0.0 && share <= 1.0 + 1e-9, "an overlap is a share", share);
        for (const Ring& ring : drawn_a) {
            if (ring.rows() == 0) continue;
            const Ring hull = convex_hull(ring);
            if (hull.rows() < 3) continue;
            fuzz::require(is_convex(hull), "a hull is convex");
            fuzz::require(signed_area(hull) >= std::abs(area(fill({ring}, FillRule::nonzero))) - rounding,
                          "a hull is no smaller than what it surrounds");
        }
    });
}
