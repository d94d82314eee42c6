#pragma once

#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/plan.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Simulate the brush while the TCP follows a pass: the forward model.
///
/// There are rows at every pose, at every event (loosening, tightening, touching, lifting) and in between. Half way
/// between two rows, no point of the footprint is further than `tolerance_mm` from the straight line between them.
/// Where a pen turns, there are two rows at one pose, because the pen heads for the next pose at once.
///
/// A pass that begins or ends below z = 0 is set down or lifted on the spot, with rows of its own: see pose_rows().
///
/// `for_outlines`: false leaves out rows that only the footprint's shape needs, not its motion. This is quick, and
/// enough for widest_points(). `may_rise`: true if the pass is the motion of a machine, which may leave the paper;
/// above it the brush hangs free.
///
/// Throws Error if a pose is deeper than the brush allows, not finite, or above the paper (z > 0) without `may_rise`. A
/// pass that is entirely above the paper is refused in any case.
PassMarks simulate(const Pass& pass, const Brush& brush, double tolerance_mm = 0.02, bool for_outlines = true,
                   bool may_rise = false);

/// Simulate a pass for a picture of a part of the paper.
///
/// Rows are dense only near `window`. Moves that paint nothing in it have rows only at their ends.
PassMarks simulate_near(const Pass& pass, const Brush& brush, const Window& window, double tolerance_mm = 0.02);

/// Simulate all passes of a plan.
Marks simulate(const Plan& plan, const Brush& brush, double tolerance_mm = 0.02);

/// Return the row of each pose.
///
/// contact_mm.row(pose_rows(marks)[k]) is the patch when the TCP is at pose k. Rows before the first pose's row show a
/// pass that begins on the paper being set down on the spot. Rows after the last pose's row show a pass that ends on
/// the paper being lifted on the spot. All of them have the index of that pose, while the patch moves.
std::vector<std::size_t> pose_rows(const PassMarks& marks);

/// Return the centre of the widest section at every row [mm]: m = p + e(d) u.
Ring widest_points(const PassMarks& marks, const Brush& brush);

/// Rows [first, last) in which the brush is lifted to turn over.
///
/// The brush is loose there. Its least depth is at most half of the depth just before and just after.
struct TurnOver {
    std::size_t first, last;
};
/// Find the rows in which the brush is lifted to turn over.
std::vector<TurnOver> find_turn_overs(const PassMarks& marks);

}  // namespace brushsvg
