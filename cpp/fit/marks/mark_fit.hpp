#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "brushsvg/plan.hpp"
#include "brushsvg/profile.hpp"
#include "brushsvg/ring.hpp"

// A brush from whole painted marks: outlines on the paper and the TCP's way that painted each. Lengths in mm.
namespace brushsvg::fit {

/// What one pass painted. Outer rings and holes, in the frame of the plan as far as that is known.
struct PaintedMark {
    std::string stroke;
    Poses poses_mm;  ///< z = -depth
    Rings outline_mm;
    std::vector<Arc> arcs;  ///< of the pass, as in Pass
};

/// What is known of an unknown beforehand, as a normal distribution. sigma 0: known; infinite: nothing.
struct Prior {
    double value, sigma;
};

/// The laws as polynomials (ascending powers of depth), and the footprint's shape: a drop, straight flanks from the tip
/// to the widest section at x_w = widest_per_half h, in front of it half an ellipse that reaches front_per_half h on;
/// where the tail is round, half an ellipse instead of the flanks.
struct MarkLaws {
    std::vector<double> lag, tip_gap, half_width;
    double widest_per_half = 1.8, front_per_half = 1.0;
    bool round_tail = false;
    /// Where the ratios change with depth: polynomials (ascending powers of depth), of which those above are the means
    /// over [0, deepest]; empty where they do not. No less than kLeastRatio at any depth.
    std::vector<double> widest_by_depth, front_by_depth;
};

/// How a machine takes the tool elsewhere than commanded. Commanded (x, y) from MarkFit::centre_mm and a depth d it
/// goes to x' = scale_x x + skew y + lean_x d, y' = scale_y y + lean_y d, and is tilt_x x + tilt_y y deeper; on each
/// axis it stays behind by half its backlash. A smooth field takes it elsewhere still by a u^2 + b u v + c v^2 [mm],
/// three numbers for x and three for y, where u and v are the commanded distances from field_middle_mm, over
/// field_reach_mm.
struct Machine {
    std::array<double, 2> lean_mm_per_mm{0.0, 0.0}, scale{1.0, 1.0};
    double skew = 0.0;
    std::array<double, 2> tilt_mm_per_mm{0.0, 0.0}, backlash_mm{0.0, 0.0};
    std::array<std::array<double, 3>, 2> field_mm{};
    /// The middle of all commanded places and half its sides: beyond, nothing is known of the field.
    std::array<double, 2> field_middle_mm{0.0, 0.0}, field_reach_mm{1.0, 1.0};
};

/// Laws that are known beforehand: laws is the mean; each row, over the coefficients of lag, tip_gap and half_width
/// (their constant, 0, left out) and widest_per_half, gives a standard normal number of what they differ from it.
struct LawPrior {
    MarkLaws laws;
    std::vector<std::vector<double>> rows;
};

struct MarkOptions {
    double deepest_mm = 10.0;  ///< the laws are to hold on [0, deepest]
    /// Numbers per law, at most four: r = c0 + ..., b and h through 0; h never falls.
    int lag_terms = 4, tip_gap_terms = 1, half_width_terms = 2;
    int widest_terms = 1, front_terms = 1;  ///< of the ratios
    /// Laws may depart from these numbers as far as the marks ask for it, and the intervals hold by how much they may.
    bool departing = true;
    Prior widest_per_half{1.8, 0.5};  ///< the shape that the project assumes of round brushes, and round-6's spread
    Prior front_per_half{1.0, 0.3};
    std::optional<LawPrior> laws;  ///< in addition to the priors of the shape; none: nothing is known of them
    bool round_tail = false;
    Prior height_mm{0.0, 0.3};     ///< the paper is higher than taught by so much: touching by eye is as good
    double placement_mm = 2.0;     ///< sigma of the sheet's shift in x and in y: laid against a stop by hand
    double turn_rad = 0.02;        ///< sigma of the sheet's turn: 1 mm on 50 mm
    double displacement_mm = 1.0;  ///< sigma of each mark's own displacement in x and in y
    /// Sigmas of the machine's numbers, of scale and skew together; 0: it has none of it.
    double lean_mm_per_mm = 0.0, axes = 0.0, tilt_mm_per_mm = 0.0, backlash_mm = 0.0, field_mm = 0.0;
    double spacing_mm = 0.5;  ///< between the points of an outline that are compared
    /// If given nothing is fitted: the covariance is that to expect at the start from edges this uncertain.
    std::optional<double> noise_mm;
    double noise_length_mm = 1.0;  ///< over which the noise of an edge forgets itself; with noise_mm only
    int most_iterations = 60;
};

/// One mark against its prediction at the solution.
struct MarkResidual {
    Ring point_mm;                    ///< of the painted outline, in the frame of the plan, displacement taken away
    std::vector<double> distance_mm;  ///< from the predicted mark's edge, negative inside
    std::array<double, 2> displacement_mm{0.0, 0.0};
    Poses way_mm;  ///< as the machine ran it; height and displacement left out
    double rms_mm = 0.0;
    bool outlier = false;  ///< more than half of it was left out
};

struct MarkFit {
    MarkLaws laws;
    /// Over lag, tip_gap and half_width (their constant, 0, left out), widest_per_half, front_per_half, height, shift x
    /// and y, turn: in this order, in the laws' own coefficients; those of widest_by_depth and front_by_depth in place
    /// of the ratios where these change with depth. Where any number of the machine was requested, lean x and y,
    /// scale x and y, skew, tilt x and y, backlash x and y and the field's six follow.
    std::vector<std::vector<double>> covariance;
    double height_mm = 0.0, turn_rad = 0.0;
    std::array<double, 2> shift_mm{0.0, 0.0};
    std::array<double, 2> centre_mm{0.0, 0.0};  ///< about which the sheet is turned
    Machine machine;
    std::vector<MarkResidual> marks;
    double noise_mm = 0.0;             ///< robust standard deviation of the distances
    double samples = 0.0;              ///< points compared
    double effective_samples = 0.0;    ///< so many independent ones would determine as much
    double left_aside = 0.0;           ///< share of the points so far off that they have no say
    double slim = 0.0;                 ///< share of those that have none at ends narrower than the noise
    std::vector<std::string> remarks;  ///< what these marks cannot separate, and what to paint instead
    int iterations = 0;
    bool converged = false;
};

/// Least squares over the distances of painted edges from the union of footprints that the laws predict, with
/// derivatives through the simulator (a point's distance is that from the one footprint that comes nearest: how that
/// instant shifts does not matter), under Tukey's loss, so that blots and gaps have no say.
///
/// Backlash counts marks as painted one after the other.
///
/// Covariance: sandwich of the loss times (J^T J)^-1, J with the priors; the samples along an outline depend on each
/// other and count as fewer, by the integral of their autocorrelation. Points at ends narrower than three times the
/// noise have no say. Throws Error: no mark, numbers that are not finite or no millimetres, a start that paints no
/// mark, marks that no brush paints (no_brush.hpp).
MarkFit fit_marks(const std::vector<PaintedMark>& marks, const std::optional<MarkLaws>& start,
                  const MarkOptions& options);

}  // namespace brushsvg::fit
