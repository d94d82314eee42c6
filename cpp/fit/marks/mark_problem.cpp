#include "mark_problem.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace brushsvg::fit {
namespace {

constexpr double kFarShare = 0.2;  // of a mark's points, wild: it may be matched with the wrong edge
constexpr int kMoves = 3;
// Noises that a point must have across. With 2 the ends of strokes that are lifted while moving still draw the height,
// with 5 it is known a tenth less well than with 3.
constexpr double kSlim = 3.0;

// Where a step is to win less than this, half of chi-square, unknowns move by less than their standard deviations.
// There the loss leaps by as much and back wherever a point's nearest edge is another one, which says nothing of the
// step.
constexpr double kWithinNoise = 0.5, kLeap = 1.0;
constexpr double kLeastShare = 1e-3;  // of what a step is to win that it must win elsewhere
constexpr double kContracts = 0.5;    // of the step before: where steps within the noise are longer they have ended
constexpr int kMostRefused = 6;       // steps within the noise, of one descent
constexpr double kStiff = 1e-2;       // what damps less hardly shortens a step that went too far
constexpr double kFirstDamping = 1e-4, kLeastDamping = 1e-12, kMostDamping = 1e12;

double machine_sigma(const MarkOptions& options, int number) {
    if (number < MachineAt::scale) return options.lean_mm_per_mm;
    if (number < MachineAt::tilt) return options.axes;
    return number < MachineAt::backlash ? options.tilt_mm_per_mm : options.backlash_mm;
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
    if (!hold) return;
    const Layout& at = model.layout();
    held_[std::size_t(at.widest())] = held_[std::size_t(at.front())] = true;
    std::fill(held_.begin() + at.machine(), held_.end(), true);
}

double MarkProblem::loss() const {
    VectorXd losses(model.marks());
    model.for_each([&](Index i) { losses[i] = loss_of(i, own[std::size_t(i)]); });
    return std::accumulate(losses.begin(), losses.end(), 0.0);
}

double MarkProblem::loss_of(Index mark, const Eigen::Vector2d& displacement) const {
    VectorXd distance;
    if (!model.distances(mark, shared.data(), displacement.data(), distance, nullptr, nullptr)) return INFINITY;
    const VectorXd rho = (distance / weighing.noise_mm).unaryExpr([&](double z) { return cost(weighing.loss, z).rho; });
    return 0.5 * says[std::size_t(mark)].dot(rho) / weighing.repeats;
}

void MarkProblem::leave_slim_aside() {
    std::vector<VectorXd> width(own.size());
    model.for_each(
        [&](Index i) { width[std::size_t(i)] = model.widths(i, shared.data(), own[std::size_t(i)].data()); });
    std::vector<double> all;
    for (const VectorXd& one : width) all.insert(all.end(), one.begin(), one.end());
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
    model.for_each([&](Index i) {
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
    });
}

std::optional<LossNear> MarkProblem::near() const {
    const Index g = shared.size();
    std::vector<LossNear> parts(own.size());
    std::vector<char> is_painted(own.size());  // of its own byte each, for all processors
    model.for_each([&](Index i) { is_painted[std::size_t(i)] = near_of(i, parts[std::size_t(i)]); });
    if (std::find(is_painted.begin(), is_painted.end(), 0) != is_painted.end()) return std::nullopt;
    LossNear out{0.0, VectorXd::Zero(g), MatrixXd::Zero(g, g), {}};
    const double known = displacement_mm_ > 0.0 ? 1.0 / (displacement_mm_ * displacement_mm_) : 1.0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        out.loss += parts[i].loss + 0.5 * known * own[i].squaredNorm();
        out.slope += parts[i].slope;
        out.bend += parts[i].bend;
        LossNear::Own& mine = parts[i].own.front();
        mine.slope += known * own[i];
        mine.bend.diagonal().array() += known;
        out.own.push_back(std::move(mine));
    }
    for (Index i = 0; i < g; ++i) {
        const Prior& prior = priors_[std::size_t(i)];
        if (prior.sigma == 0.0) continue;
        const double weight = 1.0 / (prior.sigma * prior.sigma), off = shared[i] - prior.value;
        out.loss += 0.5 * weight * off * off;
        out.slope[i] += weight * off;
        out.bend(i, i) += weight;
    }
    return out;
}

bool MarkProblem::near_of(Index mark, LossNear& out) const {
    const Index n = model.points(mark), g = shared.size();
    RowMajor by = RowMajor::Zero(n, g + 2), by_shared = RowMajor::Zero(n, g), by_own = RowMajor::Zero(n, 2);
    VectorXd distance, pull(n);
    if (!model.distances(mark, shared.data(), own[std::size_t(mark)].data(), distance, &by_shared, &by_own))
        return false;
    const VectorXd& says = this->says[std::size_t(mark)];
    const double share = 1.0 / std::sqrt(weighing.repeats);
    out.loss = 0.0;
    for (Index k = 0; k < n; ++k) {  // rows of residuals whose squares add up to the loss
        const double z = distance[k] / weighing.noise_mm;
        const Cost c = cost(weighing.loss, z);
        const double root = std::sqrt(c.rho), weight = share * says[k];
        const double rate = (root > 1e-9 ? std::abs(c.psi) / root : 1.0) / weighing.noise_mm * weight;
        pull[k] = std::copysign(root, z) * weight;
        out.loss += 0.5 * pull[k] * pull[k];
        by.row(k).head(g) = rate * by_shared.row(k);
        if (displacement_mm_ > 0.0) by.row(k).tail<2>() = rate * by_own.row(k);
    }
    const VectorXd slope = by.transpose() * pull;
    MatrixXd bend = MatrixXd::Zero(g + 2, g + 2);
    bend.selfadjointView<Eigen::Lower>().rankUpdate(by.transpose());
    bend.triangularView<Eigen::StrictlyUpper>() = bend.transpose();
    out.slope = slope.head(g);
    out.bend = bend.topLeftCorner(g, g);
    out.own = {{slope.tail<2>(), bend.bottomRightCorner<2, 2>(), bend.topRightCorner(g, 2)}};
    return true;
}

void MarkProblem::move_by(const MarkStep& step) {
    shared += step.shared;
    for (std::size_t i = 0; i < own.size(); ++i) own[i] += step.own[i];
}

bool MarkProblem::solve(int most_iterations, double tolerance) {
    std::optional<LossNear> here = near();
    if (!here) return false;
    const VectorXd least = model.least();
    double damping = kFirstDamping, stiffer = 2.0, before = INFINITY;
    int refused = 0;
    for (int i = 0; i < most_iterations; ++i) {
        ++iterations;
        const MarkStep step = step_to_least(*here, shared, least, held_, damping);
        const bool is_within_noise = step.gain < kWithinNoise && damping <= kFirstDamping;
        if (!(step.gain > tolerance * here->loss) || (is_within_noise && step.gain > kContracts * before)) return true;
        const VectorXd shared_before = shared;
        const std::vector<Eigen::Vector2d> own_before = own;
        move_by(step);
        std::optional<LossNear> there = near();
        const double won = there ? here->loss - there->loss : -INFINITY;
        if (won > kLeastShare * step.gain || (is_within_noise && won > -kLeap)) {
            const double good = std::min(1.0, won / step.gain);
            damping = std::max(kLeastDamping, damping * std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * good - 1.0, 3)));
            if (is_within_noise) damping = std::min(damping, kFirstDamping);
            stiffer = 2.0;
            before = is_within_noise ? step.gain : INFINITY;
            here = std::move(there);
            continue;
        }
        shared = shared_before;
        own = own_before;
        if (step.gain < kWithinNoise && ++refused > kMostRefused) return true;
        damping = std::max(damping, kStiff) * stiffer;
        stiffer *= 2.0;
        if (damping > kMostDamping) return true;
    }
    return false;
}

VectorXd MarkProblem::known() const {
    VectorXd sigma = VectorXd::Constant(shared.size() + 2 * model.marks(), displacement_mm_);
    for (Index i = 0; i < shared.size(); ++i) sigma[i] = priors_[std::size_t(i)].sigma;
    return sigma.unaryExpr([](double s) { return s == 0.0 ? 1e12 : 1.0 / (s * s); });
}

}  // namespace brushsvg::fit
