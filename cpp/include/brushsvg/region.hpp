#pragma once

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Return the union of shapes.
///
/// `rings`: each counter-clockwise ring is a filled shape; the clockwise rings after it are its holes. Rings may touch
/// and cross; the rings of the result do not cross. Coordinates are rounded to 1e-5 mm, or to 4e-5 mm where edges are
/// so near to each other that rounding would lose area.
///
/// Throws Error if the total area is negative, or if the rings nearly coincide and cannot be united.
Rings unite(const Rings& rings);

/// Return the intersection of two shapes, each given as for unite().
Rings intersect(const Rings& a, const Rings& b);

/// The rule that decides from an outline's winding number whether a point is inside.
enum class FillRule { nonzero, evenodd };

/// Return the shape that closed outlines fill, as rings that do not cross.
///
/// The outlines may cross themselves and each other, turn either way, and overlap. Coordinates are rounded as by
/// unite(). Throws Error if outlines nearly coincide and cannot be combined, or wind too many times around a point.
Rings fill(const Rings& outlines, FillRule rule);

/// Return the area [mm^2] of the counter-clockwise rings minus the area of the clockwise rings, which are holes.
///
/// The area is negative if the holes are larger.
double area(const Rings& rings);

/// Return the overlap of two shapes, each given as for unite():
///     area(A and B) / area(A or B)
/// It is 1 if both are empty.
double overlap(const Rings& a, const Rings& b);

/// Return convex pieces that cover the hulls of neighbouring rings in a chain.
///
/// `chain`: convex counter-clockwise rings. The union of the pieces is the union of the hulls of every two neighbours.
/// A piece is a hull without the corners that are in the pieces next to it. A single ring is its own piece.
Rings pieces_between(const Rings& chain);

/// Return the convex hull of points, counter-clockwise.
Ring convex_hull(const Ring& points);

/// Return the distance [mm] of each point from the nearest outline, positive inside and outside.
///
/// Throws Error for a coordinate that is not finite.
std::vector<double> clearance(const Rings& rings, const Ring& points);

/// Return the distance [mm] from each place to the first crossing with an outline, along a ray.
///
/// `places`: (n, 2), the start of each ray [mm]. `directions`: (n, 2), the unit vector of each ray. The distance is
/// infinite if the ray crosses no outline. Throws Error if there are not as many directions as places, and for a
/// coordinate that is not finite.
std::vector<double> first_crossings(const Rings& rings, const Ring& places, const Ring& directions);

}  // namespace brushsvg
