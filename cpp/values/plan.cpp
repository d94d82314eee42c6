#include "brushsvg/plan.hpp"

#include <algorithm>
#include <cmath>

#include "base/format_text.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

using Eigen::Vector2d;

/// Files are rounded to 1e-7 mm. Depths that differ by more than this limit are different.
constexpr double kMaxArcDepthDifferenceMm = 1e-6;
/// For a turn this close to half a turn, the direction of the chord does not show on which side the arc is.
constexpr double kHalfTurnMarginRad = 1e-6;

constexpr double kPi = 3.14159265358979323846;

constexpr double kMaxSheetSideMm = 1e6;  // same limit as for files and strokes

double tilt_deg(const Eigen::RowVector3d& axis) { return std::atan2(axis.head<2>().norm(), axis.z()) * 180.0 / kPi; }

}  // namespace

void check_sheet(const std::array<double, 2>& sheet_mm) {
    for (const double side_mm : sheet_mm) {
        if (side_mm > 0.0 && side_mm <= kMaxSheetSideMm) continue;
        throw Error("out-of-range",
                    format_text("both sides of the sheet must be within (0, 1e6] mm, not %g mm", side_mm), "sheet_mm",
                    side_mm, std::array<double, 2>{0.0, kMaxSheetSideMm});
    }
}

double turn_between(const Arc& arc, const Vector2d& from_mm, const Vector2d& to_mm) {
    const Vector2d a = from_mm - arc.centre_mm, b = to_mm - arc.centre_mm;
    return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

void check_arc(const Pass& pass, std::size_t k, const std::string& where) {
    const Arc& arc = pass.arcs[k];
    const auto refuse = [&](const std::string& fault, auto... value_and_range) {
        throw Error("arc-invalid", "arc " + std::to_string(k) + " of stroke " + pass.stroke.name() + " " + fault, where,
                    value_and_range...);
    };
    const long long first = arc.first, last = arc.last, poses = pass.poses_mm.rows();
    if (first < 0 || last >= poses)
        refuse(format_text("goes from pose %lld to pose %lld, but the stroke has poses 0 to %lld", first, last,
                           poses - 1));
    if (first >= last)
        refuse(format_text("goes from pose %lld to pose %lld, but must end at a later pose", first, last));
    if (k > 0 && first < pass.arcs[k - 1].last)
        refuse(format_text("begins at pose %lld, but the arc before it ends at pose %lld", first,
                           static_cast<long long>(pass.arcs[k - 1].last)));
    if (arc.direction != 1 && arc.direction != -1)
        refuse(
            format_text("has the direction %d, but must have 1 (counter-clockwise) or -1 (clockwise)", arc.direction));
    const auto pose = [&](Eigen::Index i) -> Vector2d { return pass.poses_mm.row(i).head<2>().transpose(); };
    const double radius_mm = (pose(first) - arc.centre_mm).norm();
    if (!(radius_mm >= kArcRadiusRangeMm[0] && radius_mm <= kArcRadiusRangeMm[1]))
        refuse(format_text("has a radius of %.6g mm, outside the range [%g, %g] mm", radius_mm, kArcRadiusRangeMm[0],
                           kArcRadiusRangeMm[1]),
               radius_mm, kArcRadiusRangeMm);
    for (Eigen::Index i = first + 1; i <= last; ++i) {
        const long long at = i;
        const double off_mm = (pose(i) - arc.centre_mm).norm() - radius_mm;
        if (!(std::abs(off_mm) <= kMaxCircleErrorMm))
            refuse(
                format_text("has pose %lld at %.6g mm from its circle of radius %.6g mm, outside the range [%g, %g] mm",
                            at, off_mm, radius_mm, -kMaxCircleErrorMm, kMaxCircleErrorMm),
                off_mm, std::array<double, 2>{-kMaxCircleErrorMm, kMaxCircleErrorMm});
        const double rise_mm = pass.poses_mm(i, 2) - pass.poses_mm(first, 2);
        if (!(std::abs(rise_mm) <= kMaxArcDepthDifferenceMm))
            refuse(format_text("has z = %.6g mm at pose %lld but %.6g mm at pose %lld: give all its poses one depth",
                               pass.poses_mm(first, 2), first, pass.poses_mm(i, 2), at),
                   rise_mm);
        const double turn_rad = arc.direction * turn_between(arc, pose(i - 1), pose(i));
        if (!(turn_rad > 0.0) || turn_rad > std::acos(-1.0) - kHalfTurnMarginRad)
            refuse(format_text("must go %s from pose %lld to pose %lld, by less than 180 degrees",
                               arc.direction > 0 ? "counter-clockwise" : "clockwise", at - 1, at));
    }
}

void check_tool_axes(const Pass& pass, const std::string& where) {
    const Poses& axes = pass.tool_axes;
    if (axes.rows() == 0) return;
    const std::string stroke = "stroke " + pass.stroke.name();
    if (axes.rows() != pass.poses_mm.rows())
        throw Error("sizes-differ",
                    "tool_axes of " + stroke + " has " + std::to_string(axes.rows()) + " rows, but poses_mm has " +
                        std::to_string(pass.poses_mm.rows()) + ": give one axis for each pose",
                    where);
    if (!pass.arcs.empty())
        throw Error("arc-invalid", stroke + " has tool_axes and arcs: replace the arcs by straight moves", where);
    for (Eigen::Index i = 0; i < axes.rows(); ++i) {
        const std::string row = "row " + std::to_string(i) + " of tool_axes of " + stroke;
        const double length = axes.row(i).norm();
        if (!(std::abs(length - 1.0) <= kMaxUnitLengthError))
            throw Error("tool-axis-invalid",
                        row + format_text(" has length %.6g, outside the range [%g, %g]", length,
                                          1.0 - kMaxUnitLengthError, 1.0 + kMaxUnitLengthError),
                        where, length, std::array<double, 2>{1.0 - kMaxUnitLengthError, 1.0 + kMaxUnitLengthError});
        const double tilt = tilt_deg(axes.row(i));
        if (!(tilt <= kMaxTiltDeg + kTiltRoundingDeg))
            throw Error("tool-axis-invalid",
                        row + format_text(" is tilted by %.4g degrees, outside the range [0, %g] degrees from upright",
                                          tilt, kMaxTiltDeg),
                        where, tilt, std::array<double, 2>{0.0, kMaxTiltDeg});
    }
}

bool is_tilted(const Pass& pass) {
    return pass.tool_axes.rows() > 0 &&
           !(pass.tool_axes.leftCols<2>().cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 0.0);
}

void refuse_tilted(const Pass& pass, const std::string& upright) {
    if (!is_tilted(pass)) return;
    double most = 0.0;
    for (const auto& axis : pass.tool_axes.rowwise()) most = std::max(most, tilt_deg(axis));
    throw Error("tilt-unsupported", upright + format_text(", but this stroke tilts it by up to %.4g degrees", most),
                pass.stroke, most, std::array<double, 2>{0.0, 0.0});
}

}  // namespace brushsvg
