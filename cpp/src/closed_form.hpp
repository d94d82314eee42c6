#pragma once

#include <optional>
#include <vector>

#include "brushsvg/compensate.hpp"
#include "middle_line.hpp"
#include "pose_list.hpp"
#include "squared_dot.hpp"

namespace brushsvg {

/// Arc lengths [mm] where the depth passes one of these [mm], or the width has a knot: samples must stand there.
std::vector<double> places_of_depths(const Stroke& stroke, const Brush& brush, double length,
                                     const std::vector<double>& depths);

/// Poses that lead the widest section along the line, set down as said and lifted at its end, or turned round there at
/// a depth first; `turns` where the line bends too sharply for the lever and the brush turns in place.
PoseList closed_form(const Stroke& stroke, const Brush& brush, const Line& line, Beginning start, double step_tolerance,
                     bool& turns, std::optional<double> turned_depth_mm = {});

/// The same of a dot with corners.
PoseList closed_form(const SquaredDot& dot, const Brush& brush, double step_tolerance, bool& turns);

}  // namespace brushsvg
