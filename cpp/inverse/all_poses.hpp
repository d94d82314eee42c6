#pragma once

#include "brushsvg/compensate.hpp"

namespace brushsvg {

/// The result of compensate(), and the pass with all poses that it would return. Both have equal starts and ends.
struct WithAllPoses {
    CompensatedPass plan;
    Pass all_poses;
};
WithAllPoses compensate_with_all_poses(const Stroke& stroke, const Brush& brush, const CompensateOptions& options);

}  // namespace brushsvg
