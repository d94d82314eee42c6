#pragma once

/// The name until 0.2: paint_loads.hpp.
#include "brushsvg/paint_loads.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

using InterruptOptions = PaintLoadOptions;

}  // namespace brushsvg
