#pragma once

#include <array>
#include <optional>
#include <vector>

#include "ends/end_styles.hpp"

namespace brushsvg {

/// Select how a stroke begins and ends, as its settings and the options ask for. Where they leave a choice, each style
/// that has room is simulated near the end, and the mark that is most like the wanted one there is taken.
struct SelectedEnds {
    std::vector<BrushMoves> ways;  ///< the best first: those after it are plainer, for lines that the best one misses
    Terminal start, end;           ///< what both look like
};
SelectedEnds select_ends(const Stroke& stroke, const Brush& brush, const CompensateOptions& options,
                         double step_tolerance);

/// What the mark of each terminal costs at one end: paint that is missing or too much, in squares of the half width.
/// None where there is no room for it, or, with the same start, not at both ends. In the order of the terminals.
using TerminalCosts = std::array<std::optional<double>, 3>;
TerminalCosts terminal_costs(const Stroke& stroke, const Brush& brush, Side side, bool with_same_start,
                             double step_tolerance);

}  // namespace brushsvg
