#pragma once

#include <vector>

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// The outline of the contact patch, measured at one depth.
///
/// It is unclosed and counter-clockwise. Its first vertex is the tip at (0, 0), and the x axis points towards the TCP.
struct Footprint {
    double depth_mm;
    Ring outline_mm;
};

/// All outlines of a brush. They have equal vertex counts, and the depths ascend.
///
/// `dragged`: while the brush is drawn along. `pressed`: pressed straight down; if empty, equal to `dragged`.
struct FootprintTable {
    std::vector<Footprint> dragged;
    std::vector<Footprint> pressed;

    Eigen::Index vertex_count() const { return dragged.empty() ? 0 : dragged.front().outline_mm.rows(); }
};

/// Return the outline at a depth [mm], in the footprint's own frame:
///     (1 - pull) pressed(d) + pull dragged(d)
/// The tip is at the origin. `pull`: r'/r, 1 when taut.
///
/// Both outlines are blended vertex by vertex between measured depths. Below the least depth, the outline is scaled by
/// depth/least. Beyond the greatest depth, the last outline is used.
Ring footprint_at(const FootprintTable& table, double depth_mm, double pull);

/// The widest section of an outline: its distance from the tip, and half of its width.
struct WidestSection {
    double from_tip_mm;
    double half_width_mm;
};
WidestSection widest_section(const Ring& outline_mm);

/// Return whether every turn of the outline is to the left, within rounding.
bool is_convex(const Ring& outline_mm);

}  // namespace brushsvg
