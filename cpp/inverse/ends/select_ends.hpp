#pragma once

#include <array>
#include <optional>
#include <vector>

#include "inverse/ends/end_styles.hpp"

namespace brushsvg {

/// Select how a stroke begins and ends, as its settings and the options require. Where they leave a choice, each style
/// that has room is simulated near the end. The style whose mark is most like the target there is taken. Returns the
/// moves of the brush, the best ones first. The others are plainer, for lines that the best ones cannot follow.
std::vector<BrushMoves> select_ends(const Stroke& stroke, const Brush& brush, const CompensateOptions& options,
                                    double step_tolerance);

}  // namespace brushsvg
