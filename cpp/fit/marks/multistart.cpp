#include "multistart.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "no_brush.hpp"
#include "noise_covariance.hpp"

namespace brushsvg::fit {
namespace {

constexpr std::size_t kMaxStarts = 4;
// Factors on the distances between points and between instants during the search for a start.
constexpr double kPointSpacingFactor = 3.0, kInstantSpacingFactor = 2.5;
constexpr double kStartTolerance = 1e-3;  // coarse, because the noise is not known yet

/// Estimates the half width per depth: the painted areas are fitted to 2 times length of the path times depth.
double estimate_width_per_depth(const std::vector<PaintedMark>& marks) {
    double over = 0.0, under = 0.0;
    for (const PaintedMark& mark : marks) {
        double swept = 0.0, painted = 0.0;
        for (const Ring& ring : mark.outline_mm) painted += signed_area(ring);
        for (Index i = 0; i + 1 < mark.poses_mm.rows(); ++i)
            swept += (mark.poses_mm.row(i + 1) - mark.poses_mm.row(i)).head<2>().norm() *
                     std::max(0.0, -0.5 * (mark.poses_mm(i, 2) + mark.poses_mm(i + 1, 2)));
        over += painted * swept;
        under += swept * swept;
    }
    return under > 0.0 ? 0.5 * over / under : 0.0;
}

std::vector<MarkLaws> candidate_starts(const std::vector<PaintedMark>& marks, const MarkOptions& options) {
    const double rate = std::clamp(estimate_width_per_depth(marks), 0.02, 50.0), deepest = options.deepest_mm;
    std::vector<MarkLaws> out;
    for (double lag : {0.3, 1.0, 2.0, 3.5, 5.0, 7.5, 10.0, 14.0, 20.0, 30.0})
        for (double share : {1.0, 0.3}) {  // share of the lag at depth 0
            MarkLaws laws;
            laws.lag = {lag * share, lag * (1.0 - share) / deepest};
            laws.tip_gap = {0.0, 1.2 * rate};
            laws.half_width = {0.0, rate};
            if (options.lag_terms == 1) {
                if (share < 1.0) continue;
                laws.lag.pop_back();
            }
            out.push_back(std::move(laws));
        }
    return out;
}

/// Returns the starts that are nearest to the marks. Throws Error where no start predicts all marks.
std::vector<MarkLaws> nearest_starts(MarkProblem& at, const std::vector<PaintedMark>& marks,
                                     const MarkOptions& options) {
    std::vector<std::pair<double, MarkLaws>> from;
    Eigen::VectorXi unpredicted =
        Eigen::VectorXi::Zero(at.model.marks());  // number of starts that do not predict each mark
    for (const MarkLaws& laws : candidate_starts(marks, options)) {
        at.start_at(laws);
        const VectorXd losses = at.losses();
        unpredicted += (!losses.array().isFinite()).cast<int>().matrix();
        if (losses.allFinite()) from.emplace_back(std::accumulate(losses.begin(), losses.end(), 0.0), laws);
    }
    if (from.empty()) {
        Index worst = 0;
        unpredicted.maxCoeff(&worst);
        throw no_brush_error(at.model.stroke(worst));
    }
    std::stable_sort(from.begin(), from.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<MarkLaws> out;
    for (std::size_t i = 0; i < std::min(kMaxStarts, from.size()); ++i) out.push_back(from[i].second);
    return out;
}

/// Moves to the best of these starts, each after a few steps, with the machine held constant or free.
void try_lags(MarkProblem& at, const std::vector<MarkLaws>& candidate_starts, bool is_held) {
    at.hold_shape(true, is_held);
    double best = INFINITY;
    VectorXd shared;
    std::vector<Eigen::Vector2d> own;
    for (const MarkLaws& laws : candidate_starts) {
        at.start_at(laws);
        at.solve(8, kStartTolerance);
        const double now = at.loss();
        if (!(now < best)) continue;
        best = now;
        shared = at.shared;
        own = at.displacements_mm;
    }
    at.shared = shared;
    at.displacements_mm = own;
    at.hold_shape(false, false);
}

/// Tries lags with the machine held constant and with the machine free, and keeps the better result. With the machine
/// held, a lag may win that imitates a lean; with the machine free, a lean that imitates a lag. No small step leads
/// back from either.
void try_machine_held_and_free(MarkProblem& at, const std::vector<PaintedMark>& marks, const MarkOptions& options) {
    const std::vector<MarkLaws> lags = nearest_starts(at, marks, options);
    double best = INFINITY;
    VectorXd shared;
    std::vector<Eigen::Vector2d> own;
    for (const bool is_held : {false, true}) {
        if (is_held && at.model.layout().machine_numbers == 0) break;
        try_lags(at, lags, is_held);
        at.solve(options.max_iterations, kStartTolerance);
        const double now = at.loss();
        if (is_held && !(now < best)) continue;
        best = now;
        shared = at.shared;
        own = at.displacements_mm;
    }
    at.shared = shared;
    at.displacements_mm = own;
}

}  // namespace

void find_start(MarkProblem& at, const std::optional<MarkLaws>& from, const std::vector<PaintedMark>& marks,
                const MarkOptions& options) {
    MarkOptions sparse = options;
    sparse.spacing_mm *= kPointSpacingFactor;
    MarkProblem coarse_problem(marks, sparse, kInstantSpacingFactor);
    if (from) {
        coarse_problem.start_at(*from);
        coarse_problem.require_prediction();
        coarse_problem.solve(options.max_iterations, kStartTolerance);
    } else {
        try_machine_held_and_free(coarse_problem, marks, options);
    }
    coarse_problem.weighing = estimate_weighing(coarse_problem);
    coarse_problem.correct_displaced_marks();
    at.shared = coarse_problem.shared;
    at.displacements_mm = coarse_problem.displacements_mm;
    at.iterations += coarse_problem.iterations;
    at.weighing.noise_mm = coarse_problem.weighing.noise_mm;
    at.weighing = estimate_weighing(at);
}

}  // namespace brushsvg::fit
