// The search for the strokes of any shape: strokes that the brush can paint, each for an area of the shape, the same
// each time.
#include "brushsvg/stroke_search.hpp"

#include "brushsvg/compensate.hpp"
#include "brushsvg/region.hpp"
#include "fuzzed_input.hpp"

using namespace brushsvg;

namespace {

void require_paintable(const Stroke& stroke, const std::array<double, 2>& half_mm) {
    fuzz::require(stroke.middle_mm.rows() > 0 && stroke.middle_mm.allFinite(), "a stroke is finite");
    fuzz::require(!stroke.half_width.empty(), "a stroke has a width");
    for (const WidthKnot& knot : stroke.half_width)
        fuzz::require(knot.half_width_mm <= half_mm[1] + 1e-9, "no stroke is wider than the brush", knot.half_width_mm);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in(data, size);
    return fuzz::refusing([&] {
        const Detail detail = kDetailNames[std::size_t(in.integer(0, 2))].second;
        const bool are_free = !in.chance(4), twice = in.chance(8);
        const Brush brush = fuzz::brush_from(in);
        in.choose_grid();
        Rings drawn;
        for (int i = 0, rings = in.integer(1, 2); i < rings; ++i) {
            Ring ring(in.integer(3, 8), 2);
            for (Eigen::Index k = 0; k < ring.rows(); ++k)
                ring.row(k) << 50.0 + in.coordinate(), 50.0 + in.coordinate();
            drawn.push_back(ring);
        }
        PaintedShape shape;
        shape.target_mm = fill(drawn, FillRule::nonzero);
        if (shape.target_mm.empty()) return;
        CompensateOptions options;
        options.start = Terminal::automatic;
        options.end = Terminal::automatic;
        for (int i = 0, strokes = in.integer(0, 2); i < strokes; ++i) {
            Stroke stroke = fuzz::stroke_from(in, brush, 2);
            if (in.chance(2)) stroke.target_mm = shape.target_mm;
            shape.passes.push_back(compensate(stroke, brush, options).pass);
            shape.strokes.push_back(std::move(stroke));
        }
        const auto found = search_strokes({shape}, brush, weights_for(detail), are_free);
        fuzz::require(found.size() == 1, "one result for one shape");
        const SearchedShape& one = found.front();
        fuzz::require(one.strokes.size() == shape.strokes.size() && one.changed.size() == shape.strokes.size(),
                      "each stroke has a result");
        const std::array<double, 2> half_mm = brush.half_width_range_mm();
        for (std::size_t k = 0; k < one.strokes.size(); ++k) {
            fuzz::require(are_free || !one.changed[k], "strokes that are not free stay");
            fuzz::require(one.changed[k] || one.strokes[k].size() == 1, "an unchanged stroke is one stroke");
            if (one.changed[k])
                for (const Stroke& part : one.strokes[k]) require_paintable(part, half_mm);
        }
        for (std::size_t k = 0; k < one.added.size(); ++k) {
            const AddedStroke& added = one.added[k];
            require_paintable(added.stroke, half_mm);
            fuzz::require(shape.strokes.empty() || added.neighbour < shape.strokes.size() + k, "a neighbour exists");
            fuzz::require(!added.area_mm.empty() && area(added.area_mm) > 0.0, "an added stroke is for an area");
            fuzz::require(!added.mark_mm.empty(), "an added stroke paints");
            for (std::size_t other = 0; other < k; ++other) {
                const auto& before = one.added[other].stroke.middle_mm;
                fuzz::require(before.rows() != added.stroke.middle_mm.rows() || before != added.stroke.middle_mm,
                              "a stroke is added only once");
            }
        }
        const double all_mm2 = area(shape.target_mm);
        const auto uncovered = uncovered_areas({shape}, brush, 0.01);
        for (const UncoveredArea& bare : uncovered.front())
            fuzz::require(bare.mm2 >= 0.01 * all_mm2 && bare.place_mm.allFinite(),
                          "a bare area is as large as requested", bare.mm2);
        if (!twice) return;
        const auto again = search_strokes({shape}, brush, weights_for(detail), are_free);
        fuzz::require(again.front().added.size() == one.added.size(), "the same shape has the same strokes");
        for (std::size_t k = 0; k < one.added.size(); ++k)
            fuzz::require(again.front().added[k].stroke.middle_mm == one.added[k].stroke.middle_mm,
                          "the same shape has the same strokes");
    });
}
