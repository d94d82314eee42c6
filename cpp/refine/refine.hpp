#pragma once

#include <array>

#include "brushsvg/brush.hpp"
#include "brushsvg/compensate.hpp"
#include "brushsvg/stroke.hpp"

// Improve on the closed form. It leaves errors from the footprint's shape, at ends and corners and on curves.
namespace brushsvg::fit {

struct RefineOptions {
    double tolerance_mm = 0.05;  ///< tolerance of the closed form, and of the TCP's chords
    double speed_mm_s = 20.0;    ///< capped by the brush's own limit
    /// Width and height. No paint leaves the sheet. The TCP goes at most 30 mm beyond it, or as far as in the closed
    /// form. Zero: no limits.
    std::array<double, 2> sheet_mm{0.0, 0.0};
    Terminal start = Terminal::pointed;  ///< start of the closed form; the fit does not change its style
    Terminal end = Terminal::round;      ///< end of the closed form; the fit does not change its style
    /// Iterations of the solver: forty win 0.0005 of overlap more and take half as long again.
    int iterations = 12;
};

struct RefinedPass {
    CompensatedPass plan;
    /// Area of intersection over area of union of predicted and target mark, from their outlines: of the plan in closed
    /// form, and of this plan. Zero where nothing was tried. The report's pixels, common_area(), give a value within
    /// 0.005. They decide where the gain is not larger than that.
    double overlap_closed = 0.0;
    double overlap = 0.0;
    bool is_improved = false;  ///< false: this plan is the one in closed form
};

/// Move the plan in closed form until the outline of its mark fits the target best. The fit changes the patch's path,
/// its depth, start and end. If the result is not good, the fit starts again from a beginning that comes in from the
/// side. The patch is never pushed, so q = P + r(depth) u always holds. The plan is simulated. It is kept only if its
/// mark overlaps better by the report's own measure and stays in bounds. Its outline must not turn more or have thorns:
/// a full turn counts as 0.1 of overlap, a thorn as 0.02. Where the whole step is not calm, parts of it are tried, and
/// then smaller steps. The tracking error is measured from the drawn middle line, which the plan leaves on purpose.
/// Throws Error as compensate() does, and for a sheet with a side that is not greater than 0.
RefinedPass refine(const Stroke& stroke, const Brush& brush, const RefineOptions& options = {});

}  // namespace brushsvg::fit
