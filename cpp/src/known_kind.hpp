#pragma once

#include <algorithm>
#include <string>

#include "brushsvg/error.hpp"

namespace brushsvg {

/// Throws Error for a kind of brush that is none of those that are modelled. Empty is the first of them.
template <class Kinds>
void require_known_kind(const std::string& kind, const Kinds& kinds) {
    if (kind.empty() || std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) return;
    std::string known;
    for (const char* each : kinds) known += (known.empty() ? "" : ", ") + std::string(each);
    throw Error("choice-unknown",
                "brushes of kind " + kind.substr(0, 40) + " are not simulated (known: " + known + "). Use " + kinds[0] +
                    " if its footprint is the same in every direction",
                "kind");
}

}  // namespace brushsvg
