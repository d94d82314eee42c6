#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "brushsvg/error.hpp"

namespace brushsvg {

/// Range of tolerances. Finer ones are lost in rounding and never end, coarser ones are useless for a brush.
inline constexpr std::array<double, 2> kToleranceRangeMm{1e-8, 1000.0};

/// Throws Error for a tolerance [mm] outside this range.
inline void require_tolerance(double tolerance_mm, const std::string& where = "") {
    if (tolerance_mm >= kToleranceRangeMm[0] && tolerance_mm <= kToleranceRangeMm[1]) return;
    char text[120];
    std::snprintf(text, sizeof text, "the tolerance of %.4g mm is outside the range [1e-8, 1000] mm", tolerance_mm);
    throw Error("out-of-range", text, where, tolerance_mm, kToleranceRangeMm);
}

}  // namespace brushsvg
