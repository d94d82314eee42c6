#pragma once

#include <optional>
#include <vector>

#include "inverse/ends/end_styles.hpp"
#include "inverse/middle_line.hpp"
#include "inverse/pose_list.hpp"

namespace brushsvg {

/// Return the arc lengths [mm] where the depth passes one of the given depths [mm], or the width has a knot. Samples
/// must be placed there.
std::vector<double> find_depth_places(const Stroke& stroke, const Brush& brush, double length,
                                      const std::vector<double>& depths);

/// Return poses that make the moves of a brush one after the other. The brush is set down for the first, turned over
/// between moves, and lifted after the last. `turns` is set where a line bends too sharply for the lever and the brush
/// turns in place. None if a line cannot continue from the resting P.
std::optional<PoseList> closed_form(const BrushMoves& moves, const Brush& brush, double step_tolerance, bool& turns);

}  // namespace brushsvg
