#pragma once

#include <optional>
#include <vector>

#include "inverse/ends/end_styles.hpp"
#include "inverse/middle_line.hpp"
#include "inverse/pose_list.hpp"

namespace brushsvg {

/// Arc lengths [mm] where the depth passes one of these [mm], or the width has a knot: samples must stand there.
std::vector<double> places_of_depths(const Stroke& stroke, const Brush& brush, double length,
                                     const std::vector<double>& depths);

/// Poses that make the moves of a brush one after the other: set down for the first, turned over between them, and
/// lifted after the last. `turns` where a line bends too sharply for the lever and the brush turns in place. None where
/// a line cannot go on from where P rests.
std::optional<PoseList> closed_form(const BrushMoves& moves, const Brush& brush, double step_tolerance, bool& turns);

}  // namespace brushsvg
