#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/plan.hpp"

namespace brushsvg::fit {

/// State of a taut brush at one instant of its path: contact P, heading of the lever [rad, unwrapped], depth.
struct PatchSample {
    Eigen::Vector2d contact_mm;
    double heading_rad;
    double depth_mm;
};
using PatchSamples = std::vector<PatchSample>;

/// The path of a patch that is dragged, never pushed: it moves along its heading or rests, for any unknowns. The
/// unknowns change a base path. They are the shift of its start, and cubic B-splines along it: turn of the heading
/// [rad], factor of the step length [log], and additional depth [mm].
class PatchPath {
 public:
    /// `controls`: at least four. `depths_mm`: range to which the depth is limited. If both are equal, the depth stays
    /// unchanged.
    PatchPath(PatchSamples base, int controls, const std::array<double, 2>& depths_mm);

    int unknowns() const { return 2 + 3 * controls_; }
    int controls() const { return controls_; }
    const PatchSamples& base() const { return base_; }
    PatchSamples at(const Eigen::VectorXd& x) const;

    /// Return the derivatives of a sum by the unknowns, from its derivatives by each sample's x, y, heading and depth.
    /// It is S^T g with the derivatives S of the samples. `samples`: the path at these unknowns.
    Eigen::VectorXd slope(const PatchSamples& samples, const std::vector<Eigen::Vector4d>& by_samples) const;

    /// Return the curvature of a sum of squares: S^T M S with a symmetric block of M for each sample. A control moves
    /// its neighbourhood and shifts the whole path behind it. So n samples and k controls cost n k, not n k^2.
    Eigen::MatrixXd curvature(const PatchSamples& samples, const std::vector<Eigen::Matrix4d>& by_samples) const;

 private:
    /// Values of the splines that are not zero at a place, starting at the spline `first`.
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

/// Return the length of the patch's path [mm].
double path_length(const PatchSamples& samples);

/// Return the path of the patch that a pass draws, evenly resampled, from the first to the last place where the brush
/// is taut.
PatchSamples patch_path(const Pass& pass, const Brush& brush, double step_mm, std::size_t most);

/// Return whether the brush turns over between two neighbours.
bool turns_over(const PatchSample& a, const PatchSample& b);

/// Return the poses that draw the path: landing, q = P + r(depth) u, turning over, lift. Chords stay within the
/// tolerance.
Poses poses_along(const PatchSamples& samples, const Brush& brush, double tolerance_mm);

}  // namespace brushsvg::fit
