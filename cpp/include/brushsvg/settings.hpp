#pragma once

#include <optional>
#include <string>

namespace [[gnu::visibility("default")]] brushsvg {

/// What a drawing says of an element to brushsvg itself (docs/reference/drawings.md), carried from there to the plan.
/// What it does not say is empty.
struct Settings {
    std::optional<std::string> brush;
    std::optional<std::string> end;   ///< of the stroke: pointed, round, butt, auto
    std::optional<std::string> kind;  ///< of a stroke of the calibration chart
    std::optional<int> order;
    std::optional<int> passes;  ///< how often it is painted
    std::optional<bool> reload;
    std::optional<bool> skip;
    std::optional<double> speed_mm_s;
    std::optional<std::string> start;  ///< of the stroke: the same
    std::optional<double> width_mm;
    std::string extra = "{}";  ///< JSON object of unknown keys, written back as read
};

/// each(key, value) of all known keys, in the order of the alphabet, in which they are written.
template <class OneSettings, class Each>
void each_setting(OneSettings& settings, Each&& each) {
    each("brush", settings.brush);
    each("end", settings.end);
    each("kind", settings.kind);
    each("order", settings.order);
    each("passes", settings.passes);
    each("reload", settings.reload);
    each("skip", settings.skip);
    each("speed_mm_s", settings.speed_mm_s);
    each("start", settings.start);
    each("width_mm", settings.width_mm);
}

}  // namespace brushsvg
