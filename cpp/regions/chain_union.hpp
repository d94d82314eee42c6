#pragma once

#include <optional>

#include "brushsvg/ring.hpp"

namespace brushsvg {

/// The same shape from fewer rings: neighbours that meet, without a hole between them, become one. Rings go
/// counter-clockwise and cross themselves nowhere, as those that are given; they may touch themselves. Coordinates are
/// whole units, of which `units_per_mm` are a mm; each ring begins at its rightmost corner, the highest of those.
/// Nothing where rings reach beyond 5e8 units: too far for exact products of their lengths.
std::optional<Rings> united_in_chain(const Rings& rings, double units_per_mm);

}  // namespace brushsvg
