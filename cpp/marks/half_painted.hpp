#pragma once

#include "brushsvg/coverage.hpp"

namespace brushsvg {

/// Share of a pixel above which it is inside of these rings.
inline constexpr float kHalfPainted = 0.5f;

/// Rings [mm] along which half of the pixels is painted, outer ones counter-clockwise, holes clockwise. Beyond its
/// window a picture is blank.
Rings half_painted(const Coverage& picture, const Window& window, double px_per_mm);

}  // namespace brushsvg
