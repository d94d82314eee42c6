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

/// The way of a patch that is dragged, never pushed: it moves along its heading or rests, for any unknowns.
/// They bend the way it began with: where it starts, and as cubic B-splines along it by how much the heading is
/// turned [rad], by which factor steps are longer [log], by how much the brush is pressed deeper [mm].
class PatchPath {
 public:
    /// At least four controls. `depths_mm`: what the depth is kept to. Equal: the depth stays as it is.
    PatchPath(PatchSamples base, int controls, const std::array<double, 2>& depths_mm);

    int unknowns() const { return 2 + 3 * controls_; }
    int controls() const { return controls_; }
    const PatchSamples& base() const { return base_; }
    PatchSamples at(const Eigen::VectorXd& x) const;

    /// How a sum grows with the unknowns, given how it does with each sample's x, y, heading and depth: S^T g of the
    /// samples' slopes S. `samples`: those at these unknowns.
    Eigen::VectorXd slope(const PatchSamples& samples, const std::vector<Eigen::Vector4d>& by_samples) const;

    /// The same of sums of squares, S^T M S with a symmetric block of M for each sample. A control moves its
    /// neighbourhood and shifts all of the way behind it, so that n samples and k controls cost n k, not n k^2.
    Eigen::MatrixXd curvature(const PatchSamples& samples, const std::vector<Eigen::Matrix4d>& by_samples) const;

 private:
    /// Values of those splines that are not zero at a place, from the first of them on.
    struct Splines {
        Eigen::Index first = 0;
        Eigen::Vector4d value = Eigen::Vector4d::Zero();
        double of(const Eigen::VectorXd& x, Eigen::Index controls_from) const {
            return value.dot(x.segment<4>(controls_from + first));
        }
    };
    static Splines splines_at(double t, int controls);
    bool is_free(double depth_mm) const { return depth_mm > depths_mm_[0] && depth_mm < depths_mm_[1]; }

    PatchSamples base_;
    int controls_;
    std::array<double, 2> depths_mm_;
    std::vector<Splines> here_, between_;  ///< at the samples, and half way from each to the next
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
