#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"

namespace brushsvg::fit {

/// A taut brush at one instant of its way: contact P, heading of the lever [rad, unwrapped], depth.
struct PatchSample {
    Eigen::Vector2d contact_mm;
    double heading_rad;
    double depth_mm;
};
using PatchSamples = std::vector<PatchSample>;

/// The way of a patch that is dragged, never pushed: it moves along its heading or rests, whatever the unknowns are.
/// They bend the way it began with: where it starts, and as cubic B-splines along it by how much the heading is
/// turned [rad], by which factor steps are longer [log], by how much the brush is pressed deeper [mm].
class PatchPath {
 public:
    /// `depths_mm`: what the depth is kept to. Equal: the depth stays as it is.
    PatchPath(PatchSamples base, int controls, const std::array<double, 2>& depths_mm);

    int unknowns() const { return 2 + 3 * controls_; }
    int controls() const { return controls_; }
    const PatchSamples& base() const { return base_; }
    PatchSamples at(const Eigen::VectorXd& x) const;

    /// Derivatives by the unknowns, a row per sample: of the contact's x and y, of the heading, of the depth.
    struct Slopes {
        Eigen::MatrixXd x, y, heading, depth;
    };
    PatchSamples at(const Eigen::VectorXd& x, Slopes& slopes) const;

 private:
    PatchSamples base_;
    int controls_;
    std::array<double, 2> depths_mm_;
    Eigen::MatrixXd here_, between_;  ///< values of the splines at the samples and half way between them
};

/// Length of the patch's way [mm].
double way_of(const PatchSamples& samples);

/// The way of the patch that a pass draws, from where the brush is taut to where it was so last, evenly resampled.
PatchSamples patch_path(const Pass& pass, const Brush& brush, double step_mm, std::size_t most);

/// Whether the brush turns over between neighbours.
bool turns_over(const PatchSample& a, const PatchSample& b);

/// The pass that draws it: landing, q = P + r(depth) u, turning over, lift. Chords stay within the tolerance.
Poses poses_along(const PatchSamples& samples, const Brush& brush, double tolerance_mm);

}  // namespace brushsvg::fit
