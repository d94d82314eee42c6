#pragma once

#include <array>
#include <optional>
#include <vector>

#include "brushsvg/stroke.hpp"

namespace brushsvg {

/// Another way to paint a stroke.
struct Variant {
    bool is_reversed = false;
    bool is_square = true;                ///< its ends go into the corners of its shape, if it has one
    bool is_pointed = false;              ///< it begins pointed
    bool is_in_room = false;              ///< it is as narrow as its shape
    double width = 1.0;                   ///< as a share of its own width
    std::array<double, 2> cut{0.0, 0.0};  ///< lengths cut off its ends, in its greatest half width
};

/// Return a stroke that is changed by a variant, its widths limited to the brush's half widths. None if too little is
/// left of it.
std::optional<Stroke> apply_variant(const Stroke& stroke, const Variant& variant, const std::array<double, 2>& half_mm);

/// Return the part of a stroke between two arc lengths.
Stroke part_between(const Stroke& stroke, double from_mm, double to_mm);

}  // namespace brushsvg
