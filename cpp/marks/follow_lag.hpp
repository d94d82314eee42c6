#pragma once

#include "brushsvg/lag.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/plan.hpp"

namespace brushsvg {

/// Position and heading of a patch at the rows of a pass's marks.
struct FollowedRows {
    Ring contact_mm;  ///< p; in the air the TCP
    Ring heading;     ///< u, unit vectors
};

/// Follow the TCP of a pass with another lag, from row to row of its marks, so that lags can be compared row by row.
///
/// `marks`: the result of simulate() for this pass and an upright brush. The result is exact at each row, by the closed
/// form. As in simulate(), headings wait for the first motion. Throws Error if the marks do not belong to the pass.
/// Throws Error if the pass is tilted, or deeper than the lag is known.
FollowedRows follow_lag(const Pass& pass, const PassMarks& marks, const LagLaw<double>& lag);

}  // namespace brushsvg
