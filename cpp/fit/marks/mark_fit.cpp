#include "mark_fit.hpp"

#include <algorithm>
#include <cmath>

#include "brushsvg/error.hpp"
#include "identifiability.hpp"
#include "mark_problem.hpp"
#include "multistart.hpp"
#include "noise_covariance.hpp"

namespace brushsvg::fit {
namespace {

void refuse_what_cannot_be_fitted(const std::vector<PaintedMark>& marks, const MarkOptions& options) {
    if (marks.empty()) throw Error("there is no painted mark");
    for (const auto& [terms, name] : {std::pair{options.lag_terms, "lag"}, std::pair{options.tip_gap_terms, "tip_gap"},
                                      std::pair{options.half_width_terms, "half_width"}})
        if (terms < 1 || terms > 4)
            throw Error(std::to_string(terms) + " numbers are outside the range [1, 4] for a law", name);
    if (!(options.deepest_mm > 0.0 && std::isfinite(options.deepest_mm)))
        throw Error("the greatest depth must be greater than 0", "deepest_mm", options.deepest_mm);
    if (!(options.spacing_mm > 0.0))
        throw Error("the spacing must be greater than 0", "spacing_mm", options.spacing_mm);
    for (const PaintedMark& mark : marks) {
        if (mark.poses_mm.rows() < 1 || !mark.poses_mm.allFinite())
            throw Error("the stroke needs poses, and all of them finite numbers", mark.stroke);
        if (mark.outline_mm.empty())
            throw Error("the mark has no outline: leave out what was not painted", mark.stroke);
        for (const Ring& ring : mark.outline_mm)
            if (ring.rows() < 3 || !ring.allFinite())
                throw Error("an outline needs three points or more, and all of them finite numbers", mark.stroke);
        const double deepest = -mark.poses_mm.col(2).minCoeff();
        if (deepest > options.deepest_mm + 1e-9)
            throw Error("a pose is deeper than the range of the laws", mark.stroke, deepest,
                        std::array<double, 2>{0.0, options.deepest_mm});
    }
}

/// What is to expect of edges this uncertain, which forget themselves as exp(-s / length).
void expect(MarkProblem& at, const std::optional<MarkLaws>& from, const MarkOptions& options) {
    if (!from) throw Error("to say what to expect takes a brush to start from");
    at.begin(*from);
    at.shared[at.model.layout().widest()] = from->widest_per_half;
    at.shared[at.model.layout().front()] = from->front_per_half;
    at.weighing.noise_mm = std::max(1e-3, *options.noise_mm);
    const double kept = std::exp(-options.spacing_mm / std::max(1e-6, options.noise_length_mm));
    at.weighing.repeats = (1.0 + kept) / (1.0 - kept);
    for (double c = kept; c > 1e-3 && at.weighing.together.size() < 60; c *= kept) at.weighing.together.push_back(c);
    at.leave_slim_aside();
}

/// Whether it converged. How sure the distances are is found on the way, wild ones lose their say.
bool solve(MarkProblem& at, const std::optional<MarkLaws>& from, const std::vector<PaintedMark>& marks,
           const MarkOptions& options) {
    if (from)
        at.begin(*from);
    else
        start(at, marks, options);
    bool converged = false;
    constexpr double kLast = 1e-7;
    for (const auto& [loss, tolerance] : {std::pair{Loss::cauchy, 1e-4}, std::pair{Loss::cauchy, 1e-5},
                                          std::pair{Loss::tukey, 1e-6}, std::pair{Loss::tukey, kLast}}) {
        at.weighing.loss = loss;
        converged = at.solve(options.most_iterations, tolerance);
        at.weighing = weighed(at);
        if (loss == Loss::cauchy) at.find_displaced();
        if (tolerance > kLast) at.leave_slim_aside();
    }
    return converged;
}

/// Strokes that land on a slope from height 0 begin the farther on the lower the paper lies, and where they did if it
/// lies higher: of a height found just below 0 the marks tell less than its own derivatives say. There it is the mean
/// of both sides' covariances, by how likely the paper lies above.
MatrixXd covariance_at_touch(const MarkProblem& fit) {
    constexpr double kAboveMm = 1e-3, kUnlikely = 1e-3;
    const int height = fit.model.layout().height();
    MatrixXd out = covariance(fit);
    if (fit.shared[height] > 0.0) return out;
    const double above = 0.5 * std::erfc(-fit.shared[height] / std::sqrt(2.0 * out(height, height)));
    if (above < kUnlikely) return out;
    MarkProblem higher = fit;
    higher.shared[height] = kAboveMm;
    const MatrixXd there = covariance(higher);
    if (there(height, height) > out(height, height)) out += above * (there - out);
    return out;
}

}  // namespace

MarkFit fit_marks(const std::vector<PaintedMark>& marks, const std::optional<MarkLaws>& from,
                  const MarkOptions& options) {
    refuse_what_cannot_be_fitted(marks, options);
    MarkProblem fit(marks, options);
    Index points = 0;
    for (Index i = 0; i < fit.model.marks(); ++i) points += fit.model.points(i);
    if (points == 0) throw Error("there are only specks, no mark");
    MarkFit out;
    if (options.noise_mm)
        expect(fit, from, options);
    else
        out.converged = solve(fit, from, marks, options);
    out.laws = fit.model.laws(fit.shared);
    const MatrixXd to = fit.model.to_coefficients();
    const MatrixXd whole = to * covariance_at_touch(fit) * to.transpose();
    for (Index i = 0; i < whole.rows(); ++i) {
        const VectorXd row = whole.row(i).transpose();
        out.covariance.emplace_back(row.data(), row.data() + row.size());
    }
    const Layout& at = fit.model.layout();
    out.height_mm = fit.shared[at.height()];
    out.turn_rad = fit.shared[at.turn()];
    out.shift_mm = {fit.shared[at.shift()], fit.shared[at.shift() + 1]};
    out.centre_mm = fit.model.centre_mm();
    out.noise_mm = fit.weighing.noise_mm;
    out.iterations = fit.iterations;
    double aside = 0.0, slim = 0.0;
    for (Index i = 0; i < fit.model.marks(); ++i) {
        const Eigen::Vector2d& own = fit.own[std::size_t(i)];
        VectorXd distance;
        if (!fit.model.distances(i, fit.shared.data(), own.data(), distance, nullptr, nullptr))
            throw Error("the laws to start from predict no mark", marks[std::size_t(i)].stroke);
        MarkMiss miss;
        miss.point_mm = fit.model.placed(i, fit.shared.data(), own.data());
        miss.distance_mm.assign(distance.data(), distance.data() + distance.size());
        miss.displacement_mm = {own.x(), own.y()};
        miss.rms_mm = std::sqrt(distance.squaredNorm() / double(std::max<Index>(1, distance.size())));
        const Eigen::ArrayXd wild = (distance.array().abs() > kTukey * out.noise_mm).cast<double>();
        const Eigen::ArrayXd says = fit.says[std::size_t(i)].array();
        miss.outlier = wild.sum() > 0.5 * double(distance.size());
        aside += (says * wild).sum();
        slim += (1.0 - says).sum();
        out.samples += double(distance.size());
        out.marks.push_back(std::move(miss));
    }
    out.left_aside = aside / std::max(1.0, out.samples);
    out.slim = slim / std::max(1.0, out.samples);
    // repeats divide squares, of which the loss lets through the slope's share
    out.effective_samples =
        std::min(out.samples, (out.samples - aside - slim) * fit.weighing.slope / fit.weighing.repeats);
    out.remarks = doubts(fit);
    return out;
}

}  // namespace brushsvg::fit
