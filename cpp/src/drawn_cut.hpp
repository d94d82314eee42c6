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

/// A round cap: a circle, half of which is drawn.
struct Cap {
    Eigen::Vector2d middle_mm;
    double radius_mm;
};

/// A straight cut across an end: ahead of the path's end by `ahead_mm - slope * aside`.
struct Cut {
    double ahead_mm, slope;
};

/// How a path with a width alone ends: as strokes with round caps do, or cut straight, half a width beyond its end.
enum class Caps { round, straight };

/// The stroke as wide as the brush can paint it.
Stroke as_wide_as_painted(const Stroke& stroke, const Brush& brush);

/// The drawn outline's round cap at an end; of a path with a width alone, one as wide as that. None where the drawn end
/// is not round.
std::optional<Cap> cap_of(const Stroke& stroke, const PathEnd& end);

/// The drawn outline's cut across an end, looked at so far to both sides; of a path with a width alone, where its caps
/// are straight. None where the drawn end is not cut straight.
std::optional<Cut> cut_of(const Stroke& stroke, const PathEnd& end, double aside_mm, Caps caps);

/// Half the width of the mark that runs along a cut, none where the brush is too coarse for one.
std::optional<double> half_along_cut_mm(const Brush& brush, double half_mm);

/// How far ahead of its end the path is left for a cut, or before it: less than 0.
double leaves_ahead_mm(const Cut& cut, const PathEnd& end);

/// The way of such a mark from there on: beside the edge, into the corner that lies farther ahead, where that is blunt
/// as a chamfer, which a lever follows, along the cut, and into the other corner.
Cubics way_along(const Cut& cut, const PathEnd& end, const Eigen::Vector2d& from_mm, double narrow_mm, double lever_mm);

/// The path between two places on it, the first before the second.
Cubics part_of(const Cubics& middle_mm, const Place& from, const Place& to);

/// The same path, led from its end to its beginning.
Cubics reversed(const Cubics& middle_mm);

/// Goes on straight to a place.
void append(Cubics& middle_mm, const Eigen::Vector2d& to_mm);
void append_way(Cubics& middle_mm, const Cubics& more_mm);

}  // namespace brushsvg
