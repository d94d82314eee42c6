#include "brushsvg/stroke_id.hpp"

namespace brushsvg {

std::string StrokeId::name() const {
    std::string out = element;
    if (part > 0) out += "/" + std::to_string(part);
    if (repeat > 1) out += "#" + std::to_string(repeat);
    if (lane > 1) out += "~" + std::to_string(lane);
    if (load > 1) out += "+" + std::to_string(load);
    return out;
}

}  // namespace brushsvg
