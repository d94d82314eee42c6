#pragma once

#include <array>
#include <optional>

#include "brushsvg/mark_overlap.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// The place where paint and drawing differ most.
struct WorstPlace {
    std::array<double, 2> at_mm;  ///< middle of the square (x, y), paper frame
    bool is_missing;              ///< true if paint is missing there, false if there is too much
    double area_mm2;              ///< area of missing or excess paint in the square
};

/// A score of how well a pass paints its stroke.
struct StrokeScore {
    double overlap;  ///< area of the intersection over area of the union
    /// Mean absolute difference of the widths across the middle line; none: not measurable.
    ///
    /// Places where the target mark is not as wide as the line says do not show the brush's width and are left out.
    /// Examples are its ends, and crossings with itself.
    std::optional<double> width_error_mm;
    double excess_turning;  ///< of the mark's outline beyond the target's [full turns], see excess_turning()
    WorstPlace worst;       ///< in a square half as wide as the stroke, at least 0.5 mm
};

/// Score how well a pass paints a stroke.
StrokeScore stroke_score(const PassMarks& painted, const Stroke& target, const Brush& brush);

/// Find the place where paint and drawing differ most, in a square of a size [mm].
WorstPlace worst_place(const MarkOverlap& seen, double size_mm);
/// Return the mean absolute difference of the widths [mm] of mark and target.
///
/// `line`: the flattened middle line.
std::optional<double> width_error_mm(const MarkOverlap& seen, const MiddlePolyline& line);

/// Return the width [mm] of a mark in pixels, across a line.
///
/// `at_mm`: a point on the line (x, y). `direction`: of the line there. The width is of the piece that contains the
/// point, or of the nearest piece that begins within `reach_mm`; 0 if there is none.
double width_across(const Coverage& shares, const MarkOverlap& seen, const Eigen::Vector2d& at_mm,
                    const Eigen::Vector2d& direction, double reach_mm);

}  // namespace brushsvg
