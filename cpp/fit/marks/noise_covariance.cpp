#include "noise_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/meanwhile.hpp"
#include "brushsvg/checkpoint.hpp"
#include "no_brush.hpp"

namespace brushsvg::fit {
namespace {

// No picture of paint has less noise. In a very clean picture, misfits of the laws must not count as outliers.
constexpr double kLeastNoiseMm = 0.05;
constexpr int kScaleRounds = 5;
constexpr Index kFarthest = 60;  // largest number of points between correlated errors on an outline

/// A mark's distances and their derivatives by the shared unknowns and the mark's displacement.
struct Seen {
    VectorXd distance_mm;
    MatrixXd by;
    VectorXd says;
};
std::vector<Seen> look(const MarkProblem& at) {
    std::vector<Seen> out(at.own.size());
    const Index g = at.shared.size();
    at.model.for_each([&](Index i) {
        RowMajor by(at.model.points(i), g), own(at.model.points(i), 2);
        Seen& seen = out[std::size_t(i)];
        if (!at.model.distances(i, at.shared.data(), at.own[std::size_t(i)].data(), seen.distance_mm, &by, &own))
            throw no_brush_paints(at.model.stroke(i));
        seen.by.resize(by.rows(), g + 2);
        seen.by << by, own;
        seen.says = at.says[std::size_t(i)];
        seen.by = seen.says.asDiagonal() * seen.by;
    });
    return out;
}

/// Leaves out outliers.
void leave_out_wild(std::vector<Seen>& marks, const Weighing& weighing) {
    if (weighing.loss != Loss::tukey) return;
    for (Seen& mark : marks)
        for (Index k = 0; k < mark.by.rows(); ++k)
            if (std::abs(mark.distance_mm[k]) >= kTukey * weighing.noise_mm) {
                mark.by.row(k).setZero();
                mark.says[k] = 0.0;
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
MatrixXd slope_of(const MarkProblem& at, const std::vector<Seen>& marks, const Weighing& weighing) {
    const Index g = at.shared.size(), all = g + 2 * at.model.marks();
    MatrixXd slope = MatrixXd::Zero(all, all);
    const double weight = weighing.slope / (weighing.noise_mm * weighing.noise_mm * weighing.repeats);
    for (Index i = 0; i < at.model.marks(); ++i) {
        const MatrixXd& by = marks[std::size_t(i)].by;
        add(slope, weight * (by.transpose() * by), i, g);
    }
    return slope;
}

/// Returns the inverse of the second derivatives of the loss with priors.
MatrixXd inverse_slope(const MarkProblem& at, const std::vector<Seen>& marks, const Weighing& weighing) {
    const Index all = at.shared.size() + 2 * at.model.marks();
    MatrixXd slope = slope_of(at, marks, weighing);
    at.add_known(slope);
    // In units of the unknowns' own sizes, because the powers of a polynomial have very different magnitudes.
    const VectorXd unit = slope.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = unit.asDiagonal() * slope * unit.asDiagonal();
    const MatrixXd inverse = asking_meanwhile(  // seconds for a thousand marks
        [scaled, all]() -> MatrixXd { return scaled.ldlt().solve(MatrixXd::Identity(all, all)); });
    return unit.asDiagonal() * inverse * unit.asDiagonal();
}

/// Returns the part of an inverse over all unknowns that affects one mark's distances.
MatrixXd part_of(const MatrixXd& inverse, Index mark, Index shared) {
    const Index own = shared + 2 * mark;
    MatrixXd out(shared + 2, shared + 2);
    out << inverse.topLeftCorner(shared, shared), inverse.block(0, own, shared, 2), inverse.block(own, 0, 2, shared),
        inverse.block(own, own, 2, 2);
    return out;
}

/// Returns how much each mark alone moves the shared unknowns (g, marks), against all other marks.
MatrixXd pulls(const MarkProblem& at, const std::vector<Seen>& marks, const MatrixXd& inverse) {
    const Weighing& weighing = at.weighing;
    const Index g = at.shared.size();
    MatrixXd out(g, at.model.marks());
    for (Index i = 0; i < at.model.marks(); ++i) {
        const Seen& mark = marks[std::size_t(i)];
        const VectorXd psi =
            (mark.distance_mm / weighing.noise_mm).unaryExpr([&](double z) { return cost(weighing.loss, z).psi; });
        const VectorXd pull = mark.by.transpose() * psi / (weighing.noise_mm * weighing.repeats);
        out.col(i) = inverse.topLeftCorner(g, g) * pull.head(g) + inverse.block(0, g + 2 * i, g, 2) * pull.tail<2>();
    }
    return out;
}

/// Raises the covariance in directions in which groups of marks disagree by more than their noise explains.
MatrixXd raised(const MatrixXd& covariance, const MatrixXd& pulls) {
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
MatrixXd with_misfit(const MatrixXd& covariance, const MatrixXd& pulls, const MarkProblem& at) {
    constexpr double kSameDepth = 0.02;  // as a share of the greatest depth
    std::vector<double> depths;
    for (Index i = 0; i < pulls.cols(); ++i) depths.push_back(at.model.deepest(i));
    const double most = *std::max_element(depths.begin(), depths.end());
    std::map<long, Index> group;
    for (const double d : depths) group.try_emplace(std::lround(d / (kSameDepth * most)), Index(group.size()));
    MatrixXd by_depth = MatrixXd::Zero(pulls.rows(), Index(group.size()));
    for (Index i = 0; i < pulls.cols(); ++i)
        by_depth.col(group[std::lround(depths[std::size_t(i)] / (kSameDepth * most))]) += pulls.col(i);
    return raised(raised(covariance, pulls), by_depth);
}

/// Sums of products of two points on one closed outline, by their distance in points, and the number of pairs that
/// count.
struct Along {
    std::vector<double> sum, pairs;
    template <class Says, class Product>
    void add(Index begin, Index end, Says&& says, Product&& product) {
        const Index n = end - begin, farthest = std::min(kFarthest, (n + 1) / 2);
        if (Index(sum.size()) < farthest) {
            sum.resize(std::size_t(farthest), 0.0);
            pairs.resize(std::size_t(farthest), 0.0);
        }
        for (Index lag = 0; lag < farthest; ++lag) {
            checkpoint(int(n));
            for (Index k = 0; k < n; ++k) {
                const Index a = begin + k, b = begin + (k + lag) % n;
                if (!says(a) || !says(b)) continue;
                sum[std::size_t(lag)] += product(a, b);
                pairs[std::size_t(lag)] += 1.0;
            }
        }
    }
    double mean(std::size_t lag) const { return sum[lag] / std::max(1.0, pairs[lag]); }
};

}  // namespace

Weighing weighed(const MarkProblem& at) {
    Weighing out = at.weighing;
    std::vector<Seen> marks = look(at);
    std::vector<double> size;
    for (const Seen& mark : marks)
        for (Index k = 0; k < mark.distance_mm.size(); ++k)
            if (mark.says[k] > 0.0) size.push_back(std::abs(mark.distance_mm[k]));
    std::sort(size.begin(), size.end());
    auto end = size.end();
    for (int round = 0; round < kScaleRounds;
         ++round) {  // only over points that count: a page's border would raise the noise
        out.noise_mm = std::max(kLeastNoiseMm, 1.482602218505602 * size[std::size_t(end - size.begin()) / 2]);
        if (out.loss != Loss::tukey) break;
        end = std::lower_bound(size.begin(), size.end(), kTukey * out.noise_mm);
    }
    leave_out_wild(marks, out);

    double slope = 0.0, counted = 0.0;
    for (const Seen& mark : marks)
        for (Index k = 0; k < mark.distance_mm.size(); ++k) {
            slope += mark.says[k] * cost(out.loss, mark.distance_mm[k] / out.noise_mm).slope;
            counted += mark.says[k];
        }
    out.slope = std::max(0.1, slope / std::max(1.0, counted));

    Weighing plain = out;  // the hat matrix hardly depends on the noise, except where priors matter
    plain.repeats = std::max(1.0, at.weighing.repeats);
    const MatrixXd inverse = inverse_slope(at, marks, plain);
    const double weight = plain.slope / (plain.noise_mm * plain.noise_mm * plain.repeats);
    Along left, followed;
    for (Index i = 0; i < at.model.marks(); ++i) {
        const Seen& mark = marks[std::size_t(i)];
        const VectorXd psi =
            (mark.distance_mm / out.noise_mm).unaryExpr([&](double z) { return cost(out.loss, z).psi; });
        const MatrixXd made = weight * mark.by * part_of(inverse, i, at.shared.size());
        // A page's border does not count, because the noise of the marks would be spread over it.
        const auto says = [&](Index k) { return mark.says[k] > 0.0; };
        for (std::size_t r = 0; r < at.model.rings(i); ++r) {
            const Index begin = at.model.ring_begin(i, r), end = at.model.ring_begin(i, r + 1);
            left.add(begin, end, says, [&](Index a, Index b) { return psi[a] * psi[b]; });
            followed.add(begin, end, says, [&](Index a, Index b) { return made.row(a).dot(mark.by.row(b)); });
        }
    }
    // The sum ends where the autocovariance of neighbours is lost in noise.
    double whole = left.mean(0);
    for (int round = 0; round < 6; ++round) {
        std::vector<double> together;
        double sum = 0.0, hat = 0.0;
        for (std::size_t k = 0; k < left.sum.size(); ++k) {
            const auto with = [&](std::size_t j) { return left.mean(j) + whole * followed.mean(j); };
            if (k % 2 == 1 && (k + 1 == left.sum.size() || !(with(k) + with(k + 1) > 0.0))) break;
            together.push_back(with(k));
            sum += (k ? 2.0 : 1.0) * left.mean(k);
            hat += (k ? 2.0 : 1.0) * followed.mean(k);
        }
        out.together = together;
        whole = sum / std::max(0.3, 1.0 - hat);
    }
    // With noise below the minimum, points would count as more than there are. The remaining noise of paint and
    // pictures is correlated over at least the length that is expected of edges.
    const double kept = std::exp(-at.model.spacing_mm() / MarkOptions{}.noise_length_mm);
    const double least = out.slope * out.slope * (1.0 + kept) / (1.0 - kept);
    if (!(whole > least)) {
        if (whole > 0.1 * least)
            for (double& c : out.together) c *= least / whole;
        else
            out.together = {least};
        whole = least;
    }
    out.repeats = whole / out.slope;
    return out;
}

MarksLoss marks_loss(const MarkProblem& at) {
    const Weighing& weighing = at.weighing;
    std::vector<Seen> marks = look(at);
    leave_out_wild(marks, weighing);
    const Index g = at.shared.size();
    MarksLoss out{VectorXd::Zero(g + 2 * at.model.marks()), slope_of(at, marks, weighing)};
    for (Index i = 0; i < at.model.marks(); ++i) {
        const Seen& mark = marks[std::size_t(i)];
        const VectorXd psi =
            (mark.distance_mm / weighing.noise_mm).unaryExpr([&](double z) { return cost(weighing.loss, z).psi; });
        const VectorXd pull = mark.by.transpose() * psi / (weighing.noise_mm * weighing.repeats);
        out.gradient.head(g) += pull.head(g);
        out.gradient.segment<2>(g + 2 * i) = pull.tail<2>();
    }
    return out;
}

VectorXd off_least(const MarkProblem& at) {
    MarksLoss loss = marks_loss(at);
    at.add_known(loss.slope);
    const VectorXd unit = loss.slope.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = unit.asDiagonal() * loss.slope * unit.asDiagonal();
    const VectorXd pull = unit.cwiseProduct(loss.gradient + at.known_gradient());
    const VectorXd step = asking_meanwhile([scaled, pull]() -> VectorXd { return scaled.ldlt().solve(pull); });
    return unit.cwiseProduct(step).head(at.shared.size());
}

MatrixXd covariance(const MarkProblem& at) {
    const Weighing& weighing = at.weighing;
    std::vector<Seen> marks = look(at);
    leave_out_wild(marks, weighing);
    const Index g = at.shared.size(), all = g + 2 * at.model.marks(), farthest = Index(weighing.together.size());
    MatrixXd spread = MatrixXd::Zero(all, all);
    for (Index i = 0; i < at.model.marks(); ++i) {
        const MatrixXd& by = marks[std::size_t(i)].by;
        MatrixXd erring = MatrixXd::Zero(by.rows(), by.cols());
        for (std::size_t r = 0; r < at.model.rings(i); ++r) {
            const Index begin = at.model.ring_begin(i, r), n = at.model.ring_begin(i, r + 1) - begin;
            for (Index k = 0; k < n; ++k) {
                checkpoint(int(farthest));
                for (Index lag = 0; lag < std::min(farthest, (n + 1) / 2); ++lag) {
                    const double c = weighing.together[std::size_t(lag)];
                    erring.row(begin + k) += c * by.row(begin + (k + lag) % n);
                    if (lag) erring.row(begin + k) += c * by.row(begin + (k + n - lag) % n);
                }
            }
        }
        add(spread, by.transpose() * erring, i, g);
    }
    spread /= std::pow(weighing.noise_mm * weighing.repeats, 2);
    at.add_known(spread);
    const MatrixXd inverse = inverse_slope(at, marks, weighing);
    const MatrixXd out = inverse.topRows(g) * spread * inverse.leftCols(g);
    return weighing.is_asked ? out : with_misfit(out, pulls(at, marks, inverse), at);
}

}  // namespace brushsvg::fit
