#pragma once

#include <optional>

#include "brushsvg/brush.hpp"
#include "brushsvg/stroke.hpp"
#include "drawn_cut.hpp"

namespace brushsvg {

/// A stroke with a squared end: near its end it narrows and runs on into the corner that lies farther ahead, its outer
/// edge on the stroke's own, then along the cut into the other corner, and a little way back.
struct SquaredEnd {
    Stroke stroke;
    Eigen::Vector2d leaves_mm;  ///< where it leaves the drawn path
    Eigen::Vector2d end_mm;     ///< the drawn path's end
    double reach_mm;            ///< and how far from there its widest section goes
};

/// The cut is that of the drawn outline; of a path with a width alone, its cap. None for a ring, a rigid brush, where
/// the drawn end is not cut straight, where the brush is too coarse for the narrower mark, and where there is no room.
std::optional<SquaredEnd> squared_end(const Stroke& stroke, const Brush& brush, Caps caps);

}  // namespace brushsvg
