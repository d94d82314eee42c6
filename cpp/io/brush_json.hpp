#pragma once

#include <string>

#include "brushsvg/brush.hpp"

namespace [[gnu::visibility("default")]] brushsvg {
namespace io {

/// Reads a brush.json: its shape (keys, types, intervals, counts), not its physics; check(brush) judges that.
/// Unknown keys go to Profile::extra and Brush::extra; those of "footprints" and of single outlines to
/// Brush::extra under "footprints" (outlines by their depth). Throws Error with `where` = key path.
Brush read_brush(const std::string& text);

/// The same brush as text, every number reading back to the same double. Throws Error for what read_brush
/// would refuse.
std::string write_brush(const Brush& brush);

}  // namespace io
}  // namespace brushsvg
