#pragma once

#include <Eigen/Core>

#include "brushsvg/brush.hpp"
#include "brushsvg/ring.hpp"
#include "patch_path.hpp"

namespace brushsvg::fit {

/// Unknowns of the path with which the outline of its mark fits rings best: the sum of the distances of the rings'
/// points to it is least, and with it about the area that only one of both holds. `width_mm`: of the mark, about;
/// `x`: where to begin; `trust`: how large the first step may be, one over its damping.
Eigen::VectorXd fit_outline(const PatchPath& path, const Brush& brush, const Rings& wanted_mm, double width_mm,
                            int iterations, Eigen::VectorXd x, double trust);

}  // namespace brushsvg::fit
