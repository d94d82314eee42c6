#pragma once

#include "brushsvg/lag.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/plan.hpp"

namespace brushsvg {

/// Where a patch is at the rows of a pass's marks.
struct FollowedRows {
    Ring contact_mm;  ///< p; in the air the TCP
    Ring heading;     ///< u, unit vectors
};

/// Follow the TCP of a pass with another lag, from row to row of its marks, so that lags can be compared row by row.
///
/// marks: what simulate() returns for this pass and an upright brush. Exact at each row, by the closed form. Headings
/// wait for the first motion as those of simulate() do. Throws Error when the marks are not those of the pass, when it
/// is tilted, or when it is deeper than the lag is known.
FollowedRows follow_lag(const Pass& pass, const PassMarks& marks, const LagLaw<double>& lag);

}  // namespace brushsvg
