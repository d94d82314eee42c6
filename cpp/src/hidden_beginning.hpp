#pragma once

#include <array>
#include <optional>
#include <utility>

#include "inverse_lag.hpp"

namespace brushsvg {

/// A hidden beginning: the brush is set down heading back along the line, and drawn back until the round front of its
/// footprint reaches the drawn beginning. There it turns over, and P rests, so it goes on where the widest section is
/// as far in front of P as it was behind.
struct HiddenBeginning {
    Samples back;
    Stroke onward;             ///< the stroke whose mark begins as narrow as the front hides it
    double on_from_mm;         ///< arc length where the widest section goes on
    Eigen::Vector2d on_along;  ///< and the heading there
};

/// The arc length from which on the rear of a footprint as wide as the stroke lies behind `from_mm`, and the stroke
/// narrowed up to there so that narrower ones do too. None where no depth does.
std::optional<std::pair<double, Stroke>> narrowed(const Stroke& stroke, const Brush& brush, double length_mm,
                                                  double from_mm);

/// The way back of the widest section from one arc length to another, in as few steps as the tolerance asks for: nobody
/// thins them out. Before the line's beginning, less than 0, it goes on straight. None where the widest section trails.
std::optional<Samples> way_back(const Brush& brush, const Line& line, const InverseLag& inverse, double from_mm,
                                double to_mm, double step_tolerance);

/// Arc length within bounds where the widest section lies as far from P as its lever, and the brush may go on from
/// there. None where that is nowhere.
std::optional<double> goes_on_mm(const Stroke& onward, const Brush& brush, const Line& line,
                                 const Eigen::Vector2d& contact_mm, const std::array<double, 2>& within_mm);

/// None where the brush cannot hide: too thin a mark, whose widest section trails P, or too short a stroke.
std::optional<HiddenBeginning> hidden_beginning(const Stroke& stroke, const Brush& brush, const Line& line,
                                                const InverseLag& inverse, double last_mm, double step_tolerance);

}  // namespace brushsvg
