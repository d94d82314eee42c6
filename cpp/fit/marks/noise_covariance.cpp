#include "noise_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/run_cancellable.hpp"
#include "brushsvg/checkpoint.hpp"
#include "no_brush.hpp"

namespace brushsvg::fit {
namespace {

// No picture of paint has less noise. In a very clean picture, misfits of the laws must not count as outliers.
constexpr double kMinNoiseMm = 0.05;
constexpr int kScaleRounds = 5;
constexpr Index kMaxLagPoints = 60;  // largest number of points between correlated errors on an outline

/// A mark's distances and their derivatives by the shared unknowns and the mark's displacement.
struct MarkDerivatives {
    VectorXd distance_mm;
    MatrixXd by;
    VectorXd point_weights;
};
std::vector<MarkDerivatives> evaluate_marks(const MarkProblem& at) {
    std::vector<MarkDerivatives> out(at.displacements_mm.size());
    const Index g = at.shared.size();
    at.model.for_each([&](Index i) {
        RowMajor by(at.model.points(i), g), own(at.model.points(i), 2);
        MarkDerivatives& derivatives = out[std::size_t(i)];
        if (!at.model.distances(i, at.shared.data(), at.displacements_mm[std::size_t(i)].data(),
                                derivatives.distance_mm, &by, &own))
            throw no_brush_error(at.model.stroke(i));
        derivatives.by.resize(by.rows(), g + 2);
        derivatives.by << by, own;
        derivatives.point_weights = at.point_weights[std::size_t(i)];
        derivatives.by = derivatives.point_weights.asDiagonal() * derivatives.by;
    });
    return out;
}

/// Leaves out outliers.
void drop_outliers(std::vector<MarkDerivatives>& marks, const Weighing& weighing) {
    if (weighing.loss != Loss::tukey) return;
    for (MarkDerivatives& mark : marks)
        for (Index k = 0; k < mark.by.rows(); ++k)
            if (std::abs(mark.distance_mm[k]) >= kTukeySigmas * weighing.noise_mm) {
                mark.by.row(k).setZero();
                mark.point_weights[k] = 0.0;
            }
}

/// Adds a mark's matrix over its own unknowns to a matrix over all unknowns.
void add(MatrixXd& to, const MatrixXd& square, Index mark, Index shared) {
    const Index own = shared + 2 * mark;
    to.topLeftCorner(shared, shared) += square.topLeftCorner(shared, shared);
    to.block(0, own, shared, 2) += square.topRightCorner(shared, 2);
    to.block(own, 0, 2, shared) += square.bottomLeftCorner(2, shared);
    to.block(own, own, 2, 2) += square.bottomRightCorner(2, 2);
}

/// Returns the second derivatives of the loss, without priors.
MatrixXd loss_hessian(const MarkProblem& at, const std::vector<MarkDerivatives>& marks, const Weighing& weighing) {
    const Index g = at.shared.size(), all = g + 2 * at.model.marks();
    MatrixXd slope = MatrixXd::Zero(all, all);
    const double weight = weighing.slope / (weighing.noise_mm * weighing.noise_mm * weighing.points_per_independent);
    for (Index i = 0; i < at.model.marks(); ++i) {
        const MatrixXd& by = marks[std::size_t(i)].by;
        add(slope, weight * (by.transpose() * by), i, g);
    }
    return slope;
}

/// Returns the inverse of the second derivatives of the loss with priors.
MatrixXd inverse_hessian(const MarkProblem& at, const std::vector<MarkDerivatives>& marks, const Weighing& weighing) {
    const Index all = at.shared.size() + 2 * at.model.marks();
    MatrixXd slope = loss_hessian(at, marks, weighing);
    at.add_prior_information(slope);
    // In units of the unknowns' own sizes, because the powers of a polynomial have very different magnitudes.
    const VectorXd unit = slope.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = unit.asDiagonal() * slope * unit.asDiagonal();
    const MatrixXd inverse = run_cancellable(  // seconds for a thousand marks
        [scaled, all]() -> MatrixXd { return scaled.ldlt().solve(MatrixXd::Identity(all, all)); });
    return unit.asDiagonal() * inverse * unit.asDiagonal();
}

/// Returns the part of an inverse over all unknowns that affects one mark's distances.
MatrixXd mark_block(const MatrixXd& inverse, Index mark, Index shared) {
    const Index own = shared + 2 * mark;
    MatrixXd out(shared + 2, shared + 2);
    out << inverse.topLeftCorner(shared, shared), inverse.block(0, own, shared, 2), inverse.block(own, 0, 2, shared),
        inverse.block(own, own, 2, 2);
    return out;
}

/// Returns how much each mark alone moves the shared unknowns (g, marks), against all other marks.
MatrixXd mark_influences(const MarkProblem& at, const std::vector<MarkDerivatives>& marks, const MatrixXd& inverse) {
    const Weighing& weighing = at.weighing;
    const Index g = at.shared.size();
    MatrixXd out(g, at.model.marks());
    for (Index i = 0; i < at.model.marks(); ++i) {
        const MarkDerivatives& mark = marks[std::size_t(i)];
        const VectorXd psi =
            (mark.distance_mm / weighing.noise_mm).unaryExpr([&](double z) { return cost(weighing.loss, z).psi; });
        const VectorXd pull = mark.by.transpose() * psi / (weighing.noise_mm * weighing.points_per_independent);
        out.col(i) = inverse.topLeftCorner(g, g) * pull.head(g) + inverse.block(0, g + 2 * i, g, 2) * pull.tail<2>();
    }
    return out;
}

/// Raises the covariance in directions in which groups of marks disagree by more than their noise explains.
MatrixXd inflate_by_disagreement(const MatrixXd& covariance, const MatrixXd& pulls) {
    const Index g = covariance.rows(), groups = pulls.cols();
    const VectorXd unit = covariance.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(unit.asDiagonal() * covariance * unit.asDiagonal());
    const VectorXd root = eigen.eigenvalues().cwiseMax(1e-9 * eigen.eigenvalues()[g - 1]).cwiseSqrt();
    const MatrixXd whitened =
        root.cwiseInverse().asDiagonal() * (eigen.eigenvectors().transpose() * (unit.asDiagonal() * pulls));
    const Eigen::SelfAdjointEigenSolver<MatrixXd> apart(whitened * whitened.transpose());
    const double by_chance =
        std::pow(1.0 + std::sqrt(double(g) / double(groups)), 2);  // largest eigenvalue of white noise
    const VectorXd more = apart.eigenvalues().unaryExpr([&](double v) { return v > by_chance ? v - 1.0 : 0.0; });
    const MatrixXd back =
        unit.cwiseInverse().asDiagonal() * (eigen.eigenvectors() * (root.asDiagonal() * apart.eigenvectors()));
    return covariance + back * more.asDiagonal() * back.transpose();
}

/// Adds errors beyond the noise that are common to a mark, or to all marks of a depth.
MatrixXd add_misfit(const MatrixXd& covariance, const MatrixXd& pulls, const MarkProblem& at) {
    constexpr double kDepthClassShare = 0.02;  // as a share of the greatest depth
    std::vector<double> depths;
    for (Index i = 0; i < pulls.cols(); ++i) depths.push_back(at.model.deepest(i));
    const double most = *std::max_element(depths.begin(), depths.end());
    std::map<long, Index> group;
    for (const double d : depths) group.try_emplace(std::lround(d / (kDepthClassShare * most)), Index(group.size()));
    MatrixXd by_depth = MatrixXd::Zero(pulls.rows(), Index(group.size()));
    for (Index i = 0; i < pulls.cols(); ++i)
        by_depth.col(group[std::lround(depths[std::size_t(i)] / (kDepthClassShare * most))]) += pulls.col(i);
    return inflate_by_disagreement(inflate_by_disagreement(covariance, pulls), by_depth);
}

/// Sums of products of two points on one closed outline, by their distance in points, and the number of pairs that
/// count.
struct OutlineCorrelation {
    std::vector<double> sum, pairs;
    template <class Counts, class Product>
    void add(Index begin, Index end, Counts&& counts, Product&& product) {
        const Index n = end - begin, farthest = std::min(kMaxLagPoints, (n + 1) / 2);
        if (Index(sum.size()) < farthest) {
            sum.resize(std::size_t(farthest), 0.0);
            pairs.resize(std::size_t(farthest), 0.0);
        }
        for (Index lag = 0; lag < farthest; ++lag) {
            checkpoint(int(n));
            for (Index k = 0; k < n; ++k) {
                const Index a = begin + k, b = begin + (k + lag) % n;
                if (!counts(a) || !counts(b)) continue;
                sum[std::size_t(lag)] += product(a, b);
                pairs[std::size_t(lag)] += 1.0;
            }
        }
    }
    double mean(std::size_t lag) const { return sum[lag] / std::max(1.0, pairs[lag]); }
};

}  // namespace

std::vector<double> as_moving_average(const std::vector<double>& autocovariance) {
    constexpr int kFrequencies = 1024;
    const int lags = int(autocovariance.size());
    std::vector<double> cosine(kFrequencies), weights(std::size_t(2 * lags - 1), 0.0), out(std::size_t(2 * lags - 1));
    for (int k = 0; k < kFrequencies; ++k) cosine[std::size_t(k)] = std::cos(2.0 * M_PI * k / kFrequencies);
    double whole = 0.0, sum = 0.0;
    for (int lag = 0; lag < lags; ++lag) whole += (lag ? 2.0 : 1.0) * autocovariance[std::size_t(lag)];
    for (int frequency = 0; frequency < kFrequencies; ++frequency) {
        const auto at = [&](int lag) { return cosine[std::size_t(frequency * std::abs(lag) % kFrequencies)]; };
        double power = 0.0;
        for (int lag = 0; lag < lags; ++lag) power += (lag ? 2.0 : 1.0) * autocovariance[std::size_t(lag)] * at(lag);
        const double amplitude = std::sqrt(std::max(0.0, power)) / kFrequencies;
        for (int lag = 1 - lags; lag < lags; ++lag) weights[std::size_t(lag + lags - 1)] += amplitude * at(lag);
    }
    for (std::size_t lag = 0; lag < out.size(); ++lag) {
        for (std::size_t k = lag; k < weights.size(); ++k) out[lag] += weights[k] * weights[k - lag];
        sum += (lag ? 2.0 : 1.0) * out[lag];
    }
    for (double& c : out) c *= whole / sum;
    return out;
}

Weighing estimate_weighing(const MarkProblem& at) {
    Weighing out = at.weighing;
    std::vector<MarkDerivatives> marks = evaluate_marks(at);
    std::vector<double> size;
    for (const MarkDerivatives& mark : marks)
        for (Index k = 0; k < mark.distance_mm.size(); ++k)
            if (mark.point_weights[k] > 0.0) size.push_back(std::abs(mark.distance_mm[k]));
    std::sort(size.begin(), size.end());
    auto end = size.end();
    for (int round = 0; round < kScaleRounds;
         ++round) {  // only over points that count: a page's border would raise the noise
        out.noise_mm = std::max(kMinNoiseMm, 1.482602218505602 * size[std::size_t(end - size.begin()) / 2]);
        if (out.loss != Loss::tukey) break;
        end = std::lower_bound(size.begin(), size.end(), kTukeySigmas * out.noise_mm);
    }
    drop_outliers(marks, out);

    double slope = 0.0, counted = 0.0;
    for (const MarkDerivatives& mark : marks)
        for (Index k = 0; k < mark.distance_mm.size(); ++k) {
            slope += mark.point_weights[k] * cost(out.loss, mark.distance_mm[k] / out.noise_mm).slope;
            counted += mark.point_weights[k];
        }
    out.slope = std::max(0.1, slope / std::max(1.0, counted));

    Weighing plain = out;  // the hat matrix hardly depends on the noise, except where priors matter
    plain.points_per_independent = std::max(1.0, at.weighing.points_per_independent);
    const MatrixXd inverse = inverse_hessian(at, marks, plain);
    const double weight = plain.slope / (plain.noise_mm * plain.noise_mm * plain.points_per_independent);
    OutlineCorrelation residual_correlation, hat_correlation;
    for (Index i = 0; i < at.model.marks(); ++i) {
        const MarkDerivatives& mark = marks[std::size_t(i)];
        const VectorXd psi =
            (mark.distance_mm / out.noise_mm).unaryExpr([&](double z) { return cost(out.loss, z).psi; });
        const MatrixXd hat_rows = weight * mark.by * mark_block(inverse, i, at.shared.size());
        // A page's border does not count, because the noise of the marks would be spread over it.
        const auto counts = [&](Index k) { return mark.point_weights[k] > 0.0; };
        for (std::size_t r = 0; r < at.model.rings(i); ++r) {
            const Index begin = at.model.ring_begin(i, r), end = at.model.ring_begin(i, r + 1);
            residual_correlation.add(begin, end, counts, [&](Index a, Index b) { return psi[a] * psi[b]; });
            hat_correlation.add(begin, end, counts,
                                [&](Index a, Index b) { return hat_rows.row(a).dot(mark.by.row(b)); });
        }
    }
    // The sum ends where the autocovariance of neighbours is lost in noise.
    double whole = residual_correlation.mean(0);
    for (int round = 0; round < 6; ++round) {
        std::vector<double> autocovariance;
        double sum = 0.0, hat = 0.0;
        for (std::size_t k = 0; k < residual_correlation.sum.size(); ++k) {
            const auto with = [&](std::size_t j) {
                return residual_correlation.mean(j) + whole * hat_correlation.mean(j);
            };
            if (k % 2 == 1 && (k + 1 == residual_correlation.sum.size() || !(with(k) + with(k + 1) > 0.0))) break;
            autocovariance.push_back(with(k));
            sum += (k ? 2.0 : 1.0) * residual_correlation.mean(k);
            hat += (k ? 2.0 : 1.0) * hat_correlation.mean(k);
        }
        out.autocovariance = autocovariance;
        whole = sum / std::max(0.3, 1.0 - hat);
    }
    // With noise below the minimum, points would count as more than there are. The remaining noise of paint and
    // pictures is correlated over at least the length that is expected of edges.
    const double correlation = std::exp(-at.model.spacing_mm() / MarkOptions{}.noise_length_mm);
    const double least = out.slope * out.slope * (1.0 + correlation) / (1.0 - correlation);
    if (!(whole > least)) {
        if (whole > 0.1 * least)
            for (double& c : out.autocovariance) c *= least / whole;
        else
            out.autocovariance = {least};
        whole = least;
    }
    out.autocovariance = as_moving_average(out.autocovariance);
    out.points_per_independent = whole / out.slope;
    return out;
}

LossDerivatives loss_derivatives(const MarkProblem& at) {
    const Weighing& weighing = at.weighing;
    std::vector<MarkDerivatives> marks = evaluate_marks(at);
    drop_outliers(marks, weighing);
    const Index g = at.shared.size();
    LossDerivatives out{VectorXd::Zero(g + 2 * at.model.marks()), loss_hessian(at, marks, weighing)};
    for (Index i = 0; i < at.model.marks(); ++i) {
        const MarkDerivatives& mark = marks[std::size_t(i)];
        const VectorXd psi =
            (mark.distance_mm / weighing.noise_mm).unaryExpr([&](double z) { return cost(weighing.loss, z).psi; });
        const VectorXd pull = mark.by.transpose() * psi / (weighing.noise_mm * weighing.points_per_independent);
        out.gradient.head(g) += pull.head(g);
        out.gradient.segment<2>(g + 2 * i) = pull.tail<2>();
    }
    return out;
}

VectorXd distance_from_minimum(const MarkProblem& at) {
    LossDerivatives loss = loss_derivatives(at);
    at.add_prior_information(loss.hessian);
    const VectorXd unit = loss.hessian.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = unit.asDiagonal() * loss.hessian * unit.asDiagonal();
    const VectorXd pull = unit.cwiseProduct(loss.gradient + at.prior_gradient());
    const VectorXd step = run_cancellable([scaled, pull]() -> VectorXd { return scaled.ldlt().solve(pull); });
    return unit.cwiseProduct(step).head(at.shared.size());
}

MatrixXd covariance(const MarkProblem& at) {
    const Weighing& weighing = at.weighing;
    std::vector<MarkDerivatives> marks = evaluate_marks(at);
    drop_outliers(marks, weighing);
    const Index g = at.shared.size(), all = g + 2 * at.model.marks(), farthest = Index(weighing.autocovariance.size());
    MatrixXd spread = MatrixXd::Zero(all, all);
    for (Index i = 0; i < at.model.marks(); ++i) {
        const MatrixXd& by = marks[std::size_t(i)].by;
        MatrixXd correlated_rows = MatrixXd::Zero(by.rows(), by.cols());
        for (std::size_t r = 0; r < at.model.rings(i); ++r) {
            const Index begin = at.model.ring_begin(i, r), n = at.model.ring_begin(i, r + 1) - begin;
            for (Index k = 0; k < n; ++k) {
                checkpoint(int(farthest));
                for (Index lag = 0; lag < farthest; ++lag) {  // more than once around a short outline
                    const double c = weighing.autocovariance[std::size_t(lag)];
                    correlated_rows.row(begin + k) += c * by.row(begin + (k + lag) % n);
                    if (lag) correlated_rows.row(begin + k) += c * by.row(begin + (k + n - lag % n) % n);
                }
            }
        }
        add(spread, by.transpose() * correlated_rows, i, g);
    }
    spread /= std::pow(weighing.noise_mm * weighing.points_per_independent, 2);
    at.add_prior_information(spread);
    const MatrixXd inverse = inverse_hessian(at, marks, weighing);
    const MatrixXd out = inverse.topRows(g) * spread * inverse.leftCols(g);
    return weighing.is_given ? out : add_misfit(out, mark_influences(at, marks, inverse), at);
}

}  // namespace brushsvg::fit
