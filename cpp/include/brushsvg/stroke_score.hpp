#pragma once

#include <array>
#include <optional>

#include "brushsvg/mark_overlap.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Where paint and drawing differ most: a square's middle [mm], whether paint is missing there (else there is too
/// much), and how much of it [mm^2].
struct WorstPlace {
    std::array<double, 2> at_mm;
    bool is_missing;
    double area_mm2;
};

/// How well a pass paints its stroke.
struct StrokeScore {
    double overlap;
    /// Mean absolute difference of both marks' widths across the middle line. Places where the target mark is not as
    /// wide as the line says (its ends, where it crosses or touches itself) do not show the brush's width and are
    /// left out; nothing left: none.
    std::optional<double> width_error_mm;
    double excess_turning;  ///< of the mark's outline beyond the target's [full turns], see excess_turning()
    WorstPlace worst;       ///< in a square half as wide as the stroke, at least 0.5 mm
};

StrokeScore stroke_score(const PassMarks& painted, const Stroke& wanted, const Brush& brush);

/// The parts of it. `line`: the middle line, flattened.
WorstPlace worst_place(const MarkOverlap& seen, double size_mm);
std::optional<double> width_error_mm(const MarkOverlap& seen, const MiddlePolyline& line);

/// Width [mm] of what pixels show across a line with that direction: of the piece that holds the point, else of the
/// nearest one that begins within `reach_mm` of it, else 0.
double width_across(const Coverage& shares, const MarkOverlap& seen, const Eigen::Vector2d& at_mm,
                    const Eigen::Vector2d& direction, double reach_mm);

}  // namespace brushsvg
