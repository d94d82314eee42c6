#pragma once

#include <optional>

#include "brushsvg/ring.hpp"

namespace brushsvg {

/// Unite neighbouring rings that meet without a hole between them: the same shape from fewer rings. The rings go
/// counter-clockwise and do not cross themselves, like the given ones. They may touch themselves. Coordinates are whole
/// units; a mm has `units_per_mm` of them. Each ring begins at its rightmost corner, the highest one if several are.
/// None if rings reach beyond 5e8 units, which is too far for exact products of their lengths.
std::optional<Rings> unite_chain(const Rings& rings, double units_per_mm);

}  // namespace brushsvg
