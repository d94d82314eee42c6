#pragma once

#include <array>
#include <vector>

#include "brushsvg/stroke.hpp"

namespace brushsvg {

/// The part that is left out between two parts of a stroke [mm along it]. It is empty where the parts meet.
using Gap = std::array<double, 2>;

/// Return gaps at each sharp bend of a stroke, and from each bend to the next. A bend is sharp if the chords of half a
/// width before and behind a place turn by more than 30 degrees.
std::vector<Gap> find_gaps(const Stroke& stroke);

/// Cut a stroke into parts. Each later part begins pointed, under the paint of the one before.
std::vector<Stroke> cut_at_gaps(const Stroke& stroke, const std::vector<Gap>& gaps);

}  // namespace brushsvg
