// The mark of a chain of footprints: its pieces cover each of them and are within their hulls.
#include "brushsvg/excess_turning.hpp"
#include "brushsvg/region.hpp"
#include "fuzzed_input.hpp"

using namespace brushsvg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in(data, size);
    return fuzz::refusing([&] {
        in.choose_grid();
        Rings chain, hulls;
        const int links = in.integer(1, 8);
        for (int i = 0; i < links; ++i) {
            Ring points(in.integer(3, 8), 2);
            for (Eigen::Index k = 0; k < points.rows(); ++k) points.row(k) << in.coordinate(), in.coordinate();
            const Ring hull = convex_hull(points);
            if (hull.rows() >= 3 && signed_area(hull) > 1e-3) chain.push_back(hull);
        }
        if (chain.empty()) return;
        for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
            Ring both(chain[i].rows() + chain[i + 1].rows(), 2);
            both << chain[i], chain[i + 1];
            hulls.push_back(convex_hull(both));
        }
        if (hulls.empty()) hulls = chain;
        const Rings pieces = pieces_between(chain);
        double length = 0.0;
        for (const Ring& piece : pieces) {
            fuzz::require(piece.allFinite() && is_convex(piece), "a piece is convex");
            length += length_around(piece);
        }
        for (const Ring& hull : hulls) length += length_around(hull);
        const double rounding = 1e-4 * (1.0 + length), whole = area(unite(hulls)), in_pieces = area(unite(pieces));
        fuzz::require(std::abs(in_pieces - whole) <= rounding, "the pieces cover what the hulls cover",
                      in_pieces - whole);
        const Rings mark = unite(pieces);
        fuzz::require(std::isfinite(excess_turning(mark, unite(chain))), "turning is finite");
        fuzz::require(thorns(mark, mark) == 0, "a mark has no thorns that it has not itself");
    });
}
