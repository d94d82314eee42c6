#pragma once

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Union of shapes: each counter-clockwise ring fills, the clockwise rings behind it are its holes. Coordinates are
/// kept to 1e-5 mm. Rings may touch and cross; the result's do not cross. Throws Error where clockwise rings outweigh.
Rings unite(const Rings& rings);

/// What two shapes have in common, each given as for unite.
Rings intersect(const Rings& a, const Rings& b);

/// How often an outline must run round a point for it to be inside.
enum class FillRule { nonzero, evenodd };

/// The shape that closed outlines fill, as rings that do not cross: outlines may cross themselves and each other, turn
/// either way and overlap. Coordinates are kept to 1e-5 mm.
Rings fill(const Rings& outlines, FillRule rule);

/// Area [mm^2], clockwise rings, which are holes, taken off: negative where they outweigh.
double area(const Rings& rings);

/// Area of the intersection over area of the union, each given as for unite; 1 when both are empty.
double overlap(const Rings& a, const Rings& b);

/// Convex pieces whose union is that of the hulls of every two neighbours in a chain of convex counter-clockwise rings:
/// the hulls without the corners in the pieces next to them. One ring is its own piece.
Rings pieces_between(const Rings& chain);

/// Convex hull of points, counter-clockwise.
Ring convex_hull(const Ring& points);

/// Distance [mm] of each point from the outline, on whichever side of it.
std::vector<double> clearance(const Rings& rings, const Ring& points);

/// How far ahead [mm] of each place, along the unit vector in its row of ways, an outline is first crossed; infinite
/// where none is. Error where there are not as many ways as places.
std::vector<double> first_crossings(const Rings& rings, const Ring& places, const Ring& ways);

}  // namespace brushsvg
