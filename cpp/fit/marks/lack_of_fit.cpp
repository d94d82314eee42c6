#include "lack_of_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/run_cancellable.hpp"
#include "brushsvg/student_t.hpp"
#include "noise_covariance.hpp"

namespace brushsvg::fit {
namespace {

constexpr int kLawCount = 5;  // lag, tip gap, half width, both ratios of the footprint
constexpr std::array<int, kLawCount> kAdditionalTerms{3, 2, 3, 3, 3};  // additional coefficients of each law
constexpr int kHalfWidthLaw = 2;           // the half width, which may also rise with another power of depth
constexpr int kAdditionalPowerTerms = 4;   // additional coefficients of the half width in this case
constexpr int kSizeCount = kLawCount + 1;  // departure sizes: one for each law, and one for the power of the half width
constexpr double kSizeDegreesOfFreedom = 3.0;  // degrees of freedom of the size of a departure
// Laws keep their few coefficients if the log of the likelihood ratio of departing is below this value. Some brushes
// depart only at depths where the marks determine little. There, weak evidence against departing may be chance.
constexpr double kMinLogRatioToDepart = -1.25;
// Laws clearly depart if the log of the likelihood ratio is above this value. Then the half width may also rise with
// another power. With weaker evidence (brushes of the family reach 0.2), this would only make the intervals wider.
constexpr double kMinLogRatioForPower = 0.5;
// Log of the prior odds that a brush departs. They are in favour of departing, because laws with few coefficients are
// our choice and not a property of brushes.
constexpr double kPriorLogOdds = 2.0;
constexpr double kNoDepartureShare = 0.001;  // departure of a law that does not depart, as a share of the law
constexpr double kInitialShare = 0.05;       // initial departure, as a share of the law
constexpr double kMaxShare = 3.0;            // largest departure where nothing is known, as a share of the law
constexpr double kSmoothnessPower = 0.7;  // the k-th further polynomial is smaller by (coefficients / k) to this power
constexpr int kSweeps = 6;
/// Typical departures of laws whose coefficients do not suffice, as shares of the laws. Half of the curves of
/// tests/laws/painter.py depart by less (their six, four and three shapes: lag 0.016, 0.020, 0.012, tip gap 0.12, 0.10,
/// 0.13, half width 0.08, 0.07, 0.07, widest section 0.13, 0.12, 0.13). The standard deviation of the log is 0.7 to 1.3
/// for these curves. The last value is the difference of the power of the half width from 1: 0.06 for these curves, and
/// 0.1 to 0.35 for roots down to the touch.
constexpr std::array<double, kSizeCount> kTypicalShares{0.02, 0.1, 0.1, 0.1, 0.05, 0.15};
constexpr double kLogShareSd = 1.0;

/// Lists the departures that are tried, as shares of the law, with 0 first.
std::vector<double> share_grid() {
    std::vector<double> out{0.0};
    for (double share = 0.003; share < 1.0; share *= 1.5) out.push_back(share);
    return out;
}

using Sizes = std::array<double, kSizeCount>;

/// The departures of all laws. rows: departures by the shared unknowns; deviations: columns of independent deviations
/// for departure sizes of 1; size_of: for each column, the index of the size that scales it.
struct Departures {
    MatrixXd rows;
    MatrixXd deviations;
    std::vector<int> size_of;

    MatrixXd scaled(const Sizes& sizes) const {
        VectorXd by(deviations.cols());
        for (Index i = 0; i < by.size(); ++i) by[i] = sizes[std::size_t(size_of[std::size_t(i)])];
        return deviations * by.asDiagonal();
    }
};

/// Returns the k-th Legendre coefficient of -log(t) over [0, 1]: to first order, t^(1 - share) is t (1 - share log(t)).
double log_legendre_coefficient(int k) { return (k % 2 ? -1.0 : 1.0) * (2.0 * k + 1.0) / (double(k) * (k + 1.0)); }

Departures make_departures(const MarkModel& model, const Layout& from, const MarkLaws& laws, double deepest) {
    const Layout& to = model.layout();
    const auto at = [&](const std::vector<double>& c) {
        double y = 0.0;
        for (std::size_t i = c.size(); i-- > 0;) y = y * deepest + c[i];
        return y;
    };
    Departures out{model.departure_rows(from), {}, {}};
    const std::array<std::pair<int, int>, kLawCount> terms{{{from.lag, to.lag},
                                                            {from.gap, to.gap},
                                                            {from.half, to.half},
                                                            {from.widest_terms, to.widest_terms},
                                                            {from.front_terms, to.front_terms}}};
    const double half = std::max(0.1, at(laws.half_width));
    const std::array<double, kLawCount> whole{std::max(0.5, at(laws.lag)), std::max(half, std::abs(at(laws.tip_gap))),
                                              half, std::max(1.0, laws.widest_per_half),
                                              std::max(1.0, laws.front_per_half)};
    const Index all_rows = out.rows.rows();
    const bool rises = to.half - from.half >= kAdditionalPowerTerms;
    out.deviations = MatrixXd::Zero(all_rows, all_rows + rises);
    Index row = 0;
    for (int law = 0; law < kLawCount; ++law) {
        const auto [known, all] = terms[std::size_t(law)];
        for (int k = known; k < all; ++k, ++row) {
            out.size_of.push_back(law);
            const double falls =
                std::pow(double(known) / k, kSmoothnessPower);  // higher polynomials are smaller, as in smooth laws
            out.deviations(row, row) = falls * whole[std::size_t(law)];
            if (law == kHalfWidthLaw && rises)
                out.deviations(row, all_rows) = whole[kHalfWidthLaw] * log_legendre_coefficient(k);
        }
    }
    if (rises) out.size_of.push_back(kLawCount);
    return out;
}

struct SizeEstimate {
    Sizes sizes;
    double log_likelihood_ratio;  ///< log of the likelihood ratio of the marks to laws that do not depart
};

/// Log of the prior probability of a size.
using LogPrior = double (*)(int which, double share);

/// Returns the log prior of a size that is 0 in half of the cases, and otherwise of any order of magnitude.
double log_prior_of_any_size(int, double share) {
    static const double log_count = std::log(double(share_grid().size() - 1));
    return share > 0.0 ? -log_count : 0.0;
}

/// Returns the log prior of a size from the departures of curves of other forms, see kTypicalShares.
double log_prior_of_typical_size(int which, double share) {
    if (!(share > 0.0)) return -INFINITY;
    return -0.5 * std::pow(std::log(share / kTypicalShares[std::size_t(which)]) / kLogShareSd, 2);
}

/// Returns the rms of one size over all values that it may have, weighted by the likelihood of the marks, while the
/// other sizes are `share`.
template <class Evidence>
double rms_share(Sizes share, int which, LogPrior known, Evidence&& evidence) {
    static const std::vector<double> grid = share_grid();
    std::vector<double> log_weights;
    for (const double one : grid) {
        share[std::size_t(which)] = one;
        log_weights.push_back(evidence(share) + known(which, one));
    }
    const double most = *std::max_element(log_weights.begin(), log_weights.end());
    double all = 0.0, square = 0.0;
    for (std::size_t k = 0; k < grid.size(); ++k) {
        const double weight = std::exp(log_weights[k] - most);
        all += weight;
        square += weight * grid[k] * grid[k];
    }
    return std::sqrt(square / all);
}

/// Estimates the sizes of all departures. The problem must not have expected departures yet.
SizeEstimate estimate_sizes(const MarkProblem& at, const Departures& departures, LogPrior log_prior) {
    LossDerivatives loss = loss_derivatives(at);
    const Index g = at.shared.size(), all = loss.gradient.size();
    const MatrixXd& rows = departures.rows;
    const VectorXd open = (kMaxShare * departures.deviations.diagonal()).cwiseAbs2().cwiseInverse();
    at.add_prior_information(loss.hessian);
    loss.hessian.topLeftCorner(g, g) += rows.transpose() * open.asDiagonal() * rows;
    const VectorXd now = rows * at.shared;
    VectorXd gradient = loss.gradient + at.prior_gradient();
    gradient.head(g) += rows.transpose() * open.cwiseProduct(now);
    const VectorXd unit = loss.hessian.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = unit.asDiagonal() * loss.hessian * unit.asDiagonal();
    MatrixXd right(all, rows.rows() + 1);
    right.leftCols(rows.rows()).setZero();
    right.topLeftCorner(g, rows.rows()) = rows.transpose();
    right.rightCols(1) = gradient;
    right = unit.asDiagonal() * right;
    const MatrixXd solved = run_cancellable([scaled, right]() -> MatrixXd { return scaled.ldlt().solve(right); });
    const MatrixXd back = unit.asDiagonal() * solved;
    const MatrixXd spread = rows * back.topLeftCorner(g, rows.rows());
    const VectorXd found = now - rows * back.topRightCorner(g, 1);
    const MatrixXd known = spread.ldlt().solve(MatrixXd::Identity(rows.rows(), rows.rows()));
    const MatrixXd information = known - MatrixXd(open.asDiagonal());
    const VectorXd pull = known * found;

    const auto evidence = [&](const Sizes& sizes) {
        const MatrixXd by = departures.scaled(sizes);
        const MatrixXd both = MatrixXd::Identity(by.cols(), by.cols()) + by.transpose() * information * by;
        const Eigen::LDLT<MatrixXd> factor(both);
        const VectorXd drawn = by.transpose() * pull;
        return 0.5 * drawn.dot(factor.solve(drawn)) - 0.5 * factor.vectorD().cwiseMax(1e-12).array().log().sum();
    };
    Sizes none{}, out{};
    const int count = departures.deviations.cols() > rows.rows() ? kSizeCount : kLawCount;
    std::fill_n(out.begin(), count, kInitialShare);
    const double held = evidence(none);
    for (int sweep = 0; sweep < kSweeps; ++sweep)
        for (int which = 0; which < count; ++which)
            out[std::size_t(which)] = rms_share(out, which, log_prior, evidence);
    return {out, evidence(out) - held};
}

/// Returns the options with more coefficients for each law that may depart.
MarkOptions with_more_terms(const MarkOptions& options, const Sizes& sizes) {
    MarkOptions out = options;
    const std::array<int*, kLawCount> terms{&out.lag_terms, &out.tip_gap_terms, &out.half_width_terms,
                                            &out.widest_terms, &out.front_terms};
    for (std::size_t law = 0; law < kLawCount; ++law)
        if (sizes[law] > 0.0)
            *terms[law] +=
                law == kHalfWidthLaw && sizes[kLawCount] > 0.0 ? kAdditionalPowerTerms : kAdditionalTerms[law];
    out.lag_terms = std::min(out.lag_terms, kMaxTerms);
    return out;
}

/// Sets the sizes of the expected departures.
void set_departure_prior(MarkProblem& at, const Departures& departures, const Sizes& sizes) {
    const MatrixXd by = departures.scaled(sizes);
    const Eigen::LLT<MatrixXd> spread(by * by.transpose());
    at.set_departure_prior(spread.matrixL().solve(departures.rows));
}

}  // namespace

MarkProblem with_terms(const MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options) {
    MarkProblem out(marks, options);
    const Index sheet = fit.shared.size() - fit.model.layout().height();
    out.shared = out.model.unknowns(fit.model.laws(fit.shared));
    out.shared.tail(sheet) = fit.shared.tail(sheet);
    out.displacements_mm = fit.displacements_mm;
    out.point_weights = fit.point_weights;
    out.weighing = fit.weighing;
    out.iterations = fit.iterations;
    out.model.continue_counting_from(fit.model);
    return out;
}

double variance_factor(double log_likelihood_ratio) {
    const double wider = std::pow(interval_factor_95(kSizeDegreesOfFreedom) / interval_factor_95(std::nullopt), 2);
    return 1.0 + (wider - 1.0) / (1.0 + std::exp(-log_likelihood_ratio));
}

double departure_probability(double log_likelihood_ratio) {
    return 1.0 / (1.0 + std::exp(-log_likelihood_ratio - kPriorLogOdds));
}

double allow_departures(MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options) {
    const Layout from = MarkModel::make_layout(options);
    const MarkLaws laws = fit.model.laws(fit.shared);
    const auto departing = [&](double power) {
        Sizes sizes;
        sizes.fill(1.0);
        sizes[kLawCount] = power;
        const MarkProblem open = with_terms(fit, marks, with_more_terms(options, sizes));
        return estimate_sizes(open, make_departures(open.model, from, laws, options.deepest_mm), log_prior_of_any_size);
    };
    SizeEstimate found = departing(0.0);
    if (found.log_likelihood_ratio > kMinLogRatioForPower) found = departing(1.0);
    if (found.log_likelihood_ratio < kMinLogRatioToDepart) found.sizes.fill(0.0);
    fit = with_terms(fit, marks, with_more_terms(options, found.sizes));
    set_departure_prior(fit, make_departures(fit.model, from, laws, options.deepest_mm), found.sizes);
    return found.log_likelihood_ratio;
}

MarkProblem with_typical_departures(const MarkProblem& fit, const MarkOptions& options) {
    const Layout from = MarkModel::make_layout(options);
    const Departures departures = make_departures(fit.model, from, fit.model.laws(fit.shared), options.deepest_mm);
    MarkProblem out = fit;
    out.set_departure_prior(MatrixXd(0, fit.shared.size()));
    set_departure_prior(out, departures, estimate_sizes(out, departures, log_prior_of_typical_size).sizes);
    return out;
}

MarkProblem without_departures(const MarkProblem& fit, const MarkOptions& options) {
    const Layout from = MarkModel::make_layout(options);
    Sizes least;
    least.fill(kNoDepartureShare);
    MarkProblem out = fit;
    set_departure_prior(out, make_departures(fit.model, from, fit.model.laws(fit.shared), options.deepest_mm), least);
    return out;
}

}  // namespace brushsvg::fit
