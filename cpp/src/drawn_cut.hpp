#pragma once

#include <optional>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/stroke.hpp"

namespace brushsvg {

/// An end of a path: its place, the direction there out of the stroke and to the left of it, half the width.
struct PathEnd {
    Eigen::Vector2d at_mm, along, left;
    double half_mm;
    Eigen::Vector2d place(double ahead_mm, double aside_mm) const { return at_mm + ahead_mm * along + aside_mm * left; }
};

/// A straight cut across an end: ahead of the path's end by `ahead_mm - slope * aside`.
struct Cut {
    double ahead_mm, slope;
};

/// The stroke as wide as the brush can paint it.
Stroke as_wide_as_painted(const Stroke& stroke, const Brush& brush);

/// The drawn outline's cut across an end, looked at so far to both sides; of a path with a width alone, half a width
/// beyond its end. None where the drawn end is no straight cut.
std::optional<Cut> cut_of(const Stroke& stroke, const PathEnd& end, double aside_mm);

/// Half the width of the mark that runs along a cut, none where the brush is too coarse for one.
std::optional<double> half_along_cut_mm(const Brush& brush, double half_mm);

/// How far ahead of its end the path is left for a cut, or before it: less than 0.
double leaves_ahead_mm(const Cut& cut, const PathEnd& end);

/// Corners of the way of such a mark from there on: beside the edge, into the corner that lies farther ahead, where
/// that is blunt as a chamfer, which a lever follows, along the cut, and into the other corner.
std::vector<Eigen::Vector2d> way_along(const Cut& cut, const PathEnd& end, double narrow_mm, double lever_mm);

/// The path between two places on it, the first before the second.
Cubics part_of(const Cubics& middle_mm, const Place& from, const Place& to);

/// Goes on straight to a place.
void append(Cubics& middle_mm, const Eigen::Vector2d& to_mm);

}  // namespace brushsvg
