#pragma once

/// The name until 0.2: paint_loads.hpp.
#include "brushsvg/paint_loads.hpp"

namespace brushsvg {

using InterruptOptions = PaintLoadOptions;

}  // namespace brushsvg
