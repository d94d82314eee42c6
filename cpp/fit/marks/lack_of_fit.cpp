#include "lack_of_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstdio>

#include "meanwhile.hpp"
#include "noise_covariance.hpp"

namespace brushsvg::fit {
namespace {

constexpr int kLaws = 5;        // lag, tip gap, half width, both ratios of the footprint
constexpr int kMore = 3;        // numbers more of each law
constexpr double kOpen = 3.0;   // share of a law that it may depart by where nothing is known
constexpr int kRounds = 2, kSweeps = 4;

/// What a law may depart by, as shares of it.
std::vector<double> shares() {
    const char* least = std::getenv("MISFIT_LEAST");
    std::vector<double> out;
    for (double share = least ? std::atof(least) : 0.002; share < 0.6; share *= 1.5) out.push_back(share);
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
            size.push_back(whole[std::size_t(law)] * std::pow(double(known) / k, 1.5));  // smooth ones fall so
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
        return 0.5 * drawn.dot(factor.solve(drawn)) -
               0.5 * factor.vectorD().cwiseMax(1e-12).array().log().sum();
    };
    const std::vector<double> tried = shares();
    std::array<double, kLaws> out;
    out.fill(tried.front());
    double best = evidence(out);
    const double none = best;
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
    if (std::getenv("MISFIT_SAY"))
        std::fprintf(stderr, "gain %.1f shares %.3f %.3f %.3f %.3f %.3f noise %.3f repeats %.1f\n", best - none, out[0], out[1],
                     out[2], out[3], out[4], at.weighing.noise_mm, at.weighing.repeats);
    return out;
}

}  // namespace

bool depart(MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options) {
    const Layout from = fit.model.layout();
    MarkOptions wider = options;
    wider.lag_terms = std::min(kMostTerms, from.lag + kMore);
    wider.tip_gap_terms = from.gap + kMore - 1;
    wider.half_width_terms = from.half + kMore;
    wider.widest_terms = wider.front_terms = 1 + kMore;
    MarkProblem out(marks, wider);
    const Layout& to = out.model.layout();
    const MarkLaws laws = fit.model.laws(fit.shared);
    const Index sheet = from.size() - from.height();
    out.shared = out.model.unknowns(laws);
    out.shared.tail(sheet) = fit.shared.tail(sheet);
    out.own = fit.own;
    out.says = fit.says;
    out.weighing = fit.weighing;
    out.iterations = fit.iterations;
    const Departures departures = departures_of(out.model, from, laws, options.deepest_mm);
    bool converged = false;
    for (int round = 0; round < kRounds; ++round) {
        out.expect(MatrixXd(0, to.size()));
        const std::array<double, kLaws> share = likeliest(out, departures);
        VectorXd sure = departures.size.cwiseInverse();
        for (Index i = 0; i < sure.size(); ++i) sure[i] /= share[std::size_t(departures.law[std::size_t(i)])];
        out.expect(sure.asDiagonal() * departures.rows);
        converged = out.solve(options.most_iterations, round + 1 < kRounds ? 1e-4 : 1e-6);
        out.weighing = weighed(out);
    }
    fit = out;
    return converged;
}

}  // namespace brushsvg::fit
