#pragma once

#include <array>

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"
#include "brushsvg/stroke.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Distance of the widest point from the middle line, measured by simulating the pass.
///
/// It is measured from the first taut row to the last. So the landing and a slack lift do not count, but a turn in
/// place does.
struct TrackingError {
    double largest_mm = 0.0;
    std::array<double, 2> at_mm{};  ///< where the widest point is farthest from the line (x, y), paper frame
    double mean_mm = 0.0;           ///< mean over the length that the widest point travels
    bool within_tolerance = false;
    bool has_turn_in_place = false;  ///< set by compensate(): at a corner too sharp for the lever, an error stays
};

/// Return the tracking error of a pass against the stroke that it paints.
///
/// `tolerance_mm`: limit for `within_tolerance`; it also sets how finely the pass is simulated.
TrackingError tracking_error_of(const Pass& pass, const Stroke& stroke, const Brush& brush, double tolerance_mm);

}  // namespace brushsvg
