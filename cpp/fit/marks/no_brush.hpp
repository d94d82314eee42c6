#pragma once

#include <string>

#include "brushsvg/error.hpp"

namespace brushsvg::fit {

/// Returns the error for marks that no brush paints. `stroke` is the stroke whose mark fits worst.
///
/// A search without a solution ends anywhere. Rounding determines whether it needs too much work, reaches laws that
/// predict nothing, or finds a brush whose edges are far from the marks. All these cases throw this error.
inline Error no_brush_error(const std::string& stroke) {
    return Error("fit-failed",
                 "no brush was found that paints this mark along its stroke: check that it is the mark of this stroke, "
                 "that its outline is in mm, and that the stroke touches the paper",
                 stroke);
}

}  // namespace brushsvg::fit
