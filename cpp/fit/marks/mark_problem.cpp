#include "mark_problem.hpp"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg::fit {
namespace {

constexpr double kFarShare = 0.2;  // of a mark's points, wild: it may be matched with the wrong edge
constexpr int kMoves = 3;
// Noises that a point must have across. With 2 the ends of strokes that are lifted while moving still draw the height,
// with 5 it is known a tenth less well than with 3.
constexpr double kSlim = 3.0;

/// One mark for the solver: residuals whose squares add up to the loss.
class MarkCost : public ceres::CostFunction {
 public:
    MarkCost(const MarkModel& model, Index mark, const Weighing& weighing, const std::vector<bool>& held,
             bool displaced, const VectorXd& says)
        : model_(model), mark_(mark), weighing_(weighing), held_(held), displaced_(displaced), says_(says) {
        set_num_residuals(int(model.points(mark)));
        *mutable_parameter_block_sizes() = {model.layout().size(), 2};
    }
    bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
        checkpoint(500);
        const Index n = num_residuals(), size = model_.layout().size();
        VectorXd distance;
        RowMajor shared, own;
        if (jacobians) {
            shared.setZero(n, size);
            own.setZero(n, 2);
        }
        if (!model_.distances(mark_, x[0], x[1], distance, jacobians ? &shared : nullptr, jacobians ? &own : nullptr))
            return false;
        const double share = 1.0 / std::sqrt(weighing_.repeats);
        for (Index k = 0; k < n; ++k) {
            const double z = distance[k] / weighing_.noise_mm;
            const Cost c = cost(weighing_.loss, z);
            const double root = std::sqrt(c.rho);
            residuals[k] = std::copysign(root, z) * share * says_[k];
            if (!jacobians) continue;
            const double rate = (root > 1e-9 ? std::abs(c.psi) / root : 1.0) / weighing_.noise_mm * share * says_[k];
            if (jacobians[0]) {
                Eigen::Map<RowMajor> out(jacobians[0], n, size);
                out.row(k) = rate * shared.row(k);
                for (Index i = 0; i < size; ++i)
                    if (held_[std::size_t(i)]) out(k, i) = 0.0;
            }
            if (jacobians[1]) Eigen::Map<RowMajor>(jacobians[1], n, 2).row(k) = (displaced_ ? rate : 0.0) * own.row(k);
        }
        return true;
    }

 private:
    const MarkModel& model_;
    Index mark_;
    const Weighing& weighing_;
    const std::vector<bool>& held_;
    bool displaced_;
    const VectorXd& says_;
};

ceres::CostFunction* prior(const VectorXd& value, const VectorXd& sigma) {
    ceres::Matrix weight = ceres::Matrix::Zero(value.size(), value.size());
    for (Index i = 0; i < value.size(); ++i) weight(i, i) = sigma[i] == 0.0 ? 1.0 : 1.0 / sigma[i];
    return new ceres::NormalPrior(weight, value);
}

}  // namespace

MarkProblem::MarkProblem(const std::vector<PaintedMark>& marks, const MarkOptions& options)
    : model(marks, options), displacement_mm_(options.displacement_mm) {
    const Layout& at = model.layout();
    priors_.assign(std::size_t(at.size()), {0.0, INFINITY});
    priors_[std::size_t(at.widest())] = options.widest_per_half;
    priors_[std::size_t(at.front())] = options.front_per_half;
    priors_[std::size_t(at.height())] = options.height_mm;
    for (int i = 0; i < 2; ++i) priors_[std::size_t(at.shift() + i)] = {0.0, options.placement_mm};
    priors_[std::size_t(at.turn())] = {0.0, options.turn_rad};
    hold_shape(false);
    shared = VectorXd::Zero(at.size());
    own.assign(std::size_t(model.marks()), Eigen::Vector2d::Zero());
    for (Index i = 0; i < model.marks(); ++i) says.push_back(VectorXd::Ones(model.points(i)));
}

void MarkProblem::begin(const MarkLaws& laws) {
    const Layout& at = model.layout();
    shared = model.unknowns(laws);
    for (int i : {at.widest(), at.front(), at.height()}) shared[i] = priors_[std::size_t(i)].value;
    std::fill(own.begin(), own.end(), Eigen::Vector2d::Zero());
}

void MarkProblem::hold_shape(bool hold) {
    held_.resize(priors_.size());
    for (std::size_t i = 0; i < held_.size(); ++i) held_[i] = priors_[i].sigma == 0.0;
    if (hold) held_[std::size_t(model.layout().widest())] = held_[std::size_t(model.layout().front())] = true;
}

double MarkProblem::loss() const {
    double sum = 0.0;
    for (Index i = 0; i < model.marks(); ++i) sum += loss_of(i, own[std::size_t(i)]);
    return sum;
}

double MarkProblem::loss_of(Index mark, const Eigen::Vector2d& displacement) const {
    VectorXd distance;
    if (!model.distances(mark, shared.data(), displacement.data(), distance, nullptr, nullptr)) return INFINITY;
    const VectorXd rho = (distance / weighing.noise_mm).unaryExpr([&](double z) { return cost(weighing.loss, z).rho; });
    return 0.5 * says[std::size_t(mark)].dot(rho) / weighing.repeats;
}

void MarkProblem::leave_slim_aside() {
    std::vector<VectorXd> width;
    std::vector<double> all;
    for (Index i = 0; i < model.marks(); ++i) {
        width.push_back(model.widths(i, shared.data(), own[std::size_t(i)].data()));
        all.insert(all.end(), width.back().begin(), width.back().end());
    }
    if (all.empty()) return;
    const auto middle = all.begin() + std::ptrdiff_t(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    // of a pen, whose lines are no wider anywhere, the lines and not their ends
    const double least = std::min(kSlim * weighing.noise_mm, 0.5 * *middle);
    for (Index i = 0; i < model.marks(); ++i)
        says[std::size_t(i)] = (width[std::size_t(i)].array() >= least).cast<double>();
}

void MarkProblem::find_displaced() {
    if (!(displacement_mm_ > 0.0)) return;
    const auto loss_at = [&](Index mark, const Eigen::Vector2d& displacement) {
        return loss_of(mark, displacement) + 0.5 * displacement.squaredNorm() / (displacement_mm_ * displacement_mm_);
    };
    for (Index i = 0; i < model.marks(); ++i) {
        Eigen::Vector2d& at = own[std::size_t(i)];
        VectorXd distance;
        RowMajor by(model.points(i), shared.size()), by_own(model.points(i), 2);
        double now = loss_at(i, at);
        for (int round = 0; round < kMoves; ++round) {
            if (!model.distances(i, shared.data(), at.data(), distance, &by, &by_own)) break;
            const auto far = (distance.array().abs() > kTukey * weighing.noise_mm).cast<double>();
            if (far.sum() < kFarShare * double(distance.size())) break;
            const RowMajor rows = far.matrix().asDiagonal() * by_own;
            const Eigen::Matrix2d square = rows.transpose() * rows + 1e-9 * Eigen::Matrix2d::Identity();
            const Eigen::Vector2d moved = at - square.ldlt().solve(rows.transpose() * distance);
            const double then = loss_at(i, moved);
            if (!(then < now)) break;
            at = moved;
            now = then;
        }
    }
}

bool MarkProblem::solve(int most_iterations, double tolerance) {
    ceres::Problem problem;
    ceres::Solver::Options solver;
    auto order = std::make_shared<ceres::ParameterBlockOrdering>();
    const bool displaced = displacement_mm_ > 0.0;
    for (Index i = 0; i < model.marks(); ++i) {
        double* mine = own[std::size_t(i)].data();
        problem.AddResidualBlock(new MarkCost(model, i, weighing, held_, displaced, says[std::size_t(i)]), nullptr,
                                 shared.data(), mine);
        problem.AddResidualBlock(prior(VectorXd::Zero(2), VectorXd::Constant(2, displacement_mm_)), nullptr, mine);
        order->AddElementToGroup(mine, 0);
    }
    VectorXd value(shared.size()), sigma(shared.size());
    for (Index i = 0; i < shared.size(); ++i) {
        value[i] = priors_[std::size_t(i)].value;
        sigma[i] = priors_[std::size_t(i)].sigma;
    }
    problem.AddResidualBlock(prior(value, sigma), nullptr, shared.data());
    order->AddElementToGroup(shared.data(), 1);
    const VectorXd least = model.least();
    for (Index i = 0; i < shared.size(); ++i)
        if (least[i] > -1e5) problem.SetParameterLowerBound(shared.data(), int(i), least[i]);
    solver.linear_solver_type = ceres::DENSE_SCHUR;
    solver.linear_solver_ordering = order;
    solver.logging_type = ceres::SILENT;
    solver.max_num_iterations = most_iterations;
    solver.max_num_consecutive_invalid_steps = 20;
    solver.function_tolerance = tolerance;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    iterations += int(summary.iterations.size());
    return summary.IsSolutionUsable() && summary.termination_type == ceres::CONVERGENCE;
}

VectorXd MarkProblem::known() const {
    VectorXd sigma = VectorXd::Constant(shared.size() + 2 * model.marks(), displacement_mm_);
    for (Index i = 0; i < shared.size(); ++i) sigma[i] = priors_[std::size_t(i)].sigma;
    return sigma.unaryExpr([](double s) { return s == 0.0 ? 1e12 : 1.0 / (s * s); });
}

}  // namespace brushsvg::fit
