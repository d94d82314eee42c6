#pragma once

#include <cstddef>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/objective.hpp"
#include "brushsvg/plan.hpp"
#include "brushsvg/stroke.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// A shape, and the strokes and passes that paint it so far.
struct PaintedShape {
    Rings target_mm;
    std::vector<Stroke> strokes;
    std::vector<Pass> passes;
};

/// A stroke into an area that the others leave without paint.
struct AddedStroke {
    Stroke stroke;
    std::size_t neighbour;  ///< which of the shape's strokes, those added before it too, runs nearest to that area
    Rings area_mm;          ///< the area, as deep as it is seen
    Rings mark_mm;          ///< what the stroke paints
};

/// How a shape is painted better.
struct SearchedShape {
    /// What each given stroke is best painted as: itself, another path, in parts between its corners, or not at all.
    std::vector<std::vector<Stroke>> strokes;
    std::vector<bool> changed;  ///< which of them differ from what was given
    std::vector<AddedStroke> added;
};

/// Looks for the strokes by which the mark of each shape costs least, from the given ones on. A stroke that sticks out
/// of its shape gets another path: narrower, cut short at an end, or in parts that meet at its corners; one that fills
/// with others, whose ends those cover, also the other way round, or not at all. Then strokes are added, into the
/// largest bare area first: from a stroke next to it straight out, along the edge of the shape, from a corner inwards,
/// or across. The same for any number of threads. are_free: whether strokes may get another path, and not only added.
std::vector<SearchedShape> search_strokes(const std::vector<PaintedShape>& shapes, const Brush& brush,
                                          const ObjectiveWeights& weights = {}, bool are_free = true);

/// An area of a shape that is left without paint, as deep as it is seen.
struct UncoveredArea {
    Rings outline_mm;
    Eigen::Vector2d place_mm;  ///< in it, far from its edge
    double mm2;
};

/// The areas of each shape that its passes leave without paint, from a share of the shape on, the largest first.
std::vector<std::vector<UncoveredArea>> uncovered_areas(const std::vector<PaintedShape>& shapes, const Brush& brush,
                                                        double least_share);

}  // namespace brushsvg
