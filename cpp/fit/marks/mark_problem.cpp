#include "mark_problem.hpp"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "brushsvg/error.hpp"

namespace brushsvg::fit {
namespace {

// Share of a mark's points. A mark with more outliers may be matched with the wrong edge.
constexpr double kMaxOutlierShare = 0.2;
constexpr int kMaxMoves = 3;
// Smallest width of the prediction at a point, in standard deviations of the noise. With 2, the ends of strokes that
// are lifted while moving still bias the height; with 5, the height is known a tenth less well than with 3.
constexpr double kMinWidthSigmas = 3.0;

/// The residuals of one mark for the solver, from the last evaluation. Their squares add up to the loss.
class MarkCost : public ceres::CostFunction {
 public:
    MarkCost(const MarkProblem& at, Index mark, const std::vector<bool>& is_held, bool displaced)
        : at_(at), mark_(mark), is_held_(is_held), displaced_(displaced) {
        set_num_residuals(int(at.model.points(mark)));
        *mutable_parameter_block_sizes() = {at.model.layout().size(), 2};
    }
    /// Evaluates residuals and derivatives. Derivatives are needed next if the step is accepted, as most steps are.
    void evaluate() {
        const Index n = num_residuals(), size = at_.model.layout().size();
        const Weighing& weighing = at_.weighing;
        const VectorXd& point_weights = at_.point_weights[std::size_t(mark_)];
        VectorXd distance;
        residuals_.resize(n);
        by_shared_.setZero(n, size);
        by_displacement_.setZero(n, 2);
        has_prediction_ = at_.model.distances(mark_, at_.shared.data(), at_.displacements_mm[std::size_t(mark_)].data(),
                                              distance, &by_shared_, &by_displacement_);
        if (!has_prediction_) return;
        const double share = 1.0 / std::sqrt(weighing.points_per_independent);
        for (Index k = 0; k < n; ++k) {
            const double z = distance[k] / weighing.noise_mm;
            const Cost c = cost(weighing.loss, z);
            const double root = std::sqrt(c.rho), weight = share * point_weights[k];
            const double rate = (root > 1e-9 ? std::abs(c.psi) / root : 1.0) / weighing.noise_mm * weight;
            residuals_[k] = std::copysign(root, z) * weight;
            by_shared_.row(k) *= rate;
            by_displacement_.row(k) *= displaced_ ? rate : 0.0;
        }
        for (Index i = 0; i < size; ++i)
            if (is_held_[std::size_t(i)]) by_shared_.col(i).setZero();
    }
    bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
        if (!has_prediction_) return false;
        std::copy_n(residuals_.data(), residuals_.size(), residuals);
        if (jacobians && jacobians[0]) std::copy_n(by_shared_.data(), by_shared_.size(), jacobians[0]);
        if (jacobians && jacobians[1]) std::copy_n(by_displacement_.data(), by_displacement_.size(), jacobians[1]);
        return true;
    }

 private:
    const MarkProblem& at_;
    Index mark_;
    const std::vector<bool>& is_held_;
    bool displaced_, has_prediction_ = false;
    VectorXd residuals_;
    RowMajor by_shared_, by_displacement_;
};

/// Evaluates all marks at the tried point once, on all processors, before Ceres requests them one by one.
class MarkCosts : public ceres::EvaluationCallback {
 public:
    explicit MarkCosts(const MarkProblem& at) : at_(at) {}
    void PrepareForEvaluation(bool, bool) override {
        std::vector<double> shared(at_.shared.begin(), at_.shared.end());
        if (shared == evaluated_shared_ && at_.displacements_mm == evaluated_displacements_mm_) return;
        evaluated_shared_ = std::move(shared);
        evaluated_displacements_mm_ = at_.displacements_mm;
        at_.model.for_each([&](Index mark) { all[std::size_t(mark)]->evaluate(); });
    }
    std::vector<std::unique_ptr<MarkCost>> all;

 private:
    const MarkProblem& at_;
    std::vector<double> evaluated_shared_;
    std::vector<Eigen::Vector2d> evaluated_displacements_mm_;
};

std::unique_ptr<ceres::CostFunction> normal_prior(const VectorXd& value, const VectorXd& sigma) {
    ceres::Matrix weight = ceres::Matrix::Zero(value.size(), value.size());
    for (Index i = 0; i < value.size(); ++i) weight(i, i) = sigma[i] == 0.0 ? 1.0 : 1.0 / sigma[i];
    return std::make_unique<ceres::NormalPrior>(weight, value);
}

/// Returns the rows of LawPrior over the shared unknowns.
MatrixXd law_prior_rows(const LawPrior& known, const MarkModel& model) {
    const Index laws = model.layout().front();
    MatrixXd rows(Index(known.rows.size()), laws);
    for (Index i = 0; i < rows.rows(); ++i)
        rows.row(i) = Eigen::Map<const Eigen::RowVectorXd>(known.rows[std::size_t(i)].data(), laws);
    MatrixXd out = MatrixXd::Zero(rows.rows(), model.layout().size());
    out.leftCols(laws) = rows * model.to_coefficients().topLeftCorner(laws, laws);
    return out;
}

double machine_sigma(const MarkOptions& options, int number) {
    if (number < MachineIndex::scale) return options.lean_mm_per_mm;
    if (number < MachineIndex::tilt) return options.axes;
    if (number < MachineIndex::backlash) return options.tilt_mm_per_mm;
    return number < MachineIndex::field ? options.backlash_mm : options.field_mm;
}

}  // namespace

MarkProblem::MarkProblem(const std::vector<PaintedMark>& marks, const MarkOptions& options, double coarse)
    : model(marks, options, coarse), displacement_mm_(options.displacement_mm) {
    const Layout& at = model.layout();
    priors_.assign(std::size_t(at.size()), {0.0, INFINITY});
    priors_[std::size_t(at.widest())] = options.widest_per_half;
    priors_[std::size_t(at.front())] = options.front_per_half;
    priors_[std::size_t(at.height())] = options.height_mm;
    for (int i = 0; i < 2; ++i) priors_[std::size_t(at.shift() + i)] = {0.0, options.placement_mm};
    priors_[std::size_t(at.turn())] = {0.0, options.turn_rad};
    for (int i = 0; i < at.machine_numbers; ++i)
        priors_[std::size_t(at.machine() + i)] = {0.0, machine_sigma(options, i)};
    if (options.laws && !options.laws->rows.empty()) {
        law_prior_rows_ = law_prior_rows(*options.laws, model);
        law_prior_mean_ = model.unlimited_unknowns(options.laws->laws);
    }
    hold_shape(false, false);
    shared = VectorXd::Zero(at.size());
    displacements_mm.assign(std::size_t(model.marks()), Eigen::Vector2d::Zero());
    for (Index i = 0; i < model.marks(); ++i) point_weights.push_back(VectorXd::Ones(model.points(i)));
}

void MarkProblem::start_at(const MarkLaws& laws) {
    const Layout& at = model.layout();
    shared = model.unknowns(laws);
    for (int i : {at.widest(), at.front(), at.height()}) shared[i] = priors_[std::size_t(i)].value;
    std::fill(displacements_mm.begin(), displacements_mm.end(), Eigen::Vector2d::Zero());
}

void MarkProblem::hold_shape(bool hold, bool hold_machine) {
    is_held_.resize(priors_.size());
    for (std::size_t i = 0; i < is_held_.size(); ++i) is_held_[i] = priors_[i].sigma == 0.0;
    const Layout& at = model.layout();
    if (hold) std::fill(is_held_.begin() + at.widest(), is_held_.begin() + at.height(), true);
    if (hold_machine) std::fill(is_held_.begin() + at.machine(), is_held_.end(), true);
    model.hold_machine(hold_machine);
}

void MarkProblem::set_departure_prior(const MatrixXd& rows) {
    law_prior_rows_ = rows;
    departs_ = rows.rows() > 0;
    law_prior_mean_ = VectorXd::Zero(shared.size());
}

VectorXd MarkProblem::losses() const {
    VectorXd out(model.marks());
    model.for_each([&](Index i) { out[i] = loss_of(i, displacements_mm[std::size_t(i)]); });
    return out;
}

double MarkProblem::loss() const {
    const VectorXd all = losses();
    return std::accumulate(all.begin(), all.end(), 0.0);
}

void MarkProblem::require_prediction() const {
    const VectorXd all = losses();
    for (Index i = 0; i < all.size(); ++i)
        if (!std::isfinite(all[i]))
            throw Error("fit-failed",
                        "the brush to start from paints no mark along this stroke: start from another brush, or leave "
                        "this stroke out",
                        model.stroke(i));
}

double MarkProblem::loss_of(Index mark, const Eigen::Vector2d& displacement) const {
    VectorXd distance;
    if (!model.distances(mark, shared.data(), displacement.data(), distance, nullptr, nullptr)) return INFINITY;
    const VectorXd rho = (distance / weighing.noise_mm).unaryExpr([&](double z) { return cost(weighing.loss, z).rho; });
    return 0.5 * point_weights[std::size_t(mark)].dot(rho) / weighing.points_per_independent;
}

void MarkProblem::ignore_narrow_points() {
    std::vector<VectorXd> width(displacements_mm.size());
    model.for_each([&](Index i) {
        width[std::size_t(i)] = model.widths(i, shared.data(), displacements_mm[std::size_t(i)].data());
    });
    std::vector<double> all;
    for (const VectorXd& one : width) all.insert(all.end(), one.begin(), one.end());
    if (all.empty()) return;
    const auto middle = all.begin() + std::ptrdiff_t(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    // For a pen, whose lines are narrow everywhere, the limit keeps the lines and leaves out only their ends.
    const double least = std::min(kMinWidthSigmas * weighing.noise_mm, 0.5 * *middle);
    for (Index i = 0; i < model.marks(); ++i)
        point_weights[std::size_t(i)] = (width[std::size_t(i)].array() >= least).cast<double>();
}

void MarkProblem::correct_displaced_marks() {
    if (!(displacement_mm_ > 0.0)) return;
    const auto loss_at = [&](Index mark, const Eigen::Vector2d& displacement) {
        return loss_of(mark, displacement) + 0.5 * displacement.squaredNorm() / (displacement_mm_ * displacement_mm_);
    };
    model.for_each([&](Index i) {
        Eigen::Vector2d& at = displacements_mm[std::size_t(i)];
        VectorXd distance;
        RowMajor by(model.points(i), shared.size()), by_displacement(model.points(i), 2);
        double now = loss_at(i, at);
        for (int round = 0; round < kMaxMoves; ++round) {
            if (!model.distances(i, shared.data(), at.data(), distance, &by, &by_displacement)) break;
            const auto far = (distance.array().abs() > kTukeySigmas * weighing.noise_mm).cast<double>();
            if (far.sum() < kMaxOutlierShare * double(distance.size())) break;
            const RowMajor rows = far.matrix().asDiagonal() * by_displacement;
            const Eigen::Matrix2d square = rows.transpose() * rows + 1e-9 * Eigen::Matrix2d::Identity();
            const Eigen::Vector2d moved = at - square.ldlt().solve(rows.transpose() * distance);
            const double then = loss_at(i, moved);
            if (!(then < now)) break;
            at = moved;
            now = then;
        }
    });
}

bool MarkProblem::solve(int max_iterations, double tolerance) {
    MarkCosts costs(*this);
    std::vector<std::unique_ptr<ceres::CostFunction>> priors;
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.evaluation_callback = &costs;
    ceres::Problem problem(options);
    ceres::Solver::Options solver;
    auto order = std::make_shared<ceres::ParameterBlockOrdering>();
    const bool displaced = displacement_mm_ > 0.0;
    for (Index i = 0; i < model.marks(); ++i) {
        double* mine = displacements_mm[std::size_t(i)].data();
        costs.all.push_back(std::make_unique<MarkCost>(*this, i, is_held_, displaced));
        problem.AddResidualBlock(costs.all.back().get(), nullptr, shared.data(), mine);
        priors.push_back(normal_prior(VectorXd::Zero(2), VectorXd::Constant(2, displacement_mm_)));
        problem.AddResidualBlock(priors.back().get(), nullptr, mine);
        order->AddElementToGroup(mine, 0);
    }
    VectorXd value(shared.size()), sigma(shared.size());
    for (Index i = 0; i < shared.size(); ++i) {
        value[i] = priors_[std::size_t(i)].value;
        sigma[i] = priors_[std::size_t(i)].sigma;
    }
    priors.push_back(normal_prior(value, sigma));
    problem.AddResidualBlock(priors.back().get(), nullptr, shared.data());
    if (law_prior_rows_.rows() > 0) {
        priors.push_back(std::make_unique<ceres::NormalPrior>(law_prior_rows_, law_prior_mean_));
        problem.AddResidualBlock(priors.back().get(), nullptr, shared.data());
    }
    order->AddElementToGroup(shared.data(), 1);
    const VectorXd least = model.lower_bounds();
    for (Index i = 0; i < shared.size(); ++i)
        if (least[i] > -1e5) problem.SetParameterLowerBound(shared.data(), int(i), least[i]);
    solver.linear_solver_type = ceres::DENSE_SCHUR;
    solver.linear_solver_ordering = order;
    solver.logging_type = ceres::SILENT;
    solver.max_num_iterations = max_iterations;
    solver.max_num_consecutive_invalid_steps = 20;
    solver.max_num_line_search_step_size_iterations = 0;
    solver.use_nonmonotonic_steps = true;
    solver.function_tolerance = tolerance;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    iterations += int(summary.iterations.size());
    return summary.IsSolutionUsable() && summary.termination_type == ceres::CONVERGENCE;
}

void MarkProblem::add_prior_information(MatrixXd& to) const {
    VectorXd sigma = VectorXd::Constant(shared.size() + 2 * model.marks(), displacement_mm_);
    for (Index i = 0; i < shared.size(); ++i) sigma[i] = priors_[std::size_t(i)].sigma;
    to.diagonal() += sigma.unaryExpr([](double s) { return s == 0.0 ? 1e12 : 1.0 / (s * s); });
    if (law_prior_rows_.rows() == 0) return;
    const Index g = shared.size();
    to.topLeftCorner(g, g) += law_prior_rows_.transpose() * law_prior_rows_;
}

VectorXd MarkProblem::prior_gradient() const {
    const Index g = shared.size();
    VectorXd out = VectorXd::Zero(g + 2 * model.marks());
    for (Index i = 0; i < g; ++i) {
        const Prior& prior = priors_[std::size_t(i)];
        if (prior.sigma > 0.0) out[i] = (shared[i] - prior.value) / (prior.sigma * prior.sigma);
    }
    if (displacement_mm_ > 0.0)
        for (Index i = 0; i < model.marks(); ++i)
            out.segment<2>(g + 2 * i) = displacements_mm[std::size_t(i)] / (displacement_mm_ * displacement_mm_);
    if (law_prior_rows_.rows() > 0)
        out.head(g) += law_prior_rows_.transpose() * (law_prior_rows_ * (shared - law_prior_mean_));
    return out;
}

}  // namespace brushsvg::fit
