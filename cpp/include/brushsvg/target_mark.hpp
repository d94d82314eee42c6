#pragma once

#include "brushsvg/region.hpp"
#include "brushsvg/stroke.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Rings of the target mark: `wanted_mm` where given, else the union of discs of the stroke's half width along its
/// middle line (the path with its width, round caps and round joins). No point of the outline is further than
/// `tolerance_mm` from the true one.
Rings wanted_outline(const Stroke& stroke, double tolerance_mm = 0.005);

/// Convex counter-clockwise rings whose union is the path with its width and round caps, whether or not `wanted_mm` is
/// given: enough for a picture, at a fraction of the outline's cost.
Rings wanted_pieces(const Stroke& stroke, double tolerance_mm = 0.005);

/// Those of them that may show in a part of the paper, in the same order.
Rings wanted_pieces_near(const Stroke& stroke, const Window& window, double tolerance_mm = 0.005);

}  // namespace brushsvg
