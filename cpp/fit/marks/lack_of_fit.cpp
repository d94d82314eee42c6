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
// log of how much less likely departing must be for laws to keep their few numbers: marks of a brush that departs where
// they tell little, by how deep its tip is pressed, speak no more against it than chance does
constexpr double kHeld = -1.25;
constexpr double kUsual = 0.05;  // share to begin with
constexpr double kOpen = 3.0;    // share of a law that it may depart by where nothing is known
constexpr double kSmooth = 0.7;  // the k-th further polynomial is as much smaller as (numbers / k) to this power
constexpr int kSweeps = 6;
/// By what share of a law whose numbers do not suffice the rest departs: half of the curves of tests/laws/painter.py do
/// by less (their six, four and three shapes: lag 0.016, 0.020, 0.012, tip gap 0.12, 0.10, 0.13, half width 0.08, 0.07,
/// 0.07, widest section 0.13, 0.12, 0.13). The standard deviation of its log is 0.7 to 1.3 there.
constexpr std::array<double, kLaws> kTypical{0.02, 0.1, 0.1, 0.1, 0.05};
constexpr double kScatter = 1.0;

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

struct Shares {
    std::array<double, kLaws> of_law;
    double likelier;  ///< log of how much likelier they make the marks than laws that do not depart
};

/// Log of how likely a size is beforehand.
using LogPrior = double (*)(int law, double share);

/// 0 in one case of two, else any order of magnitude.
double of_any_size(int, double share) {
    static const double log_count = std::log(double(shares().size() - 1));
    return share > 0.0 ? -log_count : 0.0;
}

/// As curves of other forms depart.
double of_usual_size(int law, double share) {
    if (!(share > 0.0)) return -INFINITY;
    return -0.5 * std::pow(std::log(share / kTypical[std::size_t(law)]) / kScatter, 2);
}

/// What one law departs by when the others depart by `share`: rms over all sizes, by how likely each makes the marks.
template <class Evidence>
double mean_share(std::array<double, kLaws> share, int law, LogPrior known, Evidence&& evidence) {
    static const std::vector<double> tried = shares();
    std::vector<double> likely;
    for (const double one : tried) {
        share[std::size_t(law)] = one;
        likely.push_back(evidence(share) + known(law, one));
    }
    const double most = *std::max_element(likely.begin(), likely.end());
    double all = 0.0, square = 0.0;
    for (std::size_t k = 0; k < tried.size(); ++k) {
        const double weight = std::exp(likely[k] - most);
        all += weight;
        square += weight * tried[k] * tried[k];
    }
    return std::sqrt(square / all);
}

/// Shares for each law. The problem must expect nothing.
Shares shares_of(const MarkProblem& at, const Departures& departures, LogPrior known_of) {
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
    std::array<double, kLaws> none, out;
    none.fill(0.0);
    out.fill(kUsual);
    const double held = evidence(none);
    for (int sweep = 0; sweep < kSweeps; ++sweep)
        for (int law = 0; law < kLaws; ++law) out[std::size_t(law)] = mean_share(out, law, known_of, evidence);
    return {out, evidence(out) - held};
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

/// Laws are expected to depart by these shares of them.
void expect(MarkProblem& at, const Departures& departures, const std::array<double, kLaws>& share) {
    VectorXd sure = departures.size.cwiseInverse();
    for (Index i = 0; i < sure.size(); ++i) sure[i] /= share[std::size_t(departures.law[std::size_t(i)])];
    at.expect(sure.asDiagonal() * departures.rows);
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

double unsurer(double likelier) {
    const double wider = std::pow(deviations_of_95(kFreedom) / deviations_of_95(std::nullopt), 2);
    return 1.0 + (wider - 1.0) / (1.0 + std::exp(-likelier));
}

double depart(MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options) {
    std::array<double, kLaws> share;
    share.fill(1.0);
    const MarkProblem open = with_terms(fit, marks, wider(options, share));
    const Layout from = MarkModel::layout_of(options);
    const MarkLaws laws = fit.model.laws(fit.shared);
    Shares found = shares_of(open, departures_of(open.model, from, laws, options.deepest_mm), of_any_size);
    if (found.likelier < kHeld) found.of_law.fill(0.0);
    fit = with_terms(fit, marks, wider(options, found.of_law));
    expect(fit, departures_of(fit.model, from, laws, options.deepest_mm), found.of_law);
    return found.likelier;
}

MarkProblem of_usual_departures(const MarkProblem& fit, const MarkOptions& options) {
    const Layout from = MarkModel::layout_of(options);
    const Departures departures = departures_of(fit.model, from, fit.model.laws(fit.shared), options.deepest_mm);
    MarkProblem out = fit;
    out.expect(MatrixXd(0, fit.shared.size()));
    expect(out, departures, shares_of(out, departures, of_usual_size).of_law);
    return out;
}

}  // namespace brushsvg::fit
