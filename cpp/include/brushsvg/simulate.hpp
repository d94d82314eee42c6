#pragma once

#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/plan.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Forward: what the brush does when the TCP follows a pass. Rows stand at every pose, at every event (loosening,
/// tightening, touching, lifting) and in between as closely as `tolerance_mm` asks: half way between two
/// rows no point of the footprint is farther than it from the straight line between them. Where a pen turns there are
/// two at the same pose: it heads for the next one at once.
/// z > 0 is above the paper: there the brush hangs free. Throws Error when a pose is deeper than the brush allows or
/// not finite, and when all poses are above the paper. `for_outlines` false leaves out the rows that only the
/// footprint's shape needs, not its motion: quick, enough for widest_points().
PassMarks simulate(const Pass& pass, const Brush& brush, double tolerance_mm = 0.02, bool for_outlines = true);

/// For a picture of a part of the paper: as closely there alone. Moves that paint nothing of it have rows at their
/// ends.
PassMarks simulate_near(const Pass& pass, const Brush& brush, const Window& window, double tolerance_mm = 0.02);

Marks simulate(const Plan& plan, const Brush& brush, double tolerance_mm = 0.02);

/// Centre of the widest section at every row [mm]: m = p + e(d) u.
Ring widest_points(const PassMarks& marks, const Brush& brush);

/// Rows [first, last) where the brush is lifted to turn over: loose, and for a while pressed half as deep as before and
/// after, or less.
struct TurnOver {
    std::size_t first, last;
};
std::vector<TurnOver> turns_over(const PassMarks& marks);

}  // namespace brushsvg
