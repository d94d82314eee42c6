#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "brushsvg/settings.hpp"
#include "brushsvg/stroke_id.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// TCP poses in the paper frame, one per row: x, y, z [mm]. On the paper z = -depth.
using Poses = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Largest absolute coordinate [mm]. No table is larger, so a coordinate beyond this limit is an error. Its square can
/// still be summed.
inline constexpr double kMaxCoordinateMm = 1e6;

/// A stretch of a pass on a circle: the poses `first` to `last`, at constant depth.
struct Arc {
    std::int64_t first = 0, last = 0;  ///< indices of the first and the last pose
    Eigen::Vector2d centre_mm{0.0, 0.0};
    int direction = 1;  ///< 1 counter-clockwise, -1 clockwise
};

/// Smallest and largest radius of an arc [mm]. A smaller arc vanishes in the brush's finest mark and in the rounding of
/// its poses. For a larger one, the coordinates of centre and poses have too few digits.
inline constexpr std::array<double, 2> kArcRadiusRangeMm{0.1, kMaxCoordinateMm};

/// Largest distance of an arc's poses from one circle [mm]. Poses and a centre rounded to three decimals add up to
/// 0.0028 mm. The arc between two poses runs through both, so nothing jumps. A much larger limit would hide a wrong
/// centre.
inline constexpr double kMaxCircleErrorMm = 3e-3;

/// Largest tilt of a brush from upright [deg]. Its laws have never been measured for a strongly tilted brush. At 30
/// degrees its cross-section is already 15 % longer.
inline constexpr double kMaxTiltDeg = 30.0;

/// Largest deviation of a tool axis' length from 1. Coordinates rounded to three decimals add up to 0.0009.
inline constexpr double kMaxUnitLengthError = 1e-3;

/// Tolerance of kMaxTiltDeg [deg]. Rounded coordinates may tilt an axis of 30 degrees that much further.
inline constexpr double kTiltRoundingDeg = 0.05;

/// The motion for one stroke: straight moves, with the depth linear along each.
struct Pass {
    StrokeId stroke;  ///< the stroke that the pass paints
    Poses poses_mm;
    std::vector<Arc> arcs;  ///< ascending; the poses of an arc are followed on its circle, not on the chords
    double speed_mm_s = 20.0;
    std::string layer;
    std::string colour;
    Settings settings;
    int load = 0;              ///< number of the load of paint within the stroke, from 1; 0: the stroke is not split
    std::string extra = "{}";  ///< JSON object of unknown keys, written back as read
    Poses tool_axes;           ///< unit vector from the tip up along the brush, per pose, paper frame; empty: upright
};

/// The TCP poses of all strokes, in painting order. This is the content of plan.json.
struct Plan {
    std::string brush;                         ///< name of the brush that the plan was made for
    std::string brush_sha256;                  ///< of the brush's file
    std::array<double, 2> sheet_mm{0.0, 0.0};  ///< width and height; 0: no sheet
    std::vector<Pass> passes;
    std::string extra = "{}";
};

/// Throw Error unless both sides of the sheet are greater than 0 and at most 1e6 mm.
///
/// A plan that is only simulated needs no sheet.
void check_sheet(const std::array<double, 2>& sheet_mm);

/// Return the signed angle of the TCP about an arc's centre between two poses.
///
/// `from_mm`, `to_mm`: the positions of the poses. The angle [rad] is in (-pi, pi] and positive if the turn is
/// counter-clockwise.
double turn_between(const Arc& arc, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm);

/// Throw Error if arc `k` of the pass is not valid.
///
/// The arc must begin at an existing pose, not before the previous arc's end, and end at a later existing pose. Its
/// poses must be on one circle and at one depth. They must follow the circle in its direction, each step by less than
/// half a turn. `where`: the element that the error names.
void check_arc(const Pass& pass, std::size_t k, const std::string& where);

/// Throw Error if the tool axes of the pass are not valid.
///
/// A pass with tool axes needs one for each pose and must have no arcs. Each axis must have length 1 and be tilted by
/// at most 30 degrees. `where`: the element that the error names.
void check_tool_axes(const Pass& pass, const std::string& where);

/// Return whether the brush is tilted at any pose.
bool is_tilted(const Pass& pass);

/// Throw Error if the pass is tilted. For code that supports only an upright brush, because without its tilt the pass
/// would paint a different mark.
///
/// `upright`: the beginning of the error's sentence, which says what needs an upright brush.
void refuse_tilted(const Pass& pass, const std::string& upright);

}  // namespace brushsvg
