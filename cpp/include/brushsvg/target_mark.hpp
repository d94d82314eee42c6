#pragma once

#include "brushsvg/region.hpp"
#include "brushsvg/stroke.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Return the outline of the target mark, as rings.
///
/// It is `target_mm` if given. Otherwise it is the path with its width: the union of discs of the half width along the
/// middle line, with round caps and joins. No point of the outline is further than `tolerance_mm` from the true
/// outline.
Rings target_outline(const Stroke& stroke, double tolerance_mm = 0.005);

/// Return convex counter-clockwise rings that cover the path with its width.
///
/// Their union has round caps and does not depend on `target_mm`. They suffice for a picture, at a fraction of the
/// outline's cost.
Rings target_pieces(const Stroke& stroke, double tolerance_mm = 0.005);

/// Return the rings of target_pieces() that may overlap a part of the paper, in the same order.
Rings target_pieces_near(const Stroke& stroke, const Window& window, double tolerance_mm = 0.005);

}  // namespace brushsvg
