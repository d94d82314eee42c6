#pragma once

#include <array>

#include "brushsvg/brush.hpp"
#include "brushsvg/compensate.hpp"
#include "brushsvg/stroke.hpp"

// From the closed form on: what is left is the footprint's shape, at ends and corners and on curves.
namespace brushsvg::fit {

struct RefineOptions {
    double tolerance_mm = 0.05;  ///< of the closed form, and of the TCP's chords
    double speed_mm_s = 20.0;    ///< capped by the brush's own limit
    /// Width and height. No paint leaves the sheet, and the TCP goes at most 30 mm beyond it, or as far as the closed
    /// form's. Zero: anywhere.
    std::array<double, 2> sheet_mm{0.0, 0.0};
    Terminal start = Terminal::pointed;  ///< of the closed form; how a stroke begins stays
    Terminal end = Terminal::round;      ///< and how it ends
    int iterations = 12;  ///< of the solver: forty win 0.0005 of overlap more and take half as long again
};

struct RefinedPass {
    CompensatedPass plan;
    /// Area of intersection over area of union of predicted and target mark, by their outlines, of the plan in closed
    /// form, and of this plan. Zero where nothing was tried. The report's pixels, common_area(), find within 0.005 of
    /// it, and are used where no more is won.
    double overlap_closed = 0.0;
    double overlap = 0.0;
    bool bettered = false;  ///< false: this plan is the one in closed form
};

/// The plan in closed form, moved until the outline of its mark fits the target best: where the patch goes, how
/// deep it is pressed, where it starts and ends; where that is not good, again from a beginning that comes in from the
/// side. The patch is never pushed, so q = P + r(depth) u holds all along. The
/// plan is simulated, and kept only where its mark overlaps better by the report's own measure, stays in bounds, and
/// does not pay for it with an outline that turns more or has thorns: a full turn is worth 0.1 of overlap, a thorn
/// 0.02. Where the whole step is not calm, parts of it are tried as well, and where none of them is, smaller steps. Its
/// tracking error is that from the drawn middle line, which it leaves on purpose. Throws Error as compensate() does.
RefinedPass refine(const Stroke& stroke, const Brush& brush, const RefineOptions& options = {});

}  // namespace brushsvg::fit
