#include "mark_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/format_text.hpp"
#include "base/within.hpp"
#include "brushsvg/error.hpp"
#include "identifiability.hpp"
#include "lack_of_fit.hpp"
#include "mark_problem.hpp"
#include "multistart.hpp"
#include "no_brush.hpp"
#include "noise_covariance.hpp"

namespace brushsvg::fit {
namespace {

constexpr double kMaxDepthMm = 1000.0;  // greater depths are damaged data, and their powers overflow
// Limits of one fit. It evaluates each place and point about a hundred times, in about a microsecond each. A sheet of
// 49 strokes has 22,000 places and 8,500 points.
constexpr double kMaxPlaces = 2e5, kMaxPoints = 2e5;
constexpr double kMaxPlaceSpacingMm = 0.15;  // largest distance between places of a prediction along the path
constexpr double kMaxInverseSd = 1e12;       // limit of 1 over the standard deviation of a law's coefficient
constexpr double kMinMarkWidthMm = 0.3;      // width of a pen's line; edges in a picture may have errors as large
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Throws Error for an invalid standard deviation. `name`: of the option.
void require_sigma(double sigma, const std::string& name) {
    require_within(sigma, {0.0, kInf}, "the standard deviation", name);
}

void require_valid_options(const MarkOptions& options) {
    require_within(options.deepest_mm, {1e-3, kMaxDepthMm}, "the greatest depth", "deepest_mm");
    require_within(options.spacing_mm, {1e-3, kMaxCoordinateMm}, "the spacing", "spacing_mm");
    for (const auto& [prior, least, greatest, name] :
         {std::tuple{options.widest_per_half, 0.1, 100.0, "widest_per_half"},
          std::tuple{options.front_per_half, 0.1, 100.0, "front_per_half"},
          std::tuple{options.height_mm, -kMaxDepthMm, kMaxDepthMm, "height_mm"}}) {
        require_within(prior.value, {least, greatest}, "the value", name);
        require_sigma(prior.sigma, name);
    }
    require_sigma(options.placement_mm, "placement_mm");
    require_sigma(options.turn_rad, "turn_rad");
    require_sigma(options.displacement_mm, "displacement_mm");
    for (const auto& [sigma, name] :
         {std::pair{options.lean_mm_per_mm, "lean_mm_per_mm"}, std::pair{options.axes, "axes"},
          std::pair{options.tilt_mm_per_mm, "tilt_mm_per_mm"}, std::pair{options.backlash_mm, "backlash_mm"},
          std::pair{options.field_mm, "field_mm"}})
        require_sigma(sigma, name);
    if (options.noise_mm) {
        require_within(*options.noise_mm, {0.0, kMaxCoordinateMm}, "the noise", "noise_mm");
        require_within(options.noise_length_mm, {0.0, kMaxCoordinateMm}, "the length", "noise_length_mm");
    }
    require_within(options.max_iterations, {1, 10000}, "the number of iterations", "max_iterations");
}

/// Throws Error for laws that cannot be used. `of`: their purpose, for the message.
void require_valid_laws(const MarkLaws& laws, const std::string& of) {
    for (const auto& [law, name] : {std::pair{&laws.lag, ".lag"}, std::pair{&laws.tip_gap, ".tip_gap"},
                                    std::pair{&laws.half_width, ".half_width"}})
        for (const double c : *law)
            require_within(c, {-kMaxCoordinateMm, kMaxCoordinateMm}, "a coefficient", of + name);
    require_within(laws.widest_per_half, {0.1, 100.0}, "the ratio", of + ".widest_per_half");
    require_within(laws.front_per_half, {0.1, 100.0}, "the ratio", of + ".front_per_half");
}

void require_valid_law_prior(const MarkOptions& options) {
    if (!options.laws) return;
    require_valid_laws(options.laws->laws, "laws");
    const int terms = options.lag_terms + options.tip_gap_terms + options.half_width_terms + 1;
    for (const std::vector<double>& row : options.laws->rows) {
        require_within(double(row.size()), {double(terms), double(terms)}, "the number of columns", "laws.rows");
        for (const double c : row) require_within(c, {-kMaxInverseSd, kMaxInverseSd}, "a number", "laws.rows");
    }
}

void require_fittable_marks(const std::vector<PaintedMark>& marks, const MarkOptions& options) {
    if (marks.empty()) throw Error("measurement-missing", "there are no painted marks");
    for (const auto& [terms, name] :
         {std::pair{options.lag_terms, "lag"}, std::pair{options.tip_gap_terms, "tip_gap"},
          std::pair{options.half_width_terms, "half_width"}, std::pair{options.widest_terms, "widest_terms"},
          std::pair{options.front_terms, "front_terms"}})
        if (terms < 1 || terms > 4)
            throw Error("law-terms", "the law has " + std::to_string(terms) + " coefficients, outside the range [1, 4]",
                        name);
    require_valid_options(options);
    require_valid_law_prior(options);
    double way = 0.0, around = 0.0;
    for (const PaintedMark& mark : marks) {
        if (mark.poses_mm.rows() < 1) throw Error("pass-empty", "the stroke has no poses", mark.stroke);
        for (const double mm : mark.poses_mm.reshaped())
            require_within(mm, {-kMaxCoordinateMm, kMaxCoordinateMm}, "a coordinate of a pose", mark.stroke);
        Pass pass;
        pass.poses_mm = mark.poses_mm;
        pass.arcs = mark.arcs;
        pass.stroke = mark.stroke;
        for (std::size_t k = 0; k < mark.arcs.size(); ++k) check_arc(pass, k, mark.stroke);
        if (mark.outline_mm.empty())
            throw Error("mark-empty", "the mark has no outline: leave out strokes that were not painted", mark.stroke);
        double area = 0.0;
        for (const Ring& ring : mark.outline_mm) {
            if (ring.rows() < 3)
                throw Error("geometry-damaged",
                            "an outline has " + std::to_string(ring.rows()) + " points, but needs at least 3",
                            mark.stroke);
            for (const double mm : ring.reshaped())
                require_within(mm, {-kMaxCoordinateMm, kMaxCoordinateMm}, "a coordinate of an outline", mark.stroke);
            area += signed_area(ring);
            around += length_around(ring);
        }
        if (area < 0.0)
            throw Error("outline-clockwise",
                        "the outlines are clockwise: list outer outlines counter-clockwise and holes clockwise",
                        mark.stroke, area);
        const double deepest = -mark.poses_mm.col(2).minCoeff();
        if (deepest > options.deepest_mm + 1e-9)
            throw Error("depth-out-of-range",
                        format_text("a pose has a depth of %.3f mm, outside the range [0, %.3f] mm of the laws",
                                    deepest, options.deepest_mm),
                        mark.stroke, deepest, std::array<double, 2>{0.0, options.deepest_mm});
        const Index moves = mark.poses_mm.rows() - 1;
        way += double(moves) + (mark.poses_mm.bottomRows(moves) - mark.poses_mm.topRows(moves)).rowwise().norm().sum() /
                                   kMaxPlaceSpacingMm;
    }
    require_within(way, {0.0, kMaxPlaces}, "the number of places along the strokes");
    require_within(around / options.spacing_mm, {0.0, kMaxPoints}, "the number of points along the outlines");
}

/// Throws Error where the errors of the edges exceed the width of the marks: no brush paints such marks.
void require_brushlike_marks(const std::vector<PaintedMark>& marks, const MarkFit& fit) {
    double area = 0.0, around = 0.0;
    for (const PaintedMark& mark : marks)
        for (const Ring& ring : mark.outline_mm) {
            area += signed_area(ring);
            around += length_around(ring);
        }
    const double wide = 2.0 * area / std::max(around, 1e-9);  // as for strips
    if (fit.noise_mm <= std::max(wide, kMinMarkWidthMm)) return;
    std::size_t worst = 0;
    for (std::size_t i = 0; i < fit.marks.size(); ++i)
        if (fit.marks[i].rms_mm > fit.marks[worst].rms_mm) worst = i;
    throw no_brush_error(marks[worst].stroke);
}

/// Sets up the expected fit for edges with the given noise, whose autocorrelation is exp(-s / length).
void predict_uncertainty(MarkProblem& at, const std::optional<MarkLaws>& from, const MarkOptions& options) {
    if (!from) throw Error("options-contradict", "noise_mm needs a brush to start from");
    at.start_at(*from);
    at.shared[at.model.layout().widest()] = from->widest_per_half;
    at.shared[at.model.layout().front()] = from->front_per_half;
    at.require_prediction();
    at.weighing.noise_mm = std::max(1e-3, *options.noise_mm);
    at.weighing.is_given = true;
    const double kept = std::exp(-options.spacing_mm / std::max(1e-6, options.noise_length_mm));
    at.weighing.points_per_independent = (1.0 + kept) / (1.0 - kept);
    for (double c = kept; c > 1e-3 && at.weighing.autocovariance.size() < 60; c *= kept)
        at.weighing.autocovariance.push_back(c);
    at.ignore_narrow_points();
}

struct SolveResult {
    bool converged = false;
    double log_likelihood_ratio = -INFINITY;  ///< log of the likelihood ratio of the marks for laws that depart
};

/// Solves the problem, estimates the noise of the distances, leaves out outliers, and lets laws depart from their
/// coefficients. The noise is overestimated as long as laws do not depart, so that the last step is repeated until it
/// changes nothing any more.
SolveResult solve(MarkProblem& at, const std::optional<MarkLaws>& from, const std::vector<PaintedMark>& marks,
                  const MarkOptions& options) {
    find_start(at, from, marks, options);
    const bool may_depart = options.departing && !options.laws;
    SolveResult out;
    // The loss is only smooth to about 1e-5 of its value, because points change from edge to edge. Unknowns that only
    // their prior determines keep moving for many steps, by far less than their intervals.
    constexpr double kFinalTolerance = 2e-5, kDepartingTolerance = 1e-4, kMinLogRatioGain = 2.0;
    constexpr int kMaxRounds = 3;
    for (const auto& [loss, tolerance] :
         {std::pair{Loss::cauchy, 1e-4}, std::pair{Loss::tukey, 1e-4}, std::pair{Loss::tukey, kFinalTolerance}}) {
        at.weighing.loss = loss;
        out.converged = at.solve(options.max_iterations, at.is_departing() ? kDepartingTolerance : tolerance);
        at.weighing = estimate_weighing(at);
        if (loss == Loss::cauchy) at.correct_displaced_marks();
        if (tolerance > kFinalTolerance) at.ignore_narrow_points();
        if (loss == Loss::tukey && tolerance > kFinalTolerance && may_depart)
            out.log_likelihood_ratio = allow_departures(at, marks, options);
    }
    for (int round = 0; round < kMaxRounds && at.is_departing(); ++round) {
        const double before = out.log_likelihood_ratio;
        out.log_likelihood_ratio = allow_departures(at, marks, options);
        out.converged = at.solve(options.max_iterations, kDepartingTolerance);
        at.weighing = estimate_weighing(at);
        if (out.log_likelihood_ratio < before + kMinLogRatioGain) break;
    }
    return out;
}

/// Returns the covariance at a height of the paper near 0.
///
/// Strokes that land on a slope from height 0 begin later the lower the paper is, but begin at the same place if the
/// paper is higher. A height just below 0 is therefore determined less well than its derivatives say. The result is the
/// mean of the covariances on both sides, weighted by the probability that the paper is higher. The distribution
/// consists of two halves of normal distributions that meet at 0, and the wider half has the larger weight.
MatrixXd covariance_at_touch(MarkProblem fit) {
    constexpr double kProbeHeightMm = 1e-3, kMinProbability = 1e-3;
    const int height = fit.model.layout().height();
    fit.model.damp_loose_headings();
    MatrixXd out = covariance(fit);
    const double found = fit.shared[height], sd = std::sqrt(out(height, height));
    if (found > 0.0) return out;
    const double beyond =
        0.5 * std::erfc(-found / (std::sqrt(2.0) * sd));  // probability of the other side, if both are equally wide
    if (beyond < kMinProbability) return out;
    MarkProblem higher = fit;
    higher.shared[height] = kProbeHeightMm;
    const MatrixXd there = covariance(higher);
    const double wider = std::sqrt(there(height, height)) / sd;
    if (!(wider > 1.0)) return out;
    const double above = 0.5 * wider * std::exp(-0.5 * found * found / (sd * sd));
    return out + above / (above + 1.0 - beyond) * (there - out);
}

/// Returns the mean square error matrix of the shared unknowns.
///
/// Departures of laws were expected to be of any order of magnitude, including the smallest. This prefers the height of
/// the paper at which the laws are most like their few coefficients, although the marks hardly distinguish it from
/// other heights. The solution is kept, but its error is computed for typical departures: from their covariance, and
/// the distance from their most likely solution. The error without departures is added with its probability.
MatrixXd mean_square_error(const MarkProblem& fit, const MarkOptions& options, double log_likelihood_ratio) {
    if (!fit.is_departing()) return covariance_at_touch(fit);
    const auto error_of = [](const MarkProblem& at) -> MatrixXd {
        const VectorXd off = distance_from_minimum(at);
        return covariance_at_touch(at) + off * off.transpose();
    };
    const double departing = departure_probability(log_likelihood_ratio);
    return departing * error_of(with_typical_departures(fit, options)) +
           (1.0 - departing) * error_of(without_departures(fit, options));
}

}  // namespace

MarkFit fit_marks(const std::vector<PaintedMark>& marks, const std::optional<MarkLaws>& from,
                  const MarkOptions& options) {
    require_fittable_marks(marks, options);
    if (from) require_valid_laws(*from, "start");
    MarkProblem fit(marks, options);
    Index points = 0;
    for (Index i = 0; i < fit.model.marks(); ++i) points += fit.model.points(i);
    if (points == 0) throw Error("mark-empty", "the outlines are too small to compare: check that they are in mm");
    MarkFit out;
    SolveResult solved;
    if (options.noise_mm)
        predict_uncertainty(fit, from, options);
    else
        solved = solve(fit, from, marks, options);
    out.converged = solved.converged;
    out.laws = fit.model.laws(fit.shared);
    const MatrixXd to = fit.model.to_coefficients();
    VectorXd wider = VectorXd::Constant(to.rows(), std::sqrt(variance_factor(solved.log_likelihood_ratio)));
    // The places of marks determine a field, independently of the form of the laws.
    if (fit.model.layout().machine_numbers > 0) wider.tail(kMachineErrors - MachineIndex::field).setOnes();
    const MatrixXd whole = wider.asDiagonal() * to * mean_square_error(fit, options, solved.log_likelihood_ratio) *
                           to.transpose() * wider.asDiagonal();
    for (Index i = 0; i < whole.rows(); ++i) {
        const VectorXd row = whole.row(i).transpose();
        out.covariance.emplace_back(row.data(), row.data() + row.size());
    }
    const Layout& at = fit.model.layout();
    out.height_mm = fit.shared[at.height()];
    out.turn_rad = fit.shared[at.turn()];
    out.shift_mm = {fit.shared[at.shift()], fit.shared[at.shift() + 1]};
    out.centre_mm = fit.model.centre_mm();
    out.machine = fit.model.machine(fit.shared);
    out.noise_mm = fit.weighing.noise_mm;
    out.iterations = fit.iterations;
    double outlier_weight = 0.0, slim = 0.0;
    for (Index i = 0; i < fit.model.marks(); ++i) {
        const Eigen::Vector2d& own = fit.displacements_mm[std::size_t(i)];
        VectorXd distance;
        if (!fit.model.distances(i, fit.shared.data(), own.data(), distance, nullptr, nullptr))
            throw no_brush_error(marks[std::size_t(i)].stroke);
        MarkResidual residual;
        residual.point_mm = fit.model.points_in_plan_frame(i, fit.shared.data(), own.data());
        residual.distance_mm.assign(distance.data(), distance.data() + distance.size());
        residual.displacement_mm = {own.x(), own.y()};
        residual.way_mm = fit.model.realised_path(i, fit.shared);
        residual.rms_mm = std::sqrt(distance.squaredNorm() / double(std::max<Index>(1, distance.size())));
        const Eigen::ArrayXd is_outlier = (distance.array().abs() > kTukeySigmas * out.noise_mm).cast<double>();
        const Eigen::ArrayXd point_weights = fit.point_weights[std::size_t(i)].array();
        residual.outlier = is_outlier.sum() > 0.5 * double(distance.size());
        outlier_weight += (point_weights * is_outlier).sum();
        slim += (1.0 - point_weights).sum();
        out.samples += double(distance.size());
        out.marks.push_back(std::move(residual));
    }
    if (!options.noise_mm) require_brushlike_marks(marks, out);
    out.outlier_share = outlier_weight / std::max(1.0, out.samples);
    out.slim = slim / std::max(1.0, out.samples);
    // Squares are divided by the points per independent point, and the loss passes the share `slope` of them.
    out.effective_samples = std::min(
        out.samples, (out.samples - outlier_weight - slim) * fit.weighing.slope / fit.weighing.points_per_independent);
    out.remarks = describe_open_unknowns(
        with_terms(fit, marks, options));  // without departures, which only their prior determines
    return out;
}

}  // namespace brushsvg::fit
