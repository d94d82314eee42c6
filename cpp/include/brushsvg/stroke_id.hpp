#pragma once

#include <string>
#include <utility>

namespace [[gnu::visibility("default")]] brushsvg {

/// Where in a drawing a stroke comes from. These fields show what belongs together; the name is made of them for
/// people and never taken apart again: an element may be called "icon/1".
struct StrokeId {
    std::string element;  ///< the element's id, as no other element is called; in a plan that was read the whole name
    int part = 0;         ///< which of the element's sub-paths, from 1; 0: it has only one
    int repeat = 1;       ///< which of the times that it is painted (the setting passes)
    int lane = 1;         ///< which of the passes that fill a shape wider than the brush, or are between sharp corners
    int load = 1;         ///< which of the loads of paint that a long stroke takes

    StrokeId() = default;
    StrokeId(std::string element, int part = 0, int repeat = 1, int lane = 1, int load = 1)
        : element(std::move(element)), part(part), repeat(repeat), lane(lane), load(load) {}
    StrokeId(const char* element) : element(element) {}

    /// element, element/2, element#2 (repeat), element~2 (lane), element+2 (load).
    std::string name() const;
    operator std::string() const { return name(); }  // refusals, warnings and marks speak of strokes by their names
};

}  // namespace brushsvg
