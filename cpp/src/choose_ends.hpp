#pragma once

#include "brushsvg/compensate.hpp"
#include "middle_line.hpp"
#include "squared_beginning.hpp"
#include "squared_dot.hpp"
#include "squared_end.hpp"

namespace brushsvg {

/// What `auto` takes: the beginning that differs less from the wanted mark, near it. `stroke` is the wanted one as far
/// as the brush goes, with its line.
Beginning best_beginning(const Stroke& wanted, const Stroke& stroke, const Brush& brush, const Line& line,
                         double step_tolerance);

/// Whether a dot with corners is more like the wanted one than round.
bool is_better_squared(const Stroke& wanted, const SquaredDot& dot, const Brush& brush, double step_tolerance);

/// Whether a squared one makes the mark begin still better, by more than can hardly be seen. start: how the stroke
/// begins without it; whole: the stroke with its way, up to its end.
bool begins_better(const Stroke& wanted, const SquaredBeginning& squared, const Stroke& whole, const Stroke& stroke,
                   const Brush& brush, Beginning start, double step_tolerance);

/// What `auto` takes of ends: of that of the stroke as far as the brush goes, and of that with a squared end.
Ending best_ending(const Stroke& wanted, const Stroke& lifted, const SquaredEnd& squared, const Brush& brush,
                   Beginning start, double step_tolerance);

}  // namespace brushsvg
