#pragma once

#include <string>

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"

namespace [[gnu::visibility("default")]] brushsvg {
namespace posts {

/// A machine of three axes whose work zero is the sheet's lower left corner, z = 0 where the unbent brush just touches.
/// Lengths in mm, speeds in mm/s. The defaults are those of the cell linuxcnc-3axis; with other numbers give the name
/// of your own cell file, by which `brushsvg check --cell FILE` knows them.
struct FlatCell {
    double safe_mm = 10.0;      ///< height of travel between strokes
    double clearance_mm = 1.0;  ///< below it only at press_mm_s
    double lowest_mm = -20.0;   ///< never lower than this
    double margin_mm = 30.0;    ///< how far beyond the sheet's edges the tool may go: it leads the brush
    double approach_mm_s = 30.0;
    double press_mm_s = 8.0;    ///< straight down into the paper, and up again
    double paint_mm_s = 50.0;   ///< the most while painting
    double blending_mm = 0.01;  ///< how far from the joint of two moves the machine may pass; 0: exactly through it
    double travel_mm_s = 60.0;  ///< at the safe height: for the time in the header, as is the next
    double acceleration_mm_s2 = 500.0;
    std::string name = "linuxcnc-3axis";  ///< what the header calls the machine
};

/// A plan as G-code for LinuxCNC (RS274/NGC): lines of four decimals, a plan's arcs as G2 and G3, tiny ones through
/// their poses. A pass that begins or ends below the paper is set down and lifted there.
///
/// What is looked at is each stroke's own way: its poses, heights, speeds and the sheet with its margin. Whether the
/// paint stays on the sheet and how corners are cut is looked at by the program brushsvg alone, which also fetches
/// paint. Throws Error, naming the stroke: no pass or pose, a brush of another name, a number that is not finite, a
/// place or a speed out of its range, an arc that is none, a brush that is never pressed.
std::string linuxcnc(const Plan& plan, const Brush& brush, const FlatCell& cell = {},
                     const std::string& title = "untitled");

}  // namespace posts
}  // namespace brushsvg
