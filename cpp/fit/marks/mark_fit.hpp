#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "brushsvg/brush_law.hpp"
#include "brushsvg/plan.hpp"
#include "brushsvg/ring.hpp"

// Fits a brush to whole painted marks: outlines on the paper, and the TCP's path that painted each. Lengths are in mm.
namespace brushsvg::fit {

/// The mark of one pass: outer rings and holes, in the frame of the plan as far as it is known.
struct PaintedMark {
    std::string stroke;
    Poses poses_mm;  ///< z = -depth
    Rings outline_mm;
    std::vector<Arc> arcs;  ///< of the pass, as in Pass
};

/// The prior of an unknown, a normal distribution. sigma 0: the value is known; infinite: nothing is known.
struct Prior {
    double value, sigma;
};

/// The laws as polynomials (ascending powers of depth), and the shape of the footprint.
///
/// The footprint is a drop with straight flanks from the tip to the widest section at x_w = widest_per_half h. In front
/// of this section is half an ellipse of length front_per_half h. Where the tail is round, half an ellipse replaces the
/// flanks.
struct MarkLaws {
    std::vector<double> lag, tip_gap, half_width;
    double widest_per_half = 1.8, front_per_half = 1.0;
    bool round_tail = false;
    /// Ratios that change with depth, as polynomials (ascending powers of depth); empty for constant ratios. The ratios
    /// above are their means over [0, deepest]. They are at least kMinRatio at any depth.
    std::vector<double> widest_by_depth, front_by_depth;
};

/// The errors of a machine's positions.
///
/// For a command (x, y) from MarkFit::centre_mm and a depth d, the machine goes to x' = scale_x x + skew y + lean_x d,
/// y' = scale_y y + lean_y d, and tilt_x x + tilt_y y deeper. Each axis stays behind by half its backlash. A smooth
/// field adds a u^2 + b u v + c v^2 [mm], with three numbers for x and three for y, where u and v are the commanded
/// distances from field_middle_mm divided by field_reach_mm.
struct Machine {
    std::array<double, 2> lean_mm_per_mm{0.0, 0.0}, scale{1.0, 1.0};
    double skew = 0.0;
    std::array<double, 2> tilt_mm_per_mm{0.0, 0.0}, backlash_mm{0.0, 0.0};
    std::array<std::array<double, 3>, 2> field_mm{};
    /// Middle and half the sides of the box of all commanded places; beyond it, nothing is known about the field.
    std::array<double, 2> field_middle_mm{0.0, 0.0}, field_reach_mm{1.0, 1.0};
};

/// The prior of the laws. laws: their mean; rows: each row maps the difference from the mean to a standard normal
/// number. Rows are over the coefficients of lag, tip_gap and half_width (without their constant, which is 0) and
/// widest_per_half.
struct LawPrior {
    MarkLaws laws;
    std::vector<std::vector<double>> rows;
};

struct MarkOptions {
    double deepest_mm = 10.0;  ///< the laws are fitted on [0, deepest]
    /// Coefficients per law, at most four: r = c0 + ..., b and h through 0; h never falls.
    int lag_terms = 4, tip_gap_terms = 1, half_width_terms = 2;
    int widest_terms = 1, front_terms = 1;  ///< coefficients of the ratios, one to four
    /// Laws may depart from these coefficients as far as the marks require it, and the intervals include departures.
    bool departing = true;
    Prior widest_per_half{1.8, 0.5};  ///< the shape that the project assumes of round brushes, and round-6's spread
    Prior front_per_half{1.0, 0.3};
    std::optional<LawPrior> laws;  ///< in addition to the priors of the shape; none: nothing is known about the laws
    bool round_tail = false;
    Prior height_mm{0.0, 0.3};     ///< height of the paper above the taught one; touching by eye is this accurate
    double placement_mm = 2.0;     ///< sigma of the sheet's shift in x and in y, when it is put against a stop by hand
    double turn_rad = 0.02;        ///< sigma of the sheet's turn: 1 mm on 50 mm
    double displacement_mm = 1.0;  ///< sigma of each mark's own displacement in x and in y
    /// Sigmas of the machine's errors; axes is for scale and skew; 0: the machine has no such error.
    double lean_mm_per_mm = 0.0, axes = 0.0, tilt_mm_per_mm = 0.0, backlash_mm = 0.0, field_mm = 0.0;
    double spacing_mm = 0.5;  ///< between the points of an outline that are compared
    /// If given, nothing is fitted, and the result is the covariance to expect at the start for edges with this noise.
    std::optional<double> noise_mm;
    double noise_length_mm = 1.0;  ///< correlation length of the noise along an edge; only with noise_mm
    int max_iterations = 60;
};

/// One mark compared with its prediction at the solution.
struct MarkResidual {
    Ring point_mm;  ///< points of the painted outline in the frame of the plan, without the displacement
    std::vector<double> distance_mm;  ///< distance from the predicted edge, negative inside
    std::array<double, 2> displacement_mm{0.0, 0.0};
    Poses way_mm;  ///< path that the machine ran, without height and displacement
    double rms_mm = 0.0;
    bool outlier = false;  ///< more than half of its points were left out
};

struct MarkFit {
    MarkLaws laws;
    /// Covariance of lag, tip_gap and half_width (without their constant, which is 0), widest_per_half, front_per_half,
    /// height, shift x and y, turn, in this order, for the laws' own coefficients. Where the ratios change with depth,
    /// the coefficients of widest_by_depth and front_by_depth replace them. Where any error of the machine was
    /// requested, lean x and y, scale x and y, skew, tilt x and y, backlash x and y and the field's six numbers follow.
    std::vector<std::vector<double>> covariance;
    double height_mm = 0.0, turn_rad = 0.0;
    std::array<double, 2> shift_mm{0.0, 0.0};
    std::array<double, 2> centre_mm{0.0, 0.0};  ///< point about which the sheet is turned
    Machine machine;
    std::vector<MarkResidual> marks;
    double noise_mm = 0.0;             ///< robust standard deviation of the distances
    double samples = 0.0;              ///< number of compared points
    double effective_samples = 0.0;    ///< number of independent points that would determine as much
    double outlier_share = 0.0;        ///< share of the points that are left out as outliers
    double slim = 0.0;                 ///< share of the points left out at ends narrower than the noise
    std::vector<std::string> remarks;  ///< unknowns that these marks cannot separate, and additional strokes to paint
    int iterations = 0;
    bool converged = false;
};

/// Fits laws, footprint, sheet and machine by least squares over the distances of painted edges from the union of the
/// predicted footprints.
///
/// Derivatives go through the simulator. A point's distance is that from the nearest footprint, so that a shift of this
/// instant does not matter. The loss is Tukey's, so that blots and gaps have no influence. Backlash assumes that the
/// marks were painted one after the other.
///
/// Covariance: sandwich of the loss times (J^T J)^-1, with the priors in J. The samples along an outline are correlated
/// and count as fewer, by the integral of their autocorrelation. Points at ends narrower than three times the noise
/// have no influence. Throws Error where there is no mark, for numbers that are not finite or no millimetres, for a
/// start that paints no mark, and for marks that no brush paints (no_brush.hpp).
MarkFit fit_marks(const std::vector<PaintedMark>& marks, const std::optional<MarkLaws>& start,
                  const MarkOptions& options);

}  // namespace brushsvg::fit
