#pragma once

#include <vector>

#include "brushsvg/coverage.hpp"
#include "brushsvg/stroke.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// What strokes should become and what was painted, laid over each other: shares of the same pixels, row 0 at the top.
struct MarkOverlap {
    Window window;
    double px_per_mm;
    Coverage wanted, painted;
};

/// Areas [mm^2] of paint and target mark.
struct CommonArea {
    double common_mm2;
    double together_mm2;
    /// Area of the intersection over area of the union; 1 when both are empty.
    double overlap() const { return together_mm2 > 0.0 ? common_mm2 / together_mm2 : 1.0; }
};

/// Marks over the strokes they should be, with some paper round them: outlines where strokes have them, else their
/// paths with their widths. 8 to 40 pixels a mm, 6 across the finest half width where 40 allow it, and 4 million in
/// all at most, so that coarse ones are quick and hairlines still have an area.
MarkOverlap mark_overlap(const std::vector<PassMarks>& painted, const std::vector<Stroke>& wanted, const Brush& brush);

CommonArea common_area(const MarkOverlap& seen);

/// The same of a whole sheet: where 4 million pixels are too few for 8 a mm, 5 a mm, tile by tile on all processors, 60
/// million in all at most.
CommonArea common_area(const std::vector<PassMarks>& painted, const std::vector<Stroke>& wanted, const Brush& brush);

/// The same of each of some groups, as touching() finds them: numbers of strokes and of the passes that paint them.
std::vector<CommonArea> common_areas(const std::vector<PassMarks>& painted, const std::vector<Stroke>& wanted,
                                     const std::vector<std::vector<std::size_t>>& groups, const Brush& brush);

/// What strokes should become, as shares of pixels.
Coverage wanted_coverage(const std::vector<Stroke>& wanted, const Window& window, double px_per_mm);

/// Numbers of strokes whose target marks touch, directly or through others: the parts of letters, in order. Those that
/// stand alone are not named.
std::vector<std::vector<std::size_t>> touching(const std::vector<Stroke>& wanted);

}  // namespace brushsvg
