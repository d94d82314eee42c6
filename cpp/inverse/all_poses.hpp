#pragma once

#include "brushsvg/compensate.hpp"

namespace brushsvg {

/// What compensate() returns, and the pass that it would return with all poses, begun and ended alike.
struct WithAllPoses {
    CompensatedPass plan;
    Pass all_poses;
};
WithAllPoses compensate_with_all_poses(const Stroke& stroke, const Brush& brush, const CompensateOptions& options);

}  // namespace brushsvg
