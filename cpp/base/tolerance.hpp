#pragma once

#include <array>
#include <string>

#include "base/format_text.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg {

/// Range of tolerances. Finer ones are lost in rounding and never end, coarser ones are useless for a brush.
inline constexpr std::array<double, 2> kToleranceRangeMm{1e-8, 1000.0};

/// Throws Error for a tolerance [mm] outside this range.
inline void require_tolerance(double tolerance_mm, const std::string& where = "") {
    if (tolerance_mm >= kToleranceRangeMm[0] && tolerance_mm <= kToleranceRangeMm[1]) return;
    throw Error("out-of-range",
                format_text("the tolerance is %.4g mm, outside the range [1e-8, 1000] mm", tolerance_mm), where,
                tolerance_mm, kToleranceRangeMm);
}

}  // namespace brushsvg
