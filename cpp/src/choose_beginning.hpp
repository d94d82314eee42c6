#pragma once

#include "brushsvg/compensate.hpp"
#include "middle_line.hpp"

namespace brushsvg {

/// What `auto` takes: the beginning that differs less from the wanted mark, near it. `stroke` is the wanted one as far
/// as the brush goes, with its line.
Beginning best_beginning(const Stroke& wanted_stroke, const Stroke& stroke, const Brush& brush, const Line& line,
                         double step_tolerance);

}  // namespace brushsvg
