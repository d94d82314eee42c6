#pragma once

#include <optional>

#include "brushsvg/brush.hpp"
#include "brushsvg/stroke.hpp"
#include "drawn_cut.hpp"

namespace brushsvg {

/// A stroke with a squared beginning: the brush is set down inside of it, heading back along its path at the full
/// width. Near the drawn beginning it narrows, goes into the corner that lies farther back, along the cut into the
/// other one, and turns round there: it comes back along that side, widens, and is on the path again.
struct SquaredBeginning {
    Stroke stroke;
    Eigen::Vector2d leaves_mm;  ///< where it leaves the path on its way back
    Eigen::Vector2d aside_mm;   ///< how far it comes back along the side
    Eigen::Vector2d joins_mm;   ///< where it is on the path again
    Eigen::Vector2d start_mm;   ///< the drawn path's first point
    Eigen::Vector2d along;      ///< and its direction there
    double reach_mm;            ///< and how far from there its widest section goes
};

/// The cut as of a squared end, and none where that has none; and where the stroke has no room for the way back.
std::optional<SquaredBeginning> squared_beginning(const Stroke& stroke, const Brush& brush, Caps caps);

}  // namespace brushsvg
