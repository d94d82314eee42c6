#include "brushsvg/paint.hpp"

#include <cmath>
#include <limits>

#include "base/format_text.hpp"
#include "base/within.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

// At 20 per m, a mark has half its width after 35 mm, which is no usable load.
constexpr std::array<double, 2> kNarrowingRangePerM{0.0, 20.0};
constexpr std::array<double, 2> kLoadLengthRangeMm{1.0, 1e6};  // same range as a cell's reload.every_mm
constexpr double kMaxCorrelationError = 1e-4;  // error of a correlation when a covariance is rounded to five digits

void check_covariance(const Paint& paint) {
    const auto& c = paint.covariance;
    if (c.empty()) return;
    const auto refuse = [](const std::string& sentence) {
        throw Error("covariance-invalid", sentence, "paint.covariance");
    };
    const std::size_t n = paint.count();
    bool square = c.size() == n;
    for (const std::vector<double>& row : c) square = square && row.size() == n;
    if (!square)
        refuse(n == 2 ? "covariance must have 2 rows of 2 numbers, for narrows_per_m and lasts_mm"
                      : "covariance must have 1 row of 1 number, for narrows_per_m");
    for (const std::vector<double>& row : c)
        for (const double value : row)
            if (!std::isfinite(value))
                throw Error("not-finite", "the covariance contains a number that is not finite", "paint.covariance");
    for (std::size_t i = 0; i < n; ++i)
        if (c[i][i] < 0.0)
            refuse(format_text(
                "the variance is %.4g, but must be at least 0: compute the covariance again, or leave it out",
                c[i][i]));
    if (n == 1) return;
    const double most = std::sqrt(c[0][0]) * std::sqrt(c[1][1]);
    if (std::abs(c[0][1] - c[1][0]) > kMaxCorrelationError * most)
        refuse(format_text(
            "the covariance is not symmetric, because %.4g differs from the mirrored number %.4g: compute it again, "
            "or leave it out",
            c[0][1], c[1][0]));
    if (std::abs(c[0][1]) > (1.0 + kMaxCorrelationError) * most)
        refuse(
            "the covariance is not positive semi-definite, so some sum of the two numbers would have a negative "
            "variance: compute it again, or leave it out");
}

}  // namespace

double Paint::width_share(double way_mm) const { return std::exp(-1e-3 * narrows_per_m * way_mm); }

double Paint::path_to_share_mm(double share) const {
    if (!(narrows_per_m > 0.0)) return std::numeric_limits<double>::infinity();
    return -1e3 * std::log(share) / narrows_per_m;
}

void check(const Paint& paint) {
    require_within(paint.narrows_per_m, kNarrowingRangePerM, "narrows_per_m", "paint.narrows_per_m");
    if (paint.lasts_mm) require_within(*paint.lasts_mm, kLoadLengthRangeMm, "lasts_mm", "paint.lasts_mm");
    if (const auto& measured = paint.calibrated_mm;
        measured &&
        !((*measured)[0] >= 0.0 && (*measured)[0] < (*measured)[1] && (*measured)[1] <= kLoadLengthRangeMm[1]))
        throw Error(
            "out-of-range",
            format_text("calibrated_mm is [%.4g, %.4g] mm, but must be two ascending lengths within [0, 1e6] mm",
                        (*measured)[0], (*measured)[1]),
            "paint.calibrated_mm");
    if (paint.degrees_of_freedom)
        require_within(*paint.degrees_of_freedom, {1.0, 1e9}, "degrees_of_freedom", "paint.degrees_of_freedom");
    check_covariance(paint);
}

}  // namespace brushsvg
