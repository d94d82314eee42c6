#pragma once

#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/plan.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Simulate the brush while the TCP follows a pass: the forward model.
///
/// There are rows at every pose, at every event (loosening, tightening, touching, lifting) and in between. Half-way
/// between two rows, no point of the footprint is further than `tolerance_mm` from the straight line between them.
/// Where a pen turns, there are two rows at one pose, because the pen heads for the next pose at once.
///
/// A pass that begins or ends below z = 0 is pressed down or lifted in place, with additional rows: see pose_rows().
///
/// `for_outlines`: false leaves out rows that are needed only for the outline of the mark, not for the motion of the
/// patch. This is faster, and enough for widest_points(). `may_rise`: true if the pass is the motion of a machine,
/// which may leave the paper; above the paper the bristles are free.
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
/// contact_mm.row(pose_rows(marks)[k]) is the contact when the TCP is at pose k. If a pass begins on the paper, the
/// rows before the first pose's row show how the brush is pressed down in place. If it ends on the paper, the rows
/// after the last pose's row show how the brush is lifted in place. All of these rows have the index of that pose.
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
