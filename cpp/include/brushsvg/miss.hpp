#pragma once

/// The name until 0.2: tracking_error.hpp.
#include "brushsvg/tracking_error.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

using Miss = TrackingError;
inline TrackingError miss_of(const Pass& pass, const Stroke& stroke, const Brush& brush, double tolerance_mm) {
    return tracking_error_of(pass, stroke, brush, tolerance_mm);
}

}  // namespace brushsvg
