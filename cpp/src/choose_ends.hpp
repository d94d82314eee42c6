#pragma once

#include "brushsvg/compensate.hpp"
#include "middle_line.hpp"

namespace brushsvg {

/// What `auto` takes: the beginning that differs less from the wanted mark, near it. `stroke` is the wanted one as far
/// as the brush goes, with its line.
Beginning best_beginning(const Stroke& wanted, const Stroke& stroke, const Brush& brush, const Line& line,
                         double step_tolerance);

/// Whether that differs still more than a squared one.
bool begins_better(const Stroke& wanted, const Stroke& squared, const Stroke& stroke, const Brush& brush,
                   Beginning start, double step_tolerance);

/// The same of an end: of the stroke as far as the brush goes, and of that with a squared end.
Ending best_ending(const Stroke& wanted, const Stroke& lifted, const Stroke& squared, const Brush& brush,
                   Beginning start, double step_tolerance);

}  // namespace brushsvg
