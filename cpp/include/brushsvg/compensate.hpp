#pragma once

#include <optional>
#include <string>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"
#include "brushsvg/stroke.hpp"

namespace brushsvg {

enum class Compensation {
    none,      ///< TCP on the middle line, pressed and lifted on the spot
    constant,  ///< q = m + r0 T, what other tools do, with a fair landing
    closed     ///< theory of the lever: q = m + (r - e) u
};

struct CompensateOptions {
    Compensation method = Compensation::closed;
    double tolerance_mm = 0.05;     ///< of the widest point from the middle line, between poses too
    std::optional<double> lag_mm;   ///< constant only; default the lag at the stroke's median depth
    double speed_mm_s = 20.0;       ///< capped by the brush's own limit
};

/// Distance of the widest point from the middle line over taut rows, found by simulating the plan.
struct Miss {
    double largest_mm = 0.0;
    double mean_mm = 0.0;
    bool within_tolerance = false;
    bool has_turn_in_place = false;  ///< a corner too sharp for the lever: the miss stays there
};

struct CompensatedPass {
    Pass pass;
    Miss miss;
    std::vector<Warning> warnings;
};

/// Inverse: where the TCP must go so that the widest section runs along the stroke's middle line.
/// Throws Error for widths the brush cannot paint.
CompensatedPass compensate(const Stroke& stroke, const Brush& brush, const CompensateOptions& options = {});

/// The remaining miss of any pass against the stroke it should paint.
Miss miss_of(const Pass& pass, const Stroke& stroke, const Brush& brush, double tolerance_mm);

}  // namespace brushsvg
