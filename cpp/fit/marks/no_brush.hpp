#pragma once

#include <string>

#include "brushsvg/error.hpp"

namespace brushsvg::fit {

/// The refusal of marks that no brush paints. `stroke` is the one whose mark fits least.
///
/// A search that nothing fits ends anywhere: rounding decides whether it counts too much work, comes to laws that
/// predict nothing, or finds a brush whose edges are far from the marks'. All of these refuse with this one error.
inline Error no_brush_paints(const std::string& stroke) {
    return Error("fit-failed",
                 "no brush was found that paints this mark along its stroke. Check that it is the mark of this stroke, "
                 "that its outline is in mm, and that the stroke touches the paper",
                 stroke);
}

}  // namespace brushsvg::fit
