#pragma once

#include <array>

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"
#include "brushsvg/stroke.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Distance of the widest point from the middle line, found by simulating the plan: from the first taut row to the
/// last, so that the landing and a slack lift do not count and a turn in place does.
struct TrackingError {
    double largest_mm = 0.0;
    std::array<double, 2> at_mm{};  ///< where the widest point is farthest off
    double mean_mm = 0.0;           ///< over the length that the widest point travels
    bool within_tolerance = false;
    bool has_turn_in_place = false;  ///< set by compensate(): a corner too sharp for the lever, where the miss stays
};

TrackingError tracking_error_of(const Pass& pass, const Stroke& stroke, const Brush& brush, double tolerance_mm);

}  // namespace brushsvg
