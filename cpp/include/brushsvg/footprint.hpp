#pragma once

#include <vector>

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Contact patch outline measured at one depth: unclosed, counter-clockwise, first vertex the tip at (0, 0),
/// axis +x towards the TCP.
struct Footprint {
    double depth_mm;
    Ring outline_mm;
};

/// All outlines of a brush. Every outline has the same vertex count; depths ascend. `pressed` (straight down)
/// may be empty: then it equals `dragged`.
struct FootprintTable {
    std::vector<Footprint> dragged;
    std::vector<Footprint> pressed;

    Eigen::Index vertex_count() const { return dragged.empty() ? 0 : dragged.front().outline_mm.rows(); }
};

/// Outline at a depth [mm] in the footprint's own frame (tip at the origin):
///     (1 - pull) pressed(d) + pull dragged(d),  pull = r'/r (1 when taut),
/// each blended vertex by vertex between measured depths; below the least depth scaled by depth/least, above
/// the greatest the last one.
Ring footprint_at(const FootprintTable& table, double depth_mm, double pull);

/// Distance from the tip to the widest section and half of the greatest width [mm] of an outline.
struct WidestSection {
    double from_tip_mm;
    double half_width_mm;
};
WidestSection widest_section(const Ring& outline_mm);

/// True when every turn of the outline is to the left within rounding.
bool is_convex(const Ring& outline_mm);

}  // namespace brushsvg
