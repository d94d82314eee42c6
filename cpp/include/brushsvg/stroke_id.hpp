#pragma once

#include <string>
#include <utility>

namespace [[gnu::visibility("default")]] brushsvg {

/// The origin of a stroke in a drawing.
///
/// The fields show which strokes belong together. The name is made of them for people only and is never parsed, because
/// an element may itself be called "icon/1".
struct StrokeId {
    std::string element;  ///< unique id of the element; in a plan that was read, the whole name
    int part = 0;         ///< number of the element's sub-path, from 1; 0: the only one
    int repeat = 1;       ///< number of the repetition (setting `passes`), from 1
    int lane = 1;         ///< number of the pass within a shape wider than the brush, or between sharp corners, from 1
    int load = 1;         ///< number of the load of paint within a long stroke, from 1

    StrokeId() = default;
    StrokeId(std::string element, int part = 0, int repeat = 1, int lane = 1, int load = 1)
        : element(std::move(element)), part(part), repeat(repeat), lane(lane), load(load) {}
    StrokeId(const char* element) : element(element) {}

    /// Return the name of the stroke.
    ///
    /// It is element, element/2 (part), element#2 (repeat), element~2 (lane) or element+2 (load), or a combination.
    std::string name() const;
    operator std::string() const { return name(); }  // errors, warnings and marks use the name
};

}  // namespace brushsvg
