#pragma once

#include <optional>

#include "brushsvg/brush.hpp"
#include "brushsvg/stroke.hpp"

namespace brushsvg {

/// A stroke that ends with a dot amid its round cap: at the full width until the widest section is there, then the
/// brush is lifted a little, drawn on until P rests there, and turned round on the spot.
struct TurnedEnd {
    Stroke stroke;    ///< up to the middle of the cap
    double depth_mm;  ///< while it turns
};

/// The cap is that of the drawn outline; of a path with a width alone, as wide as that. None for a ring, a rigid brush,
/// where the drawn end is not round, and where no less depth than the stroke's makes a dot of its size.
std::optional<TurnedEnd> turned_end(const Stroke& stroke, const Brush& brush);

}  // namespace brushsvg
