#pragma once

/// The name until 0.2: mark_overlap.hpp.
#include "brushsvg/mark_overlap.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

using Overlay = MarkOverlap;
inline MarkOverlap overlay(const std::vector<PassMarks>& painted, const std::vector<Stroke>& wanted,
                           const Brush& brush) {
    return mark_overlap(painted, wanted, brush);
}

}  // namespace brushsvg
