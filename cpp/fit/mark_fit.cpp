#include "mark_fit.hpp"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "brushsvg/error.hpp"
#include "mark_doubts.hpp"
#include "mark_model.hpp"

namespace brushsvg::fit {
namespace {

constexpr double kHuber = 1.345, kTukey = 4.685;  // each 95 % as sharp as least squares on normal noise
constexpr double kFirstNoiseMm = 0.5;             // while nothing is known: a brush's hairs
// No picture of paint is surer, and what the laws cannot follow of a very clean one must not count as wild.
constexpr double kLeastNoiseMm = 0.05;
constexpr int kScanned = 3;  // starts that are followed a few steps

/// What a distance costs, in standard deviations z: rho(z), psi = rho'/2, its slope.
struct Cost {
    double rho, psi, slope;
};
enum class Loss { huber, tukey };
Cost cost(Loss loss, double z) {
    if (loss == Loss::tukey) {
        const double c2 = kTukey * kTukey, t = 1.0 - z * z / c2;
        if (t <= 0.0) return {c2 / 3.0, 0.0, 0.0};
        return {c2 / 3.0 * (1.0 - t * t * t), z * t * t, t * (t - 4.0 * z * z / c2)};
    }
    if (std::abs(z) <= kHuber) return {z * z, z, 1.0};
    return {2.0 * kHuber * std::abs(z) - kHuber * kHuber, std::copysign(kHuber, z), 0.0};
}

/// How sure one distance is, and what wild ones cost.
struct Weighing {
    double noise_mm = kFirstNoiseMm, repeats = 1.0;  ///< so many neighbours tell as much as one
    Loss loss = Loss::huber;
};

/// One mark for the solver: residuals whose squares add up to the loss.
class MarkCost : public ceres::CostFunction {
 public:
    MarkCost(const MarkModel& model, Index mark, const Weighing& weighing, const std::vector<bool>& held,
             bool displaced)
        : model_(model), mark_(mark), weighing_(weighing), held_(held), displaced_(displaced) {
        set_num_residuals(int(model.points(mark)));
        *mutable_parameter_block_sizes() = {model.layout().size(), 2};
    }
    bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
        const Index n = num_residuals(), size = model_.layout().size();
        VectorXd distance;
        RowMajor shared, own;
        if (jacobians) {
            shared.setZero(n, size);
            own.setZero(n, 2);
        }
        if (!model_.distances(mark_, x[0], x[1], distance, jacobians ? &shared : nullptr, jacobians ? &own : nullptr))
            return false;
        for (Index k = 0; k < n; ++k) {
            const double z = distance[k] / weighing_.noise_mm;
            const Cost c = cost(weighing_.loss, z);
            const double root = std::sqrt(c.rho);
            residuals[k] = std::copysign(root, z) / std::sqrt(weighing_.repeats);
            if (!jacobians) continue;
            const double rate =
                (root > 1e-9 ? std::abs(c.psi) / root : 1.0) / weighing_.noise_mm / std::sqrt(weighing_.repeats);
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
};

/// The whole problem at one place: unknowns that all marks share, and two for each mark.
class Fit {
 public:
    Fit(const std::vector<PaintedMark>& marks, const MarkOptions& options) : model(marks, options), options_(options) {
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
    }
    void begin(const MarkLaws& laws) {
        const Layout& at = model.layout();
        shared = model.unknowns(laws);
        shared[at.widest()] = priors_[std::size_t(at.widest())].value;
        shared[at.front()] = priors_[std::size_t(at.front())].value;
        shared[at.height()] = priors_[std::size_t(at.height())].value;
        std::fill(own.begin(), own.end(), Eigen::Vector2d::Zero());
    }

    /// The footprint's shape stays as it is, besides what is known.
    void hold_shape(bool hold) {
        held.resize(priors_.size());
        for (std::size_t i = 0; i < held.size(); ++i) held[i] = priors_[i].sigma == 0.0;
        if (hold) held[std::size_t(model.layout().widest())] = held[std::size_t(model.layout().front())] = true;
    }

    /// Half the loss of all marks; infinite where there is no prediction.
    double loss() const {
        double sum = 0.0;
        VectorXd distance;
        for (Index i = 0; i < model.marks(); ++i) {
            if (!model.distances(i, shared.data(), own[std::size_t(i)].data(), distance, nullptr, nullptr))
                return INFINITY;
            for (double d : distance) sum += cost(weighing.loss, d / weighing.noise_mm).rho;
        }
        return 0.5 * sum / weighing.repeats;
    }

    bool solve(int most_iterations) {
        ceres::Problem problem;
        ceres::Solver::Options solver;
        auto order = std::make_shared<ceres::ParameterBlockOrdering>();
        const bool displaced = options_.displacement_mm > 0.0;
        for (Index i = 0; i < model.marks(); ++i) {
            double* mine = own[std::size_t(i)].data();
            problem.AddResidualBlock(new MarkCost(model, i, weighing, held, displaced), nullptr, shared.data(), mine);
            problem.AddResidualBlock(prior(VectorXd::Zero(2), VectorXd::Constant(2, options_.displacement_mm)), nullptr,
                                     mine);
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
        solver.function_tolerance = 1e-7;
        ceres::Solver::Summary summary;
        ceres::Solve(solver, &problem, &summary);
        iterations += int(summary.iterations.size());
        return summary.IsSolutionUsable() && summary.termination_type == ceres::CONVERGENCE;
    }

    /// Noise and how far it reaches along an outline, from the distances at the solution.
    void weigh() {
        std::vector<double> size;
        std::vector<VectorXd> all(std::size_t(model.marks()));
        for (Index i = 0; i < model.marks(); ++i) {
            model.distances(i, shared.data(), own[std::size_t(i)].data(), all[std::size_t(i)], nullptr, nullptr);
            for (double d : all[std::size_t(i)]) size.push_back(std::abs(d));
        }
        const auto middle = size.begin() + std::ptrdiff_t(size.size() / 2);
        std::nth_element(size.begin(), middle, size.end());
        weighing.noise_mm = std::max(kLeastNoiseMm, 1.482602218505602 * *middle);
        // integral of the autocorrelation of what the loss lets through, until it is lost in noise
        std::vector<double> products;
        for (Index i = 0; i < model.marks(); ++i)
            for (std::size_t r = 0; r < model.rings(i); ++r) {
                const Index begin = model.ring_begin(i, r), n = model.ring_begin(i, r + 1) - begin;
                if (Index(products.size()) < n / 2) products.resize(std::size_t(n / 2), 0.0);
                VectorXd psi(n);
                for (Index k = 0; k < n; ++k)
                    psi[k] = cost(weighing.loss, all[std::size_t(i)][begin + k] / weighing.noise_mm).psi;
                for (Index lag = 0; lag < n / 2; ++lag) {
                    double sum = 0.0;
                    for (Index k = 0; k < n; ++k) sum += psi[k] * psi[(k + lag) % n];
                    products[std::size_t(lag)] += sum;
                }
            }
        weighing.repeats = 1.0;
        for (std::size_t lag = 1; lag + 1 < products.size(); lag += 2) {
            const double pair = (products[lag] + products[lag + 1]) / products[0];
            if (!(pair > 0.0)) break;
            weighing.repeats += 2.0 * pair;
        }
    }

    /// Inverse of the information of shared unknowns and displacements, priors included; of the shared ones alone.
    MatrixXd covariance(bool expected) const {
        const Index g = shared.size(), all = g + 2 * model.marks();
        MatrixXd slope = MatrixXd::Zero(all, all), spread = slope;
        for (Index i = 0; i < model.marks(); ++i) {
            RowMajor by(model.points(i), g), mine(model.points(i), 2);
            VectorXd distance;
            model.distances(i, shared.data(), own[std::size_t(i)].data(), distance, &by, &mine);
            for (Index k = 0; k < distance.size(); ++k) {
                const Cost c = expected ? Cost{0, 1, 1} : cost(weighing.loss, distance[k] / weighing.noise_mm);
                VectorXd row(g + 2);
                row << by.row(k).transpose(), mine.row(k).transpose();
                row /= weighing.noise_mm * std::sqrt(weighing.repeats);
                const MatrixXd square = row * row.transpose();
                const auto add = [&](MatrixXd& to, double weight) {
                    to.topLeftCorner(g, g) += weight * square.topLeftCorner(g, g);
                    to.block(0, g + 2 * i, g, 2) += weight * square.topRightCorner(g, 2);
                    to.block(g + 2 * i, 0, 2, g) += weight * square.bottomLeftCorner(2, g);
                    to.block(g + 2 * i, g + 2 * i, 2, 2) += weight * square.bottomRightCorner(2, 2);
                };
                add(slope, std::max(0.0, c.slope));
                add(spread, c.psi * c.psi);
            }
        }
        // fitted unknowns took their share of the residuals
        double samples = 0.0;
        for (Index i = 0; i < model.marks(); ++i) samples += double(model.points(i));
        const double effective = samples / weighing.repeats, freedom = std::max(1.0, effective - double(all));
        if (!expected) spread *= std::max(1.0, effective / freedom);
        VectorXd known = VectorXd::Constant(all, options_.displacement_mm);
        for (Index i = 0; i < g; ++i) known[i] = priors_[std::size_t(i)].sigma;
        for (Index i = 0; i < all; ++i) {
            const double information = known[i] == 0.0 ? 1e12 : 1.0 / (known[i] * known[i]);
            slope(i, i) += information;
            spread(i, i) += information;
        }
        // in units of the unknowns' own sizes, or a polynomial's powers would drown each other
        const VectorXd unit = slope.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
        const MatrixXd scaled = unit.asDiagonal() * slope * unit.asDiagonal();
        const MatrixXd inverse =
            unit.asDiagonal() * scaled.ldlt().solve(MatrixXd::Identity(all, all)) * unit.asDiagonal();
        return (inverse * spread * inverse).topLeftCorner(g, g);
    }

    MarkModel model;
    Weighing weighing;
    std::vector<bool> held;
    VectorXd shared;
    std::vector<Eigen::Vector2d> own;
    int iterations = 0;

 private:
    static ceres::CostFunction* prior(const VectorXd& value, const VectorXd& sigma) {
        ceres::Matrix weight = ceres::Matrix::Zero(value.size(), value.size());
        for (Index i = 0; i < value.size(); ++i) weight(i, i) = sigma[i] == 0.0 ? 1.0 : 1.0 / sigma[i];
        return new ceres::NormalPrior(weight, value);
    }
    const MarkOptions& options_;
    std::vector<Prior> priors_;
};

/// Half width per depth from the marks' areas: what is painted, over how far it was painted.
double width_rate(const std::vector<PaintedMark>& marks) {
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

/// Starts with lags of many lengths, the same at all depths or longer with depth; the best are followed a little.
void scan(Fit& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options) {
    const double rate = std::clamp(width_rate(marks), 0.02, 50.0), deepest = options.deepest_mm;
    std::vector<std::pair<double, MarkLaws>> tried;
    for (double lag : {0.3, 1.0, 2.0, 3.5, 5.0, 7.5, 10.0, 14.0, 20.0, 30.0})
        for (double share : {1.0, 0.3}) {  // of it at depth 0
            MarkLaws laws;
            laws.lag = {lag * share, lag * (1.0 - share) / deepest};
            laws.tip_gap = {0.0, 1.2 * rate};
            laws.half_width = {0.0, rate};
            if (options.lag_terms == 1) {
                if (share < 1.0) continue;
                laws.lag.pop_back();
            }
            fit.begin(laws);
            tried.emplace_back(fit.loss(), laws);
        }
    std::stable_sort(tried.begin(), tried.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    double best = INFINITY;
    VectorXd shared;
    std::vector<Eigen::Vector2d> own;
    for (std::size_t i = 0; i < std::min<std::size_t>(kScanned, tried.size()); ++i) {
        fit.begin(tried[i].second);
        fit.solve(8);
        const double now = fit.loss();
        if (!(now < best)) continue;
        best = now;
        shared = fit.shared;
        own = fit.own;
    }
    if (!std::isfinite(best))
        throw Error("no lag that was tried predicts these marks: are plan and marks those of one sheet?");
    fit.shared = shared;
    fit.own = own;
}

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

}  // namespace

MarkFit fit_marks(const std::vector<PaintedMark>& marks, const std::optional<MarkLaws>& start,
                  const MarkOptions& options) {
    refuse_what_cannot_be_fitted(marks, options);
    Fit fit(marks, options);
    MarkFit out;
    if (options.noise_mm) {
        if (!start) throw Error("to say what to expect takes a brush to start from");
        fit.begin(*start);
        fit.shared[fit.model.layout().widest()] = start->widest_per_half;
        fit.shared[fit.model.layout().front()] = start->front_per_half;
        fit.weighing.noise_mm = std::max(1e-3, *options.noise_mm);
        // noise that forgets itself as exp(-s / length)
        const double kept = std::exp(-options.spacing_mm / std::max(1e-6, options.noise_length_mm));
        fit.weighing.repeats = (1.0 + kept) / (1.0 - kept);
    } else {
        if (start)
            fit.begin(*start);
        else {
            fit.hold_shape(true);
            scan(fit, marks, options);
            fit.solve(options.most_iterations);
            fit.hold_shape(false);
        }
        for (const Loss loss : {Loss::huber, Loss::huber, Loss::tukey, Loss::tukey}) {
            fit.weighing.loss = loss;
            out.converged = fit.solve(options.most_iterations);
            fit.weigh();
        }
    }
    const bool expected = options.noise_mm.has_value();
    out.laws = fit.model.laws(fit.shared);
    const MatrixXd to = fit.model.to_coefficients();
    const MatrixXd covariance = to * fit.covariance(expected) * to.transpose();
    for (Index i = 0; i < covariance.rows(); ++i) {
        const VectorXd row = covariance.row(i).transpose();
        out.covariance.emplace_back(row.data(), row.data() + row.size());
    }
    const Layout& at = fit.model.layout();
    out.height_mm = fit.shared[at.height()];
    out.turn_rad = fit.shared[at.turn()];
    out.shift_mm = {fit.shared[at.shift()], fit.shared[at.shift() + 1]};
    out.centre_mm = fit.model.centre_mm();
    out.noise_mm = fit.weighing.noise_mm;
    out.iterations = fit.iterations;
    double aside = 0.0;
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
        const double wild = double((distance.array().abs() > kTukey * out.noise_mm).count());
        miss.outlier = wild > 0.5 * double(distance.size());
        aside += wild;
        out.samples += double(distance.size());
        out.marks.push_back(std::move(miss));
    }
    out.left_aside = aside / std::max(1.0, out.samples);
    out.effective_samples = out.samples / fit.weighing.repeats;
    out.remarks = doubts(fit.model, fit.shared, fit.own, fit.weighing.noise_mm * std::sqrt(fit.weighing.repeats));
    return out;
}

}  // namespace brushsvg::fit
