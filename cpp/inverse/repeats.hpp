#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "brushsvg/compensate.hpp"
#include "brushsvg/ring.hpp"
#include "brushsvg/stroke.hpp"

namespace brushsvg {

/// The first of several equal strokes or shapes, which differ only in their place. A text repeats its letters, and each
/// needs to be computed once.
struct Original {
    std::size_t index;
    Eigen::Vector2d displacement_mm;  ///< from the original, paper frame
};

/// Points (x, y), one per row.
using Points = Ring;

/// Find the original of each thing; the first of its kind is its own.
///
/// `points_mm`: the points of each thing. A thing without finite points has no equal. `are_alike(k, j)`: whether the
/// things k and j are equal apart from their points.
std::vector<Original> find_originals(const std::vector<Points>& points_mm,
                                     const std::function<bool(std::size_t, std::size_t)>& are_alike);

/// Find the original of each stroke.
std::vector<Original> find_originals(const std::vector<Stroke>& strokes);

/// Return the points of the stroke's middle line and target.
Points points_of(const Stroke& stroke);

/// Return whether two strokes are equal apart from their points, names and colours.
bool are_alike(const Stroke& a, const Stroke& b);

/// Return whether two lists of rings have the same numbers of points.
bool are_alike(const Rings& a, const Rings& b);

/// Return the points of several lists in one.
Points joined(const Rings& lists);

/// Return the compensated pass of a stroke, from the one of its original.
CompensatedPass move_to(const Stroke& stroke, CompensatedPass done, const Eigen::Vector2d& displacement_mm);

/// Move points in place. Each row has one or several points, x before y.
template <class Rows>
void move(Rows& rows, const Eigen::Vector2d& displacement_mm) {
    for (Eigen::Index column = 0; column + 1 < rows.cols(); column += 2) {
        rows.col(column).array() += displacement_mm.x();
        rows.col(column + 1).array() += displacement_mm.y();
    }
}

inline void move(Rings& rings, const Eigen::Vector2d& displacement_mm) {
    for (Ring& ring : rings) move(ring, displacement_mm);
}

}  // namespace brushsvg
