#pragma once

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Return the union of shapes.
///
/// `rings`: each counter-clockwise ring is a filled shape; the clockwise rings after it are its holes. Rings may touch
/// and cross; the rings of the result do not cross. Coordinates are rounded to 1e-5 mm, or to 4e-5 mm where edges are
/// so near to each other that rounding would lose area.
///
/// Throws Error if the area of the clockwise rings outweighs the area of the others, or if the rings nearly coincide
/// and cannot be united.
Rings unite(const Rings& rings);

/// Return the intersection of two shapes, each given as for unite().
Rings intersect(const Rings& a, const Rings& b);

/// The rule that decides from an outline's winding number whether a point is inside.
enum class FillRule { nonzero, evenodd };

/// Return the shape that closed outlines fill, as rings that do not cross.
///
/// The outlines may cross themselves and each other, turn either way, and overlap. Coordinates are rounded as by
/// unite(). Throws Error if outlines nearly coincide and cannot be combined, or run too often round a point.
Rings fill(const Rings& outlines, FillRule rule);

/// Return the area [mm^2] of rings, less the area of the clockwise rings.
///
/// Clockwise rings are holes. The area is negative if they outweigh the others.
double area(const Rings& rings);

/// Return the area of the intersection over the area of the union.
///
/// Each shape is given as for unite(). 1 if both are empty.
double overlap(const Rings& a, const Rings& b);

/// Return convex pieces that cover the hulls of neighbouring rings in a chain.
///
/// `chain`: convex counter-clockwise rings. The union of the pieces is the union of the hulls of every two neighbours.
/// A piece is a hull without the corners that are in the pieces next to it. A single ring is its own piece.
Rings pieces_between(const Rings& chain);

/// Return the convex hull of points, counter-clockwise.
Ring convex_hull(const Ring& points);

/// Return the distance [mm] of each point from the outline, on either side of it.
///
/// Throws Error for a coordinate that is not finite.
std::vector<double> clearance(const Rings& rings, const Ring& points);

/// Return how far ahead of each place an outline is first crossed [mm].
///
/// `ways`: the unit direction in which to look, for each place. Infinite if no outline is crossed. Throws Error if
/// there are not as many directions as places, and for a coordinate that is not finite.
std::vector<double> first_crossings(const Rings& rings, const Ring& places, const Ring& ways);

}  // namespace brushsvg
