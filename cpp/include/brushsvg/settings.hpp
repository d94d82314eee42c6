#pragma once

#include <optional>
#include <string>

namespace [[gnu::visibility("default")]] brushsvg {

/// The settings of an element in a drawing (docs/reference/drawings.md).
///
/// They are kept up to the plan. Settings that the drawing does not have are empty.
struct Settings {
    std::optional<std::string> brush;  ///< name of the brush that the drawing is for
    std::optional<std::string> end;    ///< terminal at the stroke's end: pointed, round, butt, auto
    std::optional<std::string> kind;   ///< kind of a stroke on the calibration chart
    std::optional<int> order;          ///< elements with smaller numbers are painted first
    std::optional<int> passes;         ///< how many times the element is painted
    std::optional<bool> reload;        ///< whether to fetch paint before the stroke; false: do not split the stroke
    std::optional<bool> skip;          ///< true: do not paint the element
    std::optional<double> speed_mm_s;  ///< painting speed
    std::optional<std::string> start;  ///< terminal at the stroke's start: pointed, round, butt, auto
    std::optional<double> width_mm;    ///< width of the mark
    std::string extra = "{}";          ///< JSON object of unknown keys, written back as read
};

/// Call each(key, value) for all known keys, in alphabetical order.
///
/// Files are written in this order.
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
