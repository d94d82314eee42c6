#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "brushsvg/settings.hpp"
#include "brushsvg/stroke_id.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// TCP poses, one per row: x, y, z [mm] in the paper frame; z = -depth while painting.
using Poses = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// No table is larger: a coordinate beyond it is damage, and squares of it still add up.
inline constexpr double kLargestMm = 1e6;

/// Poses `first` to `last` are on a circle about a centre, at constant depth, and are passed in this direction.
struct Arc {
    std::int64_t first = 0, last = 0;  ///< indexes of poses
    Eigen::Vector2d centre_mm{0.0, 0.0};
    int direction = 1;  ///< 1 counter-clockwise, -1 clockwise
};

/// A radius outside this range is refused: below, the arc vanishes in the brush's smallest mark and the rounding of
/// its poses; above, centre and poses together hold too few digits.
inline constexpr std::array<double, 2> kArcRadiusMm{0.1, kLargestMm};

/// How far the poses of an arc may be from one circle: poses and centre rounded to three decimals add up to 0.0028 mm.
/// The arc between two poses runs through both, so nothing jumps; much more would hide a wrong centre.
inline constexpr double kOnCircleMm = 3e-3;

/// How far from upright a brush may be tilted: what its laws say of a brush on its side has never been measured,
/// and at 30 degrees a section of it is 15 % longer already.
inline constexpr double kMostTiltDeg = 30.0;

/// How far from 1 the length of a tool axis may be: coordinates rounded to three decimals add up to 0.0009.
inline constexpr double kUnitLength = 1e-3;

/// By how much they may tilt an axis of 30 degrees further: 0.05 degrees.
inline constexpr double kRoundedTiltDeg = 0.05;

/// One stroke's motion: straight moves between poses, depth linear along each.
struct Pass {
    StrokeId stroke;  ///< the stroke it paints
    Poses poses_mm;
    std::vector<Arc> arcs;  ///< ascending; poses of one are followed on its circle in place of its chords
    double speed_mm_s = 20.0;
    std::string layer;
    std::string colour;
    Settings settings;
    int load = 0;              ///< which of its stroke's loads of paint it is, from 1; 0 for a stroke that is whole
    std::string extra = "{}";  ///< JSON object of unknown keys, written back as read
    Poses tool_axes;           ///< of each pose the unit vector from the tip up along the brush; empty: upright
};

struct Plan {
    std::string brush;
    std::string brush_sha256;
    std::array<double, 2> sheet_mm{0.0, 0.0};
    std::vector<Pass> passes;
    std::string extra = "{}";
};

/// Throws Error for a sheet that none can be: both sides are greater than 0 and at most 1e6 mm. A plan that is only
/// simulated needs none.
void check_sheet(const std::array<double, 2>& sheet_mm);

/// By how much the TCP turns about an arc's centre from one pose on it to the next [rad], signed, in (-pi, pi].
double turn_between(const Arc& arc, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm);

/// Throws Error, with this `where`, when arc k of the pass names poses that do not exist, comes before its
/// predecessor's end, or when its poses are not on one circle, not at one depth, or do not go round it in the direction
/// said, each by less than half a turn.
void check_arc(const Pass& pass, std::size_t k, const std::string& where);

/// Throws Error, with this `where`, when a pass has tool axes and not one for each pose, or arcs with them, or when
/// one is not of length 1 or is tilted by more than 30 degrees.
void check_tool_axes(const Pass& pass, const std::string& where);

/// Whether the brush is not upright at every pose.
bool is_tilted(const Pass& pass);

/// Throws Error for a tilted pass, where nothing is known of one: a pass that lost its tilt would paint something else.
/// `upright`: who keeps the brush upright, as the sentence begins.
void refuse_tilted(const Pass& pass, const std::string& upright);

}  // namespace brushsvg
