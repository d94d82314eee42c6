#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"
#include "brushsvg/stroke.hpp"
#include "brushsvg/tracking_error.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// How the TCP is offset from the stroke's middle line.
///
/// q is the TCP, m the middle line, T its unit tangent, and u the heading. r is the lag at the depth there, r0 a
/// constant lag. e is the distance from the contact to the widest section.
enum class Compensation {
    none,      ///< the TCP is on the middle line; the brush is pressed and lifted on the spot
    constant,  ///< q = m + r0 T, the constant offset of other tools, with a landing along the stroke
    closed     ///< q = m + (r - e) u, the inverse of the article's model
};

/// The shape of a stroke's start or end, in closed form. A stroke's settings `start` and `end` use the same words.
enum class Terminal {
    pointed,  ///< a start has the shape of the footprint's rear; an end narrows to the mirrored shape
    round,    ///< has the shape of the footprint's front, or is painted by a turn in place if that is rounder. At a
              ///< start, the brush is pressed down inside the stroke, moves back to its beginning and turns over there
    butt,     ///< straight or slanted: a narrower mark goes into one corner, along the cut, and into the other corner
    automatic,  ///< the terminal whose mark is most similar to the drawn end, or a simpler one if the difference is
                ///< hardly visible
};
/// The words for terminals in settings, files and the command line.
inline constexpr std::array<std::pair<std::string_view, Terminal>, 4> kTerminalNames{{{"pointed", Terminal::pointed},
                                                                                      {"round", Terminal::round},
                                                                                      {"butt", Terminal::butt},
                                                                                      {"auto", Terminal::automatic}}};
/// Return the terminal that a word names. Throws Error for an unknown word.
///
/// `where`: the element that the error names.
Terminal parse_terminal(const std::string& name, const std::string& where);

/// Options of compensate().
struct CompensateOptions {
    Compensation method = Compensation::closed;
    double tolerance_mm = 0.05;    ///< largest distance of the widest point from the middle line, also between poses
    std::optional<double> lag_mm;  ///< constant only; default: the lag at the stroke's median depth
    double speed_mm_s = 20.0;      ///< painting speed; the brush's own limit caps it
    bool few_poses = true;         ///< closed only: use no more poses than the tolerance needs, see simplify_pass.hpp
    /// Closed only: the terminals of strokes that do not set their own. If a stroke has no cut there or is too short, a
    /// butt terminal becomes round. If it is too short, a round start becomes pointed and a pointed end round.
    Terminal start = Terminal::pointed, end = Terminal::round;
};

/// The result of compensate(): the motion, its tracking error, and warnings.
struct CompensatedPass {
    Pass pass;
    TrackingError tracking_error;
    std::vector<Warning> warnings;
};

/// Compute the motion of the TCP that paints a stroke: the inverse of the brush model.
///
/// With it, the widest section of the footprint runs along the stroke's middle line. The pass is simulated before it is
/// returned, and its tracking error is part of the result. Throws Error, naming the stroke, for widths that the brush
/// cannot paint.
CompensatedPass compensate(const Stroke& stroke, const Brush& brush, const CompensateOptions& options = {});

}  // namespace brushsvg
