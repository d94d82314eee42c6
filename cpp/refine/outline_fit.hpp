#pragma once

#include <Eigen/Core>

#include "brushsvg/brush.hpp"
#include "brushsvg/ring.hpp"
#include "patch_path.hpp"

namespace brushsvg::fit {

/// Fit the path so that the outline of its mark matches the given rings. Returns the unknowns with the least sum of
/// distances of the rings' points from that outline. This about minimises the area that only one of both covers.
/// `width_mm`: approximate width of the mark. `x`: initial unknowns. `trust`: how large the first step may be, one over
/// its damping.
Eigen::VectorXd fit_outline(const PatchPath& path, const Brush& brush, const Rings& target_mm, double width_mm,
                            int iterations, Eigen::VectorXd x, double trust);

}  // namespace brushsvg::fit
