#include "brushsvg/objective.hpp"

#include "brushsvg/error.hpp"

namespace brushsvg {

Detail detail_named(const std::string& name) {
    for (const auto& [known, value] : kDetails)
        if (name == known) return value;
    throw Error("choice-unknown", "detail is draft, normal or fine, not \"" + name + "\"");
}

ObjectiveWeights weights_for(Detail detail) {
    ObjectiveWeights weights;
    if (detail == Detail::draft) weights.stroke = 0.5;
    if (detail == Detail::fine) weights.stroke = 0.03;
    return weights;
}

}  // namespace brushsvg
