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

enum class Compensation {
    none,      ///< TCP on the middle line, pressed and lifted on the spot
    constant,  ///< q = m + r0 T, what other tools do, with a fair landing
    closed     ///< q = m + (r - e) u, the article's law read backwards
};

/// The shape of an end of a stroke, in closed form. A stroke's own settings `start` and `end` use the same words.
enum class Terminal {
    pointed,    ///< a start as a footprint is behind; an end narrows as far
    round,      ///< as a footprint is in front, or turned round on the spot where that is rounder. A start is set down
                ///< inside of the stroke, goes back to its beginning and turns over there
    butt,       ///< straight or slanted: a narrower mark goes into one corner, along the cut and into the other
    automatic,  ///< the one of them whose mark is most like the drawn end, a plainer one where hardly more can be seen
};
inline constexpr std::array<std::pair<std::string_view, Terminal>, 4> kTerminals{{{"pointed", Terminal::pointed},
                                                                                  {"round", Terminal::round},
                                                                                  {"butt", Terminal::butt},
                                                                                  {"auto", Terminal::automatic}}};
/// Error for another word.
Terminal terminal_named(const std::string& name, const std::string& where);

struct CompensateOptions {
    Compensation method = Compensation::closed;
    double tolerance_mm = 0.05;    ///< of the widest point from the middle line, between poses too
    std::optional<double> lag_mm;  ///< constant only; default the lag at the stroke's median depth
    double speed_mm_s = 20.0;      ///< capped by the brush's own limit
    bool few_poses = true;         ///< closed only: no more than the tolerance asks for, see thin_out.hpp
    /// Closed only. Where there is no cut or no room for a butt terminal it is round, and where there is none for a
    /// round start or a pointed end they are pointed and round.
    Terminal start = Terminal::pointed, end = Terminal::round;
};

struct CompensatedPass {
    Pass pass;
    TrackingError tracking_error;
    std::vector<Warning> warnings;
};

/// Inverse: where the TCP must go so that the widest section runs along the stroke's middle line.
/// Throws Error for widths the brush cannot paint.
CompensatedPass compensate(const Stroke& stroke, const Brush& brush, const CompensateOptions& options = {});

}  // namespace brushsvg
