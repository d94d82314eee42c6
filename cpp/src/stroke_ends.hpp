#pragma once

#include <array>

#include "brushsvg/brush.hpp"
#include "brushsvg/stroke.hpp"
#include "middle_line.hpp"

namespace brushsvg {

/// How far the front of the footprint reaches beyond the drawn end of a mark [mm], half a width from its path's, with
/// the widest section over that: less than 0 is what is missing. A blunt front is not what is left in the end: the
/// brush is lifted while P rests, and the front of a shallower footprint may lie further ahead of P.
double beyond_the_end(const Brush& brush, double depth, double half_width_mm);

/// Where along the line the widest section starts and stops [mm]: the tip begins the mark and the footprint's front
/// ends it, half a width beyond the path's ends.
std::array<double, 2> painted_stretch(const Stroke& stroke, const Brush& brush, double length);

/// The stroke up to where the front of the footprint reaches the drawn end, half a width beyond the path's: a blunt one
/// has to go beyond that itself.
Stroke up_to_its_end(const Stroke& stroke, const Brush& brush);

/// Whether the pointed rear of a footprint that is set down heading back along the line stays inside the stroke: each
/// place on its axis is nearer to the line than it is to the edge, there where the rear is so narrow. And whether the
/// way back goes round no corner: P would be dragged past it.
bool rear_lies_inside(const Stroke& stroke, const Brush& brush, const Line& line, double widest_mm);

}  // namespace brushsvg
