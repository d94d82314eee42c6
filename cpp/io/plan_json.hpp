#pragma once

#include <string>

#include "brushsvg/plan.hpp"

namespace [[gnu::visibility("default")]] brushsvg {
namespace io {

/// Reads a plan.json. A pose above the paper (z > 0) inside a pass is refused with stroke, pose (counted from 0)
/// and value. Unknown keys go to Pass::extra and Plan::extra. Throws Error with `where` = key path.
Plan read_plan(const std::string& text);

/// Writes a plan as text, with poses as plain decimals rounded to 1e-7 mm. Throws Error for a plan that read_plan would
/// refuse.
std::string write_plan(const Plan& plan);

}  // namespace io
}  // namespace brushsvg
