#pragma once

#include "brushsvg/coverage.hpp"

namespace brushsvg {

/// Share of a painted pixel above which it is inside these rings.
inline constexpr float kHalfCoverage = 0.5f;

/// Return the rings [mm] along which half of a pixel is painted: outer ones counter-clockwise, holes clockwise. A
/// picture counts as blank beyond its window.
Rings trace_half_coverage(const Coverage& picture, const Window& window, double px_per_mm);

}  // namespace brushsvg
