#pragma once

#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/plan.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Forward: what the brush does when the TCP follows a pass. Rows stand at every pose, at every event (loosening,
/// tightening, touching, lifting) and in between as closely as `tolerance_mm` asks: half way between two
/// rows no point of the footprint is further than it from the straight line between them. Where a pen turns there are
/// two at the same pose: it heads for the next one at once.
/// A pass that begins or ends below z = 0 is set down or lifted on the spot, with rows of its own: see pose_rows().
/// Throws Error when a pose is deeper than the brush allows, above the paper (z > 0) or not finite. `for_outlines`
/// false leaves out the rows that only the footprint's shape needs, not its motion: quick, enough for widest_points().
/// `may_rise`: the pass is the motion of a machine, which may leave the paper: there the brush hangs free. One that is
/// above the paper from end to end is refused all the same.
PassMarks simulate(const Pass& pass, const Brush& brush, double tolerance_mm = 0.02, bool for_outlines = true,
                   bool may_rise = false);

/// For a picture of a part of the paper: as closely there alone. Moves that paint nothing of it have rows at their
/// ends.
PassMarks simulate_near(const Pass& pass, const Brush& brush, const Window& window, double tolerance_mm = 0.02);

Marks simulate(const Plan& plan, const Brush& brush, double tolerance_mm = 0.02);

/// The row of each pose: contact_mm.row(pose_rows(marks)[k]) is where the patch is when the TCP is at pose k. The rows
/// before the first pose's are of a pass that begins on the paper and is set down on the spot, those after the last
/// pose's of one that ends there and is lifted on the spot: they carry the same pose, and the patch moves in them.
std::vector<std::size_t> pose_rows(const PassMarks& marks);

/// Centre of the widest section at every row [mm]: m = p + e(d) u.
Ring widest_points(const PassMarks& marks, const Brush& brush);

/// Rows [first, last) where the brush is lifted to turn over: loose, and for a while pressed half as deep as before and
/// after, or less.
struct TurnOver {
    std::size_t first, last;
};
std::vector<TurnOver> turns_over(const PassMarks& marks);

}  // namespace brushsvg
