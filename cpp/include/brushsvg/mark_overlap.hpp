#pragma once

#include <vector>

#include "brushsvg/coverage.hpp"
#include "brushsvg/stroke.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// The target marks and the paint of strokes, as shares of the same pixels.
///
/// Row 0 is at the top.
struct MarkOverlap {
    Window window;
    double px_per_mm;
    Coverage target, painted;
};

/// Areas of paint and target mark: of their intersection and of their union [mm^2].
struct CommonArea {
    double intersection_mm2;
    double union_mm2;
    /// Return intersection_mm2 / union_mm2, or 1 if both areas are empty.
    double overlap() const { return union_mm2 > 0.0 ? intersection_mm2 / union_mm2 : 1.0; }
};

/// Draw painted marks and target strokes on the same pixels, with a margin of paper.
///
/// `painted`: the marks of each stroke's pass. `target`: the strokes, drawn as outlines if they have them, otherwise as
/// paths with their widths.
///
/// The scale is 8 to 40 pixels per mm, with 6 pixels across the finest half width if 40 pixels per mm are enough. The
/// picture has at most 4 million pixels. So coarse marks are quick to compare, and hairlines still have an area.
MarkOverlap mark_overlap(const std::vector<PassMarks>& painted, const std::vector<Stroke>& target, const Brush& brush);

/// Return the areas of intersection and union in a picture of both.
CommonArea common_area(const MarkOverlap& seen);

/// Return the areas of intersection and union for a whole sheet.
///
/// If 4 million pixels are too few for 8 per mm, the sheet is computed at 5 per mm, tile by tile on all processors. All
/// tiles together have at most 60 million pixels.
CommonArea common_area(const std::vector<PassMarks>& painted, const std::vector<Stroke>& target, const Brush& brush);

/// Return the areas of intersection and union for each group of strokes.
///
/// `groups`: indices of strokes and of the passes that paint them, as group_touching() returns them.
std::vector<CommonArea> common_areas(const std::vector<PassMarks>& painted, const std::vector<Stroke>& target,
                                     const std::vector<std::vector<std::size_t>>& groups, const Brush& brush);

/// Return the target marks of strokes as shares of pixels.
Coverage target_coverage(const std::vector<Stroke>& target, const Window& window, double px_per_mm);

/// Return groups of strokes whose target marks touch: the parts of letters.
///
/// Strokes touch directly or through others. Each group contains indices in ascending order. Strokes that touch no
/// other stroke are not listed.
std::vector<std::vector<std::size_t>> group_touching(const std::vector<Stroke>& target);

}  // namespace brushsvg
