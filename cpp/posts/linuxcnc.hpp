#pragma once

#include <string>

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"

namespace [[gnu::visibility("default")]] brushsvg {
namespace posts {

/// A three-axis machine whose work zero is the sheet's lower left corner, with z = 0 where the unbent brush just
/// touches. Lengths are in mm, speeds in mm/s. The defaults are those of the cell linuxcnc-3axis. With other numbers,
/// give the name of your own cell file, so that `brushsvg check --cell FILE` finds them.
struct FlatCell {
    double safe_mm = 10.0;      ///< height of travel between strokes
    double clearance_mm = 1.0;  ///< below this height, the tool moves only at press_mm_s
    double lowest_mm = -20.0;   ///< lowest height of the tool
    double margin_mm = 30.0;    ///< allowed beyond the sheet's edges, because the tool runs ahead of the brush
    double approach_mm_s = 30.0;
    double press_mm_s = 8.0;    ///< speed straight down to the paper and up again
    double paint_mm_s = 50.0;   ///< greatest speed while painting
    double blending_mm = 0.01;  ///< largest distance of the path from the joint of two moves; 0: exact
    double travel_mm_s = 60.0;  ///< speed at the safe height; this and the next are only for the time in the header
    double acceleration_mm_s2 = 500.0;
    std::string name = "linuxcnc-3axis";  ///< name of the machine in the header
};

/// Writes a plan as G-code for LinuxCNC (RS274/NGC), with four decimals. Arcs of the plan become G2 and G3, except tiny
/// ones, which go through their poses. A pass that begins or ends below the paper is set down and lifted there.
///
/// Only the path of each stroke is checked: its poses, heights and speeds, and the sheet with its margin. The program
/// brushsvg alone checks whether the paint stays on the sheet and how corners are cut, and reloads paint. Throws Error
/// with the stroke's name: for no pass or pose, a brush of another name, a number that is not finite, a place or a
/// speed out of its range, an arc that is not one, and a brush that is never pressed.
std::string linuxcnc(const Plan& plan, const Brush& brush, const FlatCell& cell = {},
                     const std::string& title = "untitled");

}  // namespace posts
}  // namespace brushsvg
