#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/region.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// The painted fraction of each pixel. Row 0 is the top of the window.
using Coverage = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Return an anti-aliased picture of the union of all footprints.
///
/// `window`: the part of the paper [mm]. `px_per_mm`: pixels per mm.
Coverage coverage(const Marks& marks, const Brush& brush, const Window& window, double px_per_mm);

/// Return a picture of filled rings (non-zero winding).
Coverage coverage(const Rings& rings, const Window& window, double px_per_mm);

/// Return a picture of the union of convex counter-clockwise rings, which may overlap.
Coverage coverage_of_pieces(const Rings& convex, const Window& window, double px_per_mm);

/// Return the outline of all that one pass paints, as rings.
///
/// The outline of a whole drawing is the union of the outlines of its passes.
Rings outline(const PassMarks& marks, const Brush& brush);

/// Return the left, bottom, right and top [mm] of all that one pass paints.
///
/// Infinities if the pass paints nothing.
std::array<double, 4> painted_bounds(const PassMarks& marks, const Brush& brush);

}  // namespace brushsvg
