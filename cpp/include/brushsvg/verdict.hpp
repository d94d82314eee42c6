#pragma once

/// The name until 0.2: stroke_score.hpp.
#include "brushsvg/stroke_score.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

using Verdict = StrokeScore;
inline StrokeScore verdict(const PassMarks& painted, const Stroke& wanted, const Brush& brush) {
    return stroke_score(painted, wanted, brush);
}

}  // namespace brushsvg
