#pragma once

#include "brushsvg/brush.hpp"
#include "brushsvg/marks.hpp"

namespace brushsvg {

/// Marks reach beyond what was drawn by a brush's lag, no more: a coordinate beyond it is damage.
inline constexpr double kFarthestPaintedMm = 1e7;

/// Refuses what cannot be computed with, quickly: check(brush) says whether a brush makes sense. Throws Error when the
/// kind is unknown, the depth range does not rise, a law is not finite, negative where it is a length or larger than
/// any brush, or an outline is missing, too large or not as long as the others.
void require_usable(const Brush& brush);

/// Rows that are not parallel, not finite, or beyond 1e7 mm.
void require_usable(const PassMarks& marks);

}  // namespace brushsvg
