#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/region.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Fraction of each pixel that is painted; row 0 is the top of the window.
using Coverage = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Anti-aliased picture of the union of all footprints.
Coverage coverage(const Marks& marks, const Brush& brush, const Window& window, double px_per_mm);

/// The same for filled rings (non-zero winding).
Coverage coverage(const Rings& rings, const Window& window, double px_per_mm);

/// The same for the union of convex counter-clockwise rings, which may overlap.
Coverage coverage_of_pieces(const Rings& convex, const Window& window, double px_per_mm);

/// Rings of everything one pass paints; the whole drawing's are their union.
Rings outline(const PassMarks& marks, const Brush& brush);

/// Left, bottom, right, top [mm] of everything one pass paints; nothing painted: infinities.
std::array<double, 4> painted_bounds(const PassMarks& marks, const Brush& brush);

}  // namespace brushsvg
