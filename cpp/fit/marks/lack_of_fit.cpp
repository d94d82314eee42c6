#include "lack_of_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "brushsvg/student_t.hpp"
#include "meanwhile.hpp"
#include "noise_covariance.hpp"

namespace brushsvg::fit {
namespace {

constexpr int kLaws = 5;                                // lag, tip gap, half width, both ratios of the footprint
constexpr std::array<int, kLaws> kMore{3, 2, 3, 3, 3};  // numbers more of each law
constexpr double kFreedom = 3.0;  // how far a law departs is found from as many further numbers of it
constexpr double kAsked =
    1.0;  // log of the likelihood that departing must be worth: less comes by chance in the family
// A brush one of whose laws departs departs in the other lengths, too, if the marks say so or not: without it a floor
// in the lag was taken for a tip gap, and the lag for sure.
constexpr int kLengths = 3;  // lag, tip gap, half width
constexpr double kLeastOfMost = 0.25;
constexpr double kOpen = 3.0;    // share of a law that it may depart by where nothing is known
constexpr double kSmooth = 0.7;  // the k-th further polynomial is as much smaller as (numbers / k) to this power
constexpr int kSweeps = 4;

/// What a law may depart by, as shares of it; 0 first.
std::vector<double> shares() {
    std::vector<double> out{0.0};
    for (double share = 0.003; share < 1.0; share *= 1.5) out.push_back(share);
    return out;
}

/// Departures of all laws: rows over the shared unknowns, of which law each is, and its size at a share of 1.
struct Departures {
    MatrixXd rows;
    std::vector<int> law;
    VectorXd size;
};

Departures departures_of(const MarkModel& model, const Layout& from, const MarkLaws& laws, double deepest) {
    const Layout& to = model.layout();
    const auto at = [&](const std::vector<double>& c) {
        double y = 0.0;
        for (std::size_t i = c.size(); i-- > 0;) y = y * deepest + c[i];
        return y;
    };
    Departures out{model.departures(from), {}, {}};
    std::vector<double> size;
    const std::array<std::pair<int, int>, kLaws> terms{{{from.lag, to.lag},
                                                        {from.gap, to.gap},
                                                        {from.half, to.half},
                                                        {from.widest_terms, to.widest_terms},
                                                        {from.front_terms, to.front_terms}}};
    const double half = std::max(0.1, at(laws.half_width));
    const std::array<double, kLaws> whole{std::max(0.5, at(laws.lag)), std::max(half, std::abs(at(laws.tip_gap))), half,
                                          std::max(1.0, laws.widest_per_half), std::max(1.0, laws.front_per_half)};
    for (int law = 0; law < kLaws; ++law) {
        const auto [known, all] = terms[std::size_t(law)];
        for (int k = known; k < all; ++k) {
            out.law.push_back(law);
            size.push_back(whole[std::size_t(law)] * std::pow(double(known) / k, kSmooth));  // smooth ones fall so
        }
    }
    out.size = Eigen::Map<VectorXd>(size.data(), Index(size.size()));
    return out;
}

/// Shares by evidence, for each law. The problem must expect nothing.
std::array<double, kLaws> likeliest(const MarkProblem& at, const Departures& departures) {
    MarksLoss loss = marks_loss(at);
    const Index g = at.shared.size(), all = loss.gradient.size();
    const MatrixXd& rows = departures.rows;
    const VectorXd open = (kOpen * departures.size).cwiseAbs2().cwiseInverse();
    at.add_known(loss.slope);
    loss.slope.topLeftCorner(g, g) += rows.transpose() * open.asDiagonal() * rows;
    const VectorXd now = rows * at.shared;
    VectorXd gradient = loss.gradient + at.known_gradient();
    gradient.head(g) += rows.transpose() * open.cwiseProduct(now);
    const VectorXd unit = loss.slope.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = unit.asDiagonal() * loss.slope * unit.asDiagonal();
    MatrixXd right(all, rows.rows() + 1);
    right.leftCols(rows.rows()).setZero();
    right.topLeftCorner(g, rows.rows()) = rows.transpose();
    right.rightCols(1) = gradient;
    right = unit.asDiagonal() * right;
    const MatrixXd solved = asking_meanwhile([scaled, right]() -> MatrixXd { return scaled.ldlt().solve(right); });
    const MatrixXd back = unit.asDiagonal() * solved;
    const MatrixXd spread = rows * back.topLeftCorner(g, rows.rows());
    const VectorXd found = now - rows * back.topRightCorner(g, 1);
    const MatrixXd known = spread.ldlt().solve(MatrixXd::Identity(rows.rows(), rows.rows()));
    const MatrixXd tells = known - MatrixXd(open.asDiagonal());
    const VectorXd pull = known * found;

    const auto evidence = [&](const std::array<double, kLaws>& share) {
        VectorXd sd(rows.rows());
        for (Index i = 0; i < sd.size(); ++i)
            sd[i] = share[std::size_t(departures.law[std::size_t(i)])] * departures.size[i];
        const MatrixXd both =
            MatrixXd::Identity(sd.size(), sd.size()) + MatrixXd(sd.asDiagonal() * tells * sd.asDiagonal());
        const Eigen::LDLT<MatrixXd> factor(both);
        const VectorXd drawn = sd.cwiseProduct(pull);
        return 0.5 * drawn.dot(factor.solve(drawn)) - 0.5 * factor.vectorD().cwiseMax(1e-12).array().log().sum();
    };
    const std::vector<double> tried = shares();
    std::array<double, kLaws> out;
    out.fill(tried.front());
    double best = evidence(out);
    for (int sweep = 0; sweep < kSweeps; ++sweep)
        for (int law = 0; law < kLaws; ++law)
            for (const double share : tried) {
                std::array<double, kLaws> other = out;
                other[std::size_t(law)] = share;
                const double now_there = evidence(other);
                if (!(now_there > best)) continue;
                best = now_there;
                out = other;
            }
    if (!(best > kAsked)) {
        out.fill(0.0);
        return out;
    }
    const double most = *std::max_element(out.begin(), out.begin() + kLengths);
    for (int law = 0; law < kLengths; ++law) {
        double& share = out[std::size_t(law)];
        share = std::max(share, kLeastOfMost * most);
    }
    return out;
}

/// How many numbers each law has where it may depart.
MarkOptions wider(const MarkOptions& options, const std::array<double, kLaws>& share) {
    MarkOptions out = options;
    const std::array<int*, kLaws> terms{&out.lag_terms, &out.tip_gap_terms, &out.half_width_terms, &out.widest_terms,
                                        &out.front_terms};
    for (std::size_t law = 0; law < kLaws; ++law)
        if (share[law] > 0.0) *terms[law] += kMore[law];
    out.lag_terms = std::min(out.lag_terms, kMostTerms);
    return out;
}

}  // namespace

MarkProblem with_terms(const MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options) {
    MarkProblem out(marks, options);
    const Index sheet = fit.shared.size() - fit.model.layout().height();
    out.shared = out.model.unknowns(fit.model.laws(fit.shared));
    out.shared.tail(sheet) = fit.shared.tail(sheet);
    out.own = fit.own;
    out.says = fit.says;
    out.weighing = fit.weighing;
    out.iterations = fit.iterations;
    out.model.go_on_counting(fit.model);
    return out;
}

double unsurer(const MarkProblem& fit) {
    if (!fit.is_departing()) return 1.0;
    return std::pow(deviations_of_95(kFreedom) / deviations_of_95(std::nullopt), 2);
}

bool depart(MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options) {
    std::array<double, kLaws> share;
    share.fill(1.0);
    const MarkProblem open = with_terms(fit, marks, wider(options, share));
    const Layout from = MarkModel::layout_of(options);
    const MarkLaws laws = fit.model.laws(fit.shared);
    share = likeliest(open, departures_of(open.model, from, laws, options.deepest_mm));
    fit = with_terms(fit, marks, wider(options, share));
    const Departures departures = departures_of(fit.model, from, laws, options.deepest_mm);
    VectorXd sure = departures.size.cwiseInverse();
    for (Index i = 0; i < sure.size(); ++i) sure[i] /= share[std::size_t(departures.law[std::size_t(i)])];
    fit.expect(sure.asDiagonal() * departures.rows);
    return sure.size() > 0;
}

}  // namespace brushsvg::fit
