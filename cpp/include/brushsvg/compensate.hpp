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

/// How a stroke begins, in closed form. A stroke's own setting `start` says it by the same words.
enum class Beginning {
    exposed,  ///< pointed, as a footprint is behind
    hidden,   ///< set down inside of the stroke, back to its beginning, turned over: round, as a footprint is in front
              ///< (a dot: turned round on the spot)
    squared,  ///< on its way back a narrower mark goes into one corner, along the cut into the other, and turns there
    turned,   ///< turned round on the spot like a dot, then on along the line; `hidden` and `auto` take it, none asks
              ///< for it
    automatic,  ///< hidden, turned or squared, where the mark lies better on the wanted one there for it, by more than
                ///< can hardly be seen
};
inline constexpr std::array<std::pair<std::string_view, Beginning>, 4> kBeginnings{{{"exposed", Beginning::exposed},
                                                                                    {"hidden", Beginning::hidden},
                                                                                    {"squared", Beginning::squared},
                                                                                    {"auto", Beginning::automatic}}};
/// Error for another word.
Beginning beginning_named(const std::string& name, const std::string& where);

/// How a stroke ends, in closed form. A stroke's own setting `end` says it by the same words.
enum class Ending {
    lifted,     ///< while the patch rests: as the footprint is in front
    squared,    ///< a narrower mark goes on into one corner, along the cut and back into the other: straight or slanted
    automatic,  ///< squared where the mark lies better on the wanted one there for it, by more than can hardly be seen
};
inline constexpr std::array<std::pair<std::string_view, Ending>, 3> kEndings{
    {{"lifted", Ending::lifted}, {"squared", Ending::squared}, {"auto", Ending::automatic}}};
/// Error for another word.
Ending ending_named(const std::string& name, const std::string& where);

struct CompensateOptions {
    Compensation method = Compensation::closed;
    double tolerance_mm = 0.05;            ///< of the widest point from the middle line, between poses too
    std::optional<double> lag_mm;          ///< constant only; default the lag at the stroke's median depth
    double speed_mm_s = 20.0;              ///< capped by the brush's own limit
    bool few_poses = true;                 ///< closed only: no more than the tolerance asks for, see thin_out.hpp
    Beginning start = Beginning::exposed;  ///< closed only; where there is no cut or room it is hidden, else exposed
    Ending end = Ending::lifted;           ///< closed only; where there is no cut, or no room, it is lifted
};

struct CompensatedPass {
    Pass pass;
    TrackingError miss;
    std::vector<Warning> warnings;
};

/// Inverse: where the TCP must go so that the widest section runs along the stroke's middle line.
/// Throws Error for widths the brush cannot paint.
CompensatedPass compensate(const Stroke& stroke, const Brush& brush, const CompensateOptions& options = {});

}  // namespace brushsvg
