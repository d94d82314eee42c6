#pragma once

#include <string>

#include "brushsvg/marks.hpp"

namespace [[gnu::visibility("default")]] brushsvg {
namespace io {

/// Reads a marks.json. The file has neither the TCP nor the pull, so that tcp_mm is empty and pull is 1 everywhere.
/// Throws Error with `where` = key path.
Marks read_marks(const std::string& text);

/// Writes marks as text, with numbers as plain decimals rounded to 1e-7. Throws Error for rows that are not parallel or
/// numbers that are not finite.
std::string write_marks(const Marks& marks);

}  // namespace io
}  // namespace brushsvg
