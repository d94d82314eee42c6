#include "law_fit.hpp"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <set>
#include <string>

#include "brushsvg/error.hpp"

namespace brushsvg::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// What an absolute residual counts as at least when it is a weight's denominator: far below what a ruler or a camera
// tells apart, far above rounding.
constexpr double kLeastResidualMm = 1e-9;
constexpr int kMostReweightings = 500;
constexpr double kLeastPositiveMm = 0.01;  // of a law that must stay above 0: a lever of no length has no heading

struct Problem {
    VectorXd depth, value;
    LawShape shape;
    Index terms() const { return shape.degree + (shape.through_zero ? 0 : 1); }
};

/// Powers of depth, without the constant term where there is none.
MatrixXd powers(const VectorXd& depth, const LawShape& shape) {
    const Index first = shape.through_zero ? 1 : 0;
    MatrixXd out(depth.size(), shape.degree + 1 - first);
    for (Index j = 0; j < out.cols(); ++j) out.col(j) = depth.array().pow(double(j + first));
    return out;
}

/// Coefficients (ascending) from the values of a polynomial's control points on the range: Bernstein to powers.
MatrixXd powers_from_controls(int degree, double lo, double hi) {
    MatrixXd unit = MatrixXd::Zero(degree + 1, degree + 1);  // in t = (d - lo) / (hi - lo)
    const auto binomial = [](int n, int k) {
        double out = 1.0;
        for (int i = 0; i < k; ++i) out = out * (n - i) / (i + 1);
        return out;
    };
    for (int j = 0; j <= degree; ++j)
        for (int k = j; k <= degree; ++k)
            unit(k, j) = binomial(degree, j) * binomial(degree - j, k - j) * ((k - j) % 2 ? -1.0 : 1.0);
    MatrixXd shift = MatrixXd::Zero(degree + 1, degree + 1);  // t^k in powers of d
    for (int k = 0; k <= degree; ++k)
        for (int i = 0; i <= k; ++i) shift(i, k) = binomial(k, i) * std::pow(-lo, k - i) / std::pow(hi - lo, k);
    return shift * unit;
}

std::vector<double> coefficients_of(const VectorXd& free, bool through_zero) {
    std::vector<double> out(through_zero ? 1 : 0, 0.0);
    out.insert(out.end(), free.data(), free.data() + free.size());
    return out;
}

bool keeps(const std::vector<double>& c, const LawShape& shape) {
    const auto [lo, hi] = shape.range_mm;
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
    if (shape.positive && !(from_zero ? least(c) >= 0.0 : least(c) >= kLeastPositiveMm)) return false;
    return !shape.rising || (value(c, lo) >= 0.0 && least(slope_of(c)) >= -1e-12);
}

/// weight * (max(floor, A x) - y), and bends * x: what Ceres minimises under bounds on x.
class Residuals : public ceres::CostFunction {
 public:
    Residuals(const MatrixXd& a, const VectorXd& y, const VectorXd& weight, double floor, const MatrixXd& bends)
        : a_(a), y_(y), weight_(weight), floor_(floor), bends_(bends) {
        set_num_residuals(int(a.rows() + bends.rows()));
        mutable_parameter_block_sizes()->push_back(int(a.cols()));
    }
    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        const Eigen::Map<const VectorXd> x(parameters[0], a_.cols());
        Eigen::Map<VectorXd> out(residuals, num_residuals());
        const VectorXd p = a_ * x;
        out.head(a_.rows()) = weight_.cwiseProduct(p.cwiseMax(floor_) - y_);
        out.tail(bends_.rows()) = bends_ * x;
        if (jacobians && jacobians[0]) {
            using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
            Eigen::Map<RowMajor> slope(jacobians[0], num_residuals(), a_.cols());
            slope.topRows(a_.rows()) = weight_.asDiagonal() * a_;
            for (Index i = 0; i < a_.rows(); ++i)
                if (p[i] < floor_) slope.row(i).setZero();
            slope.bottomRows(bends_.rows()) = bends_;
        }
        return true;
    }

 private:
    MatrixXd a_;
    VectorXd y_, weight_;
    double floor_;
    MatrixXd bends_;
};

/// Least squares over control points x that keep the shape: all at least kLeastPositiveMm, or each step up at least 0.
VectorXd solve_held(const Problem& problem, const VectorXd& weight, bool bound) {
    const LawShape& shape = problem.shape;
    const auto [lo, hi] = shape.range_mm;
    const int n = shape.degree;
    MatrixXd from_x = powers_from_controls(n, lo, hi);
    if (shape.rising)  // x: the first control point, then the steps
        from_x = from_x * MatrixXd(MatrixXd::Ones(n + 1, n + 1).triangularView<Eigen::Lower>());
    LawShape whole = shape;
    whole.through_zero = false;
    const MatrixXd a = powers(problem.depth, whole) * from_x;
    MatrixXd bends = MatrixXd::Zero(std::max(0, n - 1), n + 1);
    for (Index i = 0; i < bends.rows(); ++i) {
        if (shape.rising)
            bends.row(i).segment(i + 1, 2) << -1.0, 1.0;
        else
            bends.row(i).segment(i, 3) << 1.0, -2.0, 1.0;
    }
    bends *= shape.smoothing;
    VectorXd x = VectorXd::Constant(n + 1, shape.rising ? problem.value.cwiseAbs().maxCoeff() / (n + 1)
                                                        : std::max(kLeastPositiveMm, problem.value.mean()));
    if (shape.through_zero) x[0] = 0.0;
    ceres::Problem solver;
    solver.AddParameterBlock(x.data(), n + 1);
    solver.AddResidualBlock(new Residuals(a, problem.value, weight, shape.floor, bends), nullptr, x.data());
    if (shape.through_zero) solver.SetManifold(x.data(), new ceres::SubsetManifold(n + 1, {0}));
    for (int i = shape.through_zero ? 1 : 0; bound && i <= n; ++i)
        if (shape.rising || shape.positive)
            solver.SetParameterLowerBound(x.data(), i, shape.rising ? 0.0 : kLeastPositiveMm);
    ceres::Solver::Options options;
    options.logging_type = ceres::SILENT;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 1000;
    options.function_tolerance = 1e-16;
    options.gradient_tolerance = 1e-14;
    options.parameter_tolerance = 1e-14;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &solver, &summary);
    if (!summary.IsSolutionUsable()) throw Error("no law of this shape could be fitted: " + summary.message);
    const VectorXd c = from_x * x;
    return shape.through_zero ? VectorXd(c.tail(n)) : c;
}

/// Free coefficients for given weights. `held`: under the bounds of the shape.
VectorXd solve(const Problem& problem, const VectorXd& weight, bool held) {
    if (held || std::isfinite(problem.shape.floor) || problem.shape.smoothing > 0.0)
        return solve_held(problem, weight, held);
    const MatrixXd a = powers(problem.depth, problem.shape);
    return (weight.asDiagonal() * a).colPivHouseholderQr().solve(weight.cwiseProduct(problem.value));
}

VectorXd residuals(const Problem& problem, const VectorXd& free) {
    return problem.value - (powers(problem.depth, problem.shape) * free).cwiseMax(problem.shape.floor);
}

/// Iteratively reweighted least squares: residuals weighted by 1 / sqrt|residual| count by their size, not its square.
VectorXd solve_norm(const Problem& problem, bool held) {
    VectorXd weight = VectorXd::Ones(problem.depth.size());
    VectorXd free = solve(problem, weight, held);
    if (problem.shape.norm == Norm::squares) return free;
    double cost = residuals(problem, free).lpNorm<1>();
    for (int i = 0; i < kMostReweightings; ++i) {
        weight = residuals(problem, free).cwiseAbs().cwiseMax(kLeastResidualMm).cwiseSqrt().cwiseInverse();
        const VectorXd next = solve(problem, weight / weight.maxCoeff(), held);
        const double now = residuals(problem, next).lpNorm<1>();
        const bool still = std::abs(now - cost) <= 1e-12 * cost;
        free = next;
        cost = now;
        if (still) break;
    }
    return free;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2) return *middle;
    return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

/// Variance of one value. Absolute residuals: from the median of those that the law does not pass through, for normal
/// noise, times pi / 2, what the median costs against the mean.
double variance(const VectorXd& residual, Index terms, int freedom, Norm norm) {
    if (norm == Norm::squares) return residual.squaredNorm() / freedom;
    std::vector<double> size(residual.data(), residual.data() + residual.size());
    for (double& r : size) r = std::abs(r);
    std::sort(size.begin(), size.end());
    size.erase(size.begin(), size.begin() + terms);
    const double s = 1.482602218505602 * median(size);
    return 0.5 * M_PI * s * s;
}

void refuse_what_cannot_be_fitted(const std::vector<double>& depth, const std::vector<double>& value,
                                  const LawShape& shape) {
    if (depth.size() != value.size())
        throw Error("there are " + std::to_string(depth.size()) + " depths and " + std::to_string(value.size()) +
                    " values; each value needs its depth");
    for (std::size_t i = 0; i < depth.size(); ++i)
        if (!std::isfinite(depth[i]) || !std::isfinite(value[i]))
            throw Error("value " + std::to_string(i + 1) + " or its depth is not a finite number");
    if (shape.degree < 0 || shape.degree > kMaxLawDegree)
        throw Error("a law of degree " + std::to_string(shape.degree) + " is outside the range [0, 8]");
    if (shape.smoothing > 0.0) return;  // which decides where the data leave it open
    const std::size_t terms = std::size_t(shape.degree) + (shape.through_zero ? 0 : 1);
    std::set<double> different(depth.begin(), depth.end());
    if (shape.through_zero) different.erase(0.0);
    if (different.size() < terms)
        throw Error("a law of degree " + std::to_string(shape.degree) + " needs values at " + std::to_string(terms) +
                        " different depths" + (shape.through_zero ? " other than 0" : "") + ", there are " +
                        std::to_string(different.size()) + ": measure at more depths, or ask for a lower degree",
                    "", double(different.size()));
}

}  // namespace

LawFit fit_law(const std::vector<double>& depth_mm, const std::vector<double>& value_mm, const LawShape& shape) {
    refuse_what_cannot_be_fitted(depth_mm, value_mm, shape);
    const Index count = Index(depth_mm.size());
    const Problem problem{Eigen::Map<const VectorXd>(depth_mm.data(), count),
                          Eigen::Map<const VectorXd>(value_mm.data(), count), shape};
    LawFit out;
    VectorXd free = solve_norm(problem, false);
    if (!keeps(coefficients_of(free, shape.through_zero), shape)) {
        out.held = true;
        free = solve_norm(problem, true);
    }
    out.law.coefficients = coefficients_of(free, shape.through_zero);
    out.law.floor = shape.floor;
    const auto [least, greatest] = std::minmax_element(depth_mm.begin(), depth_mm.end());
    if (*least < *greatest) out.law.calibrated_mm = {*least, *greatest};
    const VectorXd residual = residuals(problem, free);
    out.residual_mm.assign(residual.data(), residual.data() + count);
    const double spread = (problem.value.array() - problem.value.mean()).matrix().squaredNorm();
    out.r_squared = spread > 0.0 ? 1.0 - residual.squaredNorm() / spread : 1.0;
    out.degrees_of_freedom = int(count - problem.terms());
    if (out.degrees_of_freedom < 1) return out;
    out.law.rmse_mm = std::sqrt(residual.squaredNorm() / out.degrees_of_freedom);

    MatrixXd slope = powers(problem.depth, shape);
    const VectorXd polynomial = slope * free;
    for (Index i = 0; i < count; ++i)
        if (polynomial[i] < shape.floor) slope.row(i).setZero();
    Eigen::ColPivHouseholderQR<MatrixXd> qr(slope);
    if (qr.rank() < slope.cols()) return out;  // all but a few values lie on the floor
    const MatrixXd inverse = (slope.transpose() * slope).ldlt().solve(MatrixXd::Identity(slope.cols(), slope.cols()));
    const MatrixXd covariance = variance(residual, problem.terms(), out.degrees_of_freedom, shape.norm) * inverse;
    const double t = boost::math::quantile(boost::math::students_t(out.degrees_of_freedom), 0.975);
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
