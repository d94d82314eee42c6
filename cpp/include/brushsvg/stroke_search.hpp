#pragma once

#include <cstddef>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/objective.hpp"
#include "brushsvg/plan.hpp"
#include "brushsvg/stroke.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// A shape, with the strokes and passes that paint it so far.
struct PaintedShape {
    Rings target_mm;
    std::vector<Stroke> strokes;
    std::vector<Pass> passes;
};

/// A stroke added for an area that the other strokes leave without paint.
struct AddedStroke {
    Stroke stroke;
    std::size_t neighbour;  ///< index of the stroke that runs nearest to the area, also among those added before
    Rings area_mm;          ///< the area, as deep as it is seen
    Rings mark_mm;          ///< outline of the paint of the stroke
};

/// The result of search_strokes() for a shape.
struct SearchedShape {
    /// The strokes that replace each given stroke: itself, another path, parts, or none.
    std::vector<std::vector<Stroke>> strokes;
    std::vector<bool> changed;  ///< whether the replacement differs from the given stroke
    std::vector<AddedStroke> added;
};

/// Search for the strokes whose mark has the least cost for each shape (ObjectiveWeights).
///
/// The search begins with the given strokes. A stroke that paints outside its shape gets another path: as narrow as the
/// shape, narrower everywhere, shortened at an end, or in parts that meet at its corners. A stroke whose ends are
/// covered by the paint of other strokes may also be reversed or left out.
///
/// Then strokes are added for areas without paint, the largest area first. They continue a stroke next to the area, or
/// run along the edge of the shape, from a corner inwards, or across the area.
///
/// `are_free`: true if strokes may get another path, false if strokes are only added. The result does not depend on the
/// number of threads. Throws Error as check(weights) does.
std::vector<SearchedShape> search_strokes(const std::vector<PaintedShape>& shapes, const Brush& brush,
                                          const ObjectiveWeights& weights = {}, bool are_free = true);

/// An area of a shape that is left without paint, as deep as it is seen.
struct UncoveredArea {
    Rings outline_mm;
    Eigen::Vector2d place_mm;  ///< a place in the area, far from its edge (x, y), paper frame
    double mm2;
};

/// Find the areas of each shape that its passes leave without paint.
///
/// `min_share`: the least area, as a share of the shape's area, from 0 to 1. The largest areas are first.
std::vector<std::vector<UncoveredArea>> uncovered_areas(const std::vector<PaintedShape>& shapes, const Brush& brush,
                                                        double min_share);

}  // namespace brushsvg
