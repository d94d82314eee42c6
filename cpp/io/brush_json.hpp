#pragma once

#include <string>

#include "brushsvg/brush.hpp"

namespace [[gnu::visibility("default")]] brushsvg {
namespace io {

/// Reads a brush.json. This checks its shape (keys, types, intervals, counts), and check(brush) its physics.
/// Unknown keys go to Profile::extra and Brush::extra. Unknown keys of "footprints" and of outlines go to
/// Brush::extra under "footprints" (outlines by their depth). Throws Error with `where` = key path.
Brush read_brush(const std::string& text);

/// Writes a brush as text, with numbers that read back to the same doubles. Throws Error for a brush that read_brush
/// would refuse.
std::string write_brush(const Brush& brush);

}  // namespace io
}  // namespace brushsvg
