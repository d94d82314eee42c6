#include "brushsvg/objective.hpp"

#include <array>

#include "base/within.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg {

void check(const ObjectiveWeights& weights) {
    constexpr std::array<double, 2> any_weight{0.0, 1e6}, any_depth_mm{0.0, 1e3};
    require_within(weights.missing, any_weight, "the weight of missing paint", "missing");
    require_within(weights.spill, any_weight, "the weight of paint outside", "spill");
    require_within(weights.seen_mm, any_depth_mm, "the depth in mm from which an area is seen", "seen_mm");
    require_within(weights.notch, any_weight, "the weight of a notch", "notch");
    require_within(weights.bulge, any_weight, "the weight of a bulge", "bulge");
    require_within(weights.turn, any_weight, "the weight of a turn", "turn");
    require_within(weights.stroke, any_weight, "the weight of a stroke", "stroke");
}

Detail parse_detail(const std::string& name) {
    for (const auto& [known, value] : kDetailNames)
        if (name == known) return value;
    throw Error("choice-unknown", "detail must be draft, normal or fine, not \"" + name + "\"");
}

ObjectiveWeights weights_for(Detail detail) {
    ObjectiveWeights weights;
    if (detail == Detail::draft) weights.stroke = 0.5;
    if (detail == Detail::fine) weights.stroke = 0.03;
    return weights;
}

}  // namespace brushsvg
