#include "angles.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "base/format_text.hpp"
#include "base/within.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg::fit {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Beyond 90 degrees the bristles are loose. The patch then rests for s = -2 r cos(alpha0), and is at 180 degrees -
// alpha0 afterwards, so that (7), (11), (12) and all equations derived from them do not hold. Angles are only read to
// a degree or two, however, and readings of a turn by 90 degrees may be above or below 90. (19) is off by 0.0005 lags
// at 95 degrees, by 0.004 at 100 and by 0.1 at 120.
constexpr double kMaxAlpha0Rad = 95.0 * M_PI / 180.0 + 1e-9;
constexpr double kMaxLengthMm = 1e6;  // a longer drag is damaged data

/// Returns k of the line y = k x through the origin.
double slope(const VectorXd& x, const VectorXd& y, Lines lines) {
    const double plain = x.dot(y) / x.squaredNorm();
    if (lines == Lines::plain) return plain;
    const double scale = y.norm() / x.norm();  // scales F, which counts e-foldings, to the millimetres of s
    MatrixXd both(x.size(), 2);
    both << scale * x, y;
    const Eigen::Vector2d across = both.jacobiSvd(Eigen::ComputeFullV).matrixV().col(1);
    return -scale * across[0] / across[1];
}

double rmse(const VectorXd& left) {
    return left.size() > 1 ? std::sqrt(left.squaredNorm() / double(left.size() - 1)) : 0.0;
}

}  // namespace

FromAngles from_angles(const AngleSeries& series, Lines lines) {
    const std::size_t n = series.s_mm.size();
    if (series.alpha.size() != n || !(series.beta.empty() || series.beta.size() == n))
        throw Error("sizes-differ", "there are " + std::to_string(n) + " distances and " +
                                        std::to_string(series.alpha.size()) +
                                        " angles; each distance needs its angles");
    if (!(series.alpha0 > 0.0 && series.alpha0 <= kMaxAlpha0Rad)) {
        const double degrees = series.alpha0 * 180.0 / M_PI;
        throw Error(
            "out-of-range",
            format_text(
                "the first angle is %g degrees, outside the range (0, 95] degrees, in which the patch moves from the "
                "start: leave out the readings before the first one in this range, and measure s from there",
                degrees),
            "alpha0", degrees, std::array<double, 2>{0.0, 95.0});
    }
    FromAngles out{0, 0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(), 0};
    std::vector<std::size_t> used;
    for (std::size_t i = 0; i < n; ++i) {
        const std::string reading = "reading " + std::to_string(i + 1);
        require_within(series.s_mm[i], {-kMaxLengthMm, kMaxLengthMm}, "the distance of " + reading);
        require_within(series.alpha[i], {-2.0 * M_PI, 2.0 * M_PI}, "the angle [rad] of " + reading);
        if (series.s_mm[i] > 0.0 && series.alpha[i] > 0.0 && series.alpha[i] < series.alpha0)
            used.push_back(i);
        else
            ++out.left_out;
    }
    if (used.empty())
        throw Error("measurement-missing",
                    "no reading can be used, because no angle is between 0 and the first angle: measure while the "
                    "brush is dragged");
    const auto log_cot_half = [](double a) { return -std::log(std::tan(0.5 * a)); };
    const Eigen::Index m = Eigen::Index(used.size());
    VectorXd s(m), f(m);
    for (Eigen::Index i = 0; i < m; ++i) {
        s[i] = series.s_mm[used[i]];
        f[i] = log_cot_half(series.alpha0) - log_cot_half(series.alpha[used[i]]);  // (19)
    }
    out.lag_mm = -slope(f, s, lines);  // (20)
    // The logarithm of an angle that has hardly changed is lost in rounding, and the lag may then have any size.
    require_within(out.lag_mm, {0.0, kMaxLengthMm}, "the lag from the angles", "alpha");
    out.lag_rmse_mm = rmse(s + out.lag_mm * f);
    if (series.beta.empty()) return out;

    // The integrals of (21) in closed form, from (10):
    // int sin^2 ds = r (cos a1 - cos a0), int sin cos ds = r (sin a0 - sin a1).
    VectorXd integral(m);
    for (Eigen::Index i = 0; i < m; ++i) {
        const double a1 = series.alpha[used[i]], beta = series.beta[used[i]];
        if (!(beta > 0.0 && beta < M_PI))
            throw Error(
                "out-of-range",
                format_text(
                    "the direction of the tip's displacement is %.4g degrees, outside the range (0, 180) degrees",
                    beta * 180.0 / M_PI),
                "beta", beta * 180.0 / M_PI, std::array<double, 2>{0.0, 180.0});
        integral[i] = out.lag_mm * (std::cos(a1) - std::cos(series.alpha0) +
                                    (std::sin(series.alpha0) - std::sin(a1)) / std::tan(beta));
    }
    const double mu = slope(integral, s, lines);  // (22)
    out.tip_gap_mm = (mu - 1.0) * out.lag_mm;     // (23)
    require_within(out.tip_gap_mm, {-kMaxLengthMm, kMaxLengthMm}, "the tip gap from the angles", "beta");
    out.tip_gap_rmse_mm = rmse(s - mu * integral);
    return out;
}

}  // namespace brushsvg::fit
