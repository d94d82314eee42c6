#pragma once

#include "brushsvg/brush.hpp"
#include "brushsvg/marks.hpp"

namespace brushsvg {

/// Marks reach beyond the drawing by no more than a brush's lag. A greater coordinate is damaged data.
inline constexpr double kMaxPaintedCoordinateMm = 1e7;

/// Refuses a brush that cannot be used in computations. This check is quick; check(brush) tests whether a brush makes
/// sense. Throws Error when the kind is unknown or the depth range does not rise, when a law is not finite, negative
/// where it is a length, or larger than for any brush, and when an outline is missing, too large or has another number
/// of vertices than the others.
void require_usable(const Brush& brush);

/// Refuses marks whose rows are not parallel, not finite, or beyond 1e7 mm.
void require_usable(const PassMarks& marks);

}  // namespace brushsvg
