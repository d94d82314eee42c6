#pragma once

#include <optional>

#include "brushsvg/brush.hpp"
#include "brushsvg/stroke.hpp"
#include "drawn_cut.hpp"

namespace brushsvg {

/// A stroke as wide as painted, led to the middle of the round cap at one of its ends: where a line of a shape ends, it
/// may lie beside that, or bend.
struct ToCap {
    Stroke stroke;
    Cap cap;
};

/// None where the drawn end is not round, or marks narrow as paint runs out: a patch that is pressed deeper for it,
/// turned round, paints as large a disc as a wet one, a knob.
std::optional<ToCap> ends_in_cap(const Stroke& stroke, const Brush& brush);
/// The same of its beginning.
std::optional<ToCap> begins_in_cap(const Stroke& stroke, const Brush& brush);

}  // namespace brushsvg
