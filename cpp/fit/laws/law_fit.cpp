#include "law_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "base/format_text.hpp"
#include "base/within.hpp"
#include "bernstein.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/student_t.hpp"

namespace brushsvg::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Lower limit of an absolute residual in the denominator of a weight: far below what a ruler or a camera resolves, far
// above rounding.
constexpr double kMinResidualMm = 1e-9;
constexpr int kMaxReweightings = 500;
// Largest number of sign patterns relative to the floor that are tried. For a cubic at about 20 depths these are all
// patterns, in about 10 ms. With more depths, the law may cross its floor less often. With absolute residuals, each
// pattern needs about thirty times as long.
constexpr std::size_t kMaxPatterns = 4000, kMaxPatternsAbsolute = 500;
// Weight that holds a law to its floor within about 1e-10 mm without loss of digits.
constexpr double kFloorWeight = 1e6;
// Greater lengths, weights and depths are damaged data, and their powers overflow.
constexpr double kMaxMagnitude = 1e6;
constexpr double kMinPositiveMm = 0.01;  // minimum of a positive law: a lever without length has no heading

struct Problem {
    VectorXd depth, value;
    LawShape shape;
    VectorXd value_weight;  ///< 1 / scatter of each value, root mean square 1
    Index terms() const { return shape.degree + (shape.through_zero ? 0 : 1); }
};

/// Returns the powers of depth, without the constant term for a law through zero.
MatrixXd powers(const VectorXd& depth, const LawShape& shape) {
    const Index first = shape.through_zero ? 1 : 0;
    MatrixXd out(depth.size(), shape.degree + 1 - first);
    for (Index j = 0; j < out.cols(); ++j) out.col(j) = depth.array().pow(double(j + first));
    return out;
}

std::vector<double> all_coefficients(const VectorXd& free, bool through_zero) {
    std::vector<double> out(through_zero ? 1 : 0, 0.0);
    out.insert(out.end(), free.data(), free.data() + free.size());
    return out;
}

bool satisfies(const std::vector<double>& c, const LawShape& shape) {
    const double lo = shape.range_mm[0], hi = shape.range_mm[1];
    const auto value = [](const std::vector<double>& p, double x) {
        double y = 0.0;
        for (std::size_t i = p.size(); i-- > 0;) y = y * x + p[i];
        return y;
    };
    const auto slope_of = [](const std::vector<double>& p) {
        std::vector<double> out;
        for (std::size_t i = 1; i < p.size(); ++i) out.push_back(double(i) * p[i]);
        return out;
    };
    const auto least = [&](const std::vector<double>& p) {
        double out = std::min(value(p, lo), value(p, hi));
        for (double d : real_roots(slope_of(p), lo, hi)) out = std::min(out, value(p, d));
        return out;
    };
    const bool from_zero = shape.through_zero && lo == 0.0;
    if (shape.positive && !(from_zero ? least(c) >= 0.0 : least(c) >= kMinPositiveMm)) return false;
    return !shape.rising || (value(c, lo) >= 0.0 && least(slope_of(c)) >= -1e-12);
}

/// Minimises |A x - y| over x >= 0 by Lawson and Hanson's active sets, exactly after finitely many steps. (The bounds
/// of Ceres, which project each step, stall far from the optimum on columns as similar as these.)
VectorXd least_squares_above_zero(const MatrixXd& a, const VectorXd& y) {
    const Index n = a.cols();
    VectorXd x = VectorXd::Zero(n);
    std::vector<Index> in;
    const double tiny = 1e-12 * a.norm() * y.norm();
    for (Index step = 0; step < 10 * n; ++step) {
        VectorXd pull = a.transpose() * (y - a * x);
        for (Index i : in) pull[i] = 0.0;
        Index best = 0;
        if (!(pull.maxCoeff(&best) > tiny)) break;
        in.push_back(best);
        while (!in.empty()) {
            const VectorXd s = a(Eigen::all, in).colPivHouseholderQr().solve(y);
            double reach = 1.0;
            for (std::size_t k = 0; k < in.size(); ++k)
                if (s[Index(k)] <= 0.0) reach = std::min(reach, x[in[k]] / (x[in[k]] - s[Index(k)]));
            std::vector<Index> left;
            for (std::size_t k = 0; k < in.size(); ++k) {
                x[in[k]] += reach * (s[Index(k)] - x[in[k]]);
                if (reach < 1.0 && s[Index(k)] <= 0.0 && x[in[k]] <= 1e-14 * (1.0 - s[Index(k)]))
                    x[in[k]] = 0.0;
                else
                    left.push_back(in[k]);
            }
            const bool whole = left.size() == in.size();
            in = left;
            if (whole) break;
        }
    }
    return x;
}

/// Solves for the values of the law's control points on the range: all at least kMinPositiveMm, or each at least the
/// one before.
VectorXd solve_controls(const Problem& problem, const VectorXd& weight, bool held) {
    const LawShape& shape = problem.shape;
    const int n = shape.degree;
    const Index first = shape.through_zero ? 1 : 0;
    MatrixXd from_x = powers_from_controls(n, first ? 0.0 : shape.range_mm[0], shape.range_mm[1]);
    MatrixXd bends = MatrixXd::Zero(std::max(0, n - 1), n + 1);
    for (Index i = 0; i < bends.rows(); ++i) bends.row(i).segment(i, 3) << 1.0, -2.0, 1.0;
    if (shape.rising) {  // x holds the first control point, then the steps up
        const MatrixXd sums = MatrixXd::Ones(n + 1, n + 1).triangularView<Eigen::Lower>();
        from_x = from_x * sums;
        bends = bends * sums;
    }
    LawShape whole = shape;
    whole.through_zero = false;
    const Index rows = problem.depth.size();
    MatrixXd a(rows + bends.rows(), n + 1);
    a << weight.asDiagonal() * powers(problem.depth, whole) * from_x, shape.smoothing * bends;
    VectorXd y = VectorXd::Zero(a.rows());
    y.head(rows) = weight.cwiseProduct(problem.value);
    VectorXd x = VectorXd::Constant(n + 1, held && !shape.rising ? kMinPositiveMm : 0.0);
    if (first) x[0] = 0.0;
    y -= a * x;
    const MatrixXd free = a.rightCols(n + 1 - first);
    x.tail(n + 1 - first) += held ? least_squares_above_zero(free, y) : VectorXd(free.colPivHouseholderQr().solve(y));
    const VectorXd c = from_x * x;
    return c.tail(n + 1 - first);
}

/// Returns the free coefficients for given weights. `held`: within the bounds of the shape.
VectorXd solve(const Problem& problem, const VectorXd& weight, bool held) {
    if (held || problem.shape.smoothing > 0.0) return solve_controls(problem, weight, held);
    const MatrixXd a = powers(problem.depth, problem.shape);
    return (weight.asDiagonal() * a).colPivHouseholderQr().solve(weight.cwiseProduct(problem.value));
}

VectorXd residuals(const Problem& problem, const VectorXd& free) {
    return problem.value - (powers(problem.depth, problem.shape) * free).cwiseMax(problem.shape.floor);
}

/// Solves least squares by `solve(weights)`, or least absolute residuals by reweighting: residuals weighted by
/// 1 / sqrt|residual| count by their size instead of its square. `left(x)`: the residuals.
template <class Solve, class Left>
VectorXd minimise_norm(Norm norm, Index rows, Solve&& solve, Left&& left) {
    checkpoint(1 + int(rows));
    VectorXd free = solve(VectorXd(VectorXd::Ones(rows)));
    if (norm == Norm::squares) return free;
    double cost = left(free).template lpNorm<1>();
    for (int i = 0; i < kMaxReweightings; ++i) {
        checkpoint(1 + int(rows));
        const VectorXd weight = left(free).cwiseAbs().cwiseMax(kMinResidualMm).cwiseSqrt().cwiseInverse();
        const VectorXd next = solve(VectorXd(weight / weight.maxCoeff()));
        const double now = left(next).template lpNorm<1>();
        const bool still = std::abs(now - cost) <= 1e-12 * cost;
        free = next;
        cost = now;
        if (still) break;
    }
    return free;
}

double residual_norm(const VectorXd& residual, Norm norm) {
    return norm == Norm::squares ? residual.squaredNorm() : residual.lpNorm<1>();
}

/// The position of a polynomial at one depth relative to its floor.
enum class Side : char { above, below, on };

/// Lists all sign patterns of a polynomial minus its floor at ascending depths, for a given number of roots. `on` is
/// only possible where `may_touch_floor` is true. Lists at most `most` + 1 patterns.
class SignPatterns {
 public:
    SignPatterns(const std::vector<bool>& may_touch_floor, int roots, std::size_t most)
        : may_touch_floor_(may_touch_floor), most_(most) {
        for (Side first : {Side::above, Side::below}) extend({}, first, roots);
    }
    std::vector<std::vector<Side>> found;

 private:
    /// `side`: the polynomial's side between the previous depth and this one.
    void extend(std::vector<Side> pattern, Side side, int roots) {
        if (found.size() > most_) return;
        if (roots < 1 || pattern.size() == may_touch_floor_.size()) {
            pattern.resize(may_touch_floor_.size(), side);
            found.push_back(std::move(pattern));
            return;
        }
        checkpoint();
        const Side other = side == Side::above ? Side::below : Side::above;
        const bool stops = may_touch_floor_[pattern.size()];
        pattern.push_back(side);
        extend(pattern, side, roots);
        if (stops) {
            pattern.back() = Side::on;
            extend(pattern, other, roots - 1);
            if (roots > 1) extend(pattern, side, roots - 2);  // touches the floor
        }
        if (pattern.size() == 1) return;  // this pattern begins on the other side
        pattern.back() = other;
        extend(pattern, other, roots - 1);
    }
    std::vector<bool> may_touch_floor_;
    std::size_t most_;
};

/// Fits the law with a floor. A value has no effect where the polynomial is below the floor, so that there are several
/// local minima and a solver ends in the one where it began. Therefore all sign patterns relative to the floor are
/// tried. A value below the floor pulls the law down to the floor and no further, so that the law may stop there.
VectorXd solve_with_floor(const Problem& problem) {
    const LawShape& shape = problem.shape;
    const MatrixXd a = powers(problem.depth, shape);
    std::vector<double> depths(problem.depth.data(), problem.depth.data() + problem.depth.size());
    std::sort(depths.begin(), depths.end());
    depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
    std::vector<bool> may_touch_floor(depths.size(), false);
    std::vector<std::size_t> place;
    for (Index i = 0; i < problem.depth.size(); ++i) {
        place.push_back(std::size_t(std::lower_bound(depths.begin(), depths.end(), problem.depth[i]) - depths.begin()));
        if (problem.value[i] < shape.floor) may_touch_floor[place.back()] = true;
    }
    const std::size_t most = shape.norm == Norm::squares ? kMaxPatterns : kMaxPatternsAbsolute;
    std::vector<std::vector<Side>> patterns;
    for (int roots = shape.degree; roots >= 0; --roots) {
        if (roots > 0 && depths.size() > most) continue;  // a root may be between any two depths
        patterns = SignPatterns(may_touch_floor, roots, most).found;
        if (patterns.size() <= most) break;
    }
    VectorXd best, row_weight(a.rows()), target_value = problem.value;
    double least = std::numeric_limits<double>::infinity();
    for (const std::vector<Side>& pattern : patterns) {
        double floor_cost = 0.0;  // cost of the values on and below the floor, for any polynomial
        for (Index i = 0; i < a.rows(); ++i) {
            const Side side = pattern[place[std::size_t(i)]];
            row_weight[i] = side == Side::on ? kFloorWeight : side == Side::below ? 0.0 : 1.0;
            target_value[i] = side == Side::on ? shape.floor : problem.value[i];
            const double off = problem.value_weight[i] * std::abs(problem.value[i] - shape.floor);
            if (side != Side::above) floor_cost += shape.norm == Norm::squares ? off * off : off;
        }
        // A law with this pattern costs at least this much. For most patterns it is already more than the best cost.
        if (floor_cost > least) continue;
        const auto solve_pattern = [&](const VectorXd& weight) -> VectorXd {
            const VectorXd both = weight.cwiseProduct(row_weight).cwiseProduct(problem.value_weight);
            return (both.asDiagonal() * a).colPivHouseholderQr().solve(both.cwiseProduct(target_value));
        };
        const auto left = [&](const VectorXd& free) -> VectorXd {
            return (row_weight.array() == 1.0).select(problem.value_weight.cwiseProduct(target_value - a * free), 0.0);
        };
        const VectorXd free = minimise_norm(shape.norm, a.rows(), solve_pattern, left);
        const double cost = residual_norm(problem.value_weight.cwiseProduct(residuals(problem, free)), shape.norm);
        if (cost < least) {
            least = cost;
            best = free;
        }
    }
    return best;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2) return *middle;
    return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

/// Returns the variance of one value. With absolute residuals it follows, for normal noise, from the median residual of
/// the values that the law does not pass through, times pi / 2 for the lower efficiency of the median.
double variance(const VectorXd& residual, Index terms, int freedom, Norm norm) {
    if (norm == Norm::squares) return residual.squaredNorm() / freedom;
    std::vector<double> size(residual.data(), residual.data() + residual.size());
    for (double& r : size) r = std::abs(r);
    std::sort(size.begin(), size.end());
    size.erase(size.begin(), size.begin() + terms);
    const double s = 1.482602218505602 * median(size);
    return 0.5 * M_PI * s * s;
}

void require_fittable_values(const std::vector<double>& depth, const std::vector<double>& value, const LawShape& shape,
                             const std::vector<double>& scatter) {
    if (!scatter.empty() && scatter.size() != value.size())
        throw Error("sizes-differ", "there are " + std::to_string(value.size()) + " values and " +
                                        std::to_string(scatter.size()) + " scatters; each value needs its scatter");
    for (std::size_t i = 0; i < scatter.size(); ++i)
        require_within(scatter[i], {1.0 / kMaxMagnitude, kMaxMagnitude},
                       "the scatter of value " + std::to_string(i + 1));
    if (depth.size() != value.size())
        throw Error("sizes-differ", "there are " + std::to_string(depth.size()) + " depths and " +
                                        std::to_string(value.size()) + " values; each value needs its depth");
    for (std::size_t i = 0; i < depth.size(); ++i)
        if (!std::isfinite(depth[i]) || !std::isfinite(value[i]))
            throw Error("not-finite", "value " + std::to_string(i + 1) + " or its depth is not a finite number");
    for (std::size_t i = 0; i < depth.size(); ++i)
        for (const auto& [what, number] : {std::pair{"value ", value[i]}, std::pair{"the depth of value ", depth[i]}})
            require_within(number, {-kMaxMagnitude, kMaxMagnitude}, what + std::to_string(i + 1));
    if (shape.degree < 0 || shape.degree > kMaxLawDegree)
        throw Error("law-terms",
                    "the degree of the law, " + std::to_string(shape.degree) + ", is outside the range [0, " +
                        std::to_string(kMaxLawDegree) + "]",
                    "degree", double(shape.degree), std::array<double, 2>{0.0, double(kMaxLawDegree)});
    if (shape.degree == 0 && shape.through_zero)
        throw Error("law-terms",
                    "a law of degree 0 that is 0 at depth 0 has no coefficient to fit: use degree 1 or more");
    for (const double end : shape.range_mm)
        require_within(end, {-kMaxMagnitude, kMaxMagnitude}, "an end of the depths", "range_mm");
    if (!(shape.range_mm[0] < shape.range_mm[1]))
        throw Error("not-ascending",
                    format_text("range_mm is [%.4g, %.4g] mm, but must ascend", shape.range_mm[0], shape.range_mm[1]),
                    "range_mm");
    require_within(shape.range_mm[1] - shape.range_mm[0], {1.0 / kMaxMagnitude, 2.0 * kMaxMagnitude},
                   "the length of the range of depths", "range_mm");
    require_within(shape.smoothing, {0.0, kMaxMagnitude}, "the smoothing", "smoothing");
    if (shape.floor != -std::numeric_limits<double>::infinity())
        require_within(shape.floor, {-kMaxMagnitude, kMaxMagnitude}, "the floor", "floor");
    if (std::isfinite(shape.floor) && (shape.positive || shape.rising || shape.smoothing > 0.0))
        throw Error(
            "options-contradict",
            "a law with a floor cannot also be constrained or smoothed: leave out the floor, or the other options");
    if (depth.empty() && shape.smoothing > 0.0)
        throw Error("measurement-missing", "there are no values to fit a law to");
    if (shape.smoothing > 0.0) return;  // the smoothing determines what the data leave open
    const std::size_t terms = std::size_t(shape.degree) + (shape.through_zero ? 0 : 1);
    std::set<double> different(depth.begin(), depth.end());
    if (shape.through_zero) different.erase(0.0);
    if (different.size() < terms)
        throw Error("depths-too-few",
                    "a law of degree " + std::to_string(shape.degree) + " needs values at " + std::to_string(terms) +
                        " different depths" + (shape.through_zero ? " other than 0" : "") + ", but there are " +
                        std::to_string(different.size()) + ": measure at more depths, or use a lower degree",
                    "", double(different.size()));
}

}  // namespace

LawFit fit_law(const std::vector<double>& depth_mm, const std::vector<double>& value_mm, const LawShape& shape,
               const std::vector<double>& scatter) {
    require_fittable_values(depth_mm, value_mm, shape, scatter);
    const Index count = Index(depth_mm.size());
    VectorXd value_weight = VectorXd::Ones(count);
    for (std::size_t i = 0; i < scatter.size(); ++i) value_weight[Index(i)] = 1.0 / scatter[i];
    if (count > 0) value_weight /= std::sqrt(value_weight.squaredNorm() / double(count));
    const Problem problem{Eigen::Map<const VectorXd>(depth_mm.data(), count),
                          Eigen::Map<const VectorXd>(value_mm.data(), count), shape, value_weight};
    LawFit out;
    const auto solved = [&](bool held) {
        return minimise_norm(
            shape.norm, count,
            [&](const VectorXd& weight) { return solve(problem, weight.cwiseProduct(value_weight), held); },
            [&](const VectorXd& free) -> VectorXd { return value_weight.cwiseProduct(residuals(problem, free)); });
    };
    VectorXd free = std::isfinite(shape.floor) ? solve_with_floor(problem) : solved(false);
    if (!satisfies(all_coefficients(free, shape.through_zero), shape)) {
        out.held = true;
        free = solved(true);
    }
    out.law.coefficients = all_coefficients(free, shape.through_zero);
    out.law.floor = shape.floor;
    const auto [least, greatest] = std::minmax_element(depth_mm.begin(), depth_mm.end());
    if (*least < *greatest) out.law.calibrated_mm = {*least, *greatest};
    const VectorXd residual = residuals(problem, free);
    out.residual_mm.assign(residual.data(), residual.data() + count);
    const double spread = (problem.value.array() - problem.value.mean()).matrix().squaredNorm();
    out.r_squared = spread > 0.0 ? 1.0 - residual.squaredNorm() / spread : 1.0;
    const int freedom = int(count - problem.terms());
    out.degrees_of_freedom = freedom;
    if (freedom < 1) return out;
    out.law.rmse_mm = std::sqrt(residual.squaredNorm() / freedom);
    out.law.degrees_of_freedom = freedom;

    MatrixXd slope = powers(problem.depth, shape);
    const VectorXd polynomial = slope * free;
    for (Index i = 0; i < count; ++i)
        if (polynomial[i] < shape.floor) slope.row(i).setZero();
    slope = value_weight.asDiagonal() * slope;
    Eigen::ColPivHouseholderQR<MatrixXd> qr(slope);
    if (qr.rank() < slope.cols()) return out;  // all but a few values are on the floor
    const MatrixXd inverse = (slope.transpose() * slope).ldlt().solve(MatrixXd::Identity(slope.cols(), slope.cols()));
    const MatrixXd covariance =
        variance(value_weight.cwiseProduct(residual), problem.terms(), freedom, shape.norm) * inverse;
    const double t = interval_factor_95(out.law.degrees_of_freedom);
    const Index first = shape.through_zero ? 1 : 0, size = covariance.rows() + first;
    out.covariance.assign(std::size_t(size), std::vector<double>(std::size_t(size), 0.0));
    out.law.half_interval_95.assign(std::size_t(size), 0.0);
    for (Index i = 0; i < covariance.rows(); ++i) {
        for (Index j = 0; j < covariance.rows(); ++j) out.covariance[i + first][j + first] = covariance(i, j);
        out.law.half_interval_95[i + first] = t * std::sqrt(covariance(i, i));
    }
    return out;
}

}  // namespace brushsvg::fit
