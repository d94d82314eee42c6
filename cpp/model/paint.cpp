#include "brushsvg/paint.hpp"

#include <cmath>
#include <limits>

#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

// At 20 per m, a mark has half its width after 35 mm, which is no usable load.
constexpr std::array<double, 2> kNarrowingRangePerM{0.0, 20.0};
constexpr std::array<double, 2> kLoadLengthRangeMm{1.0, 1e6};  // same range as a cell's reload.every_mm
constexpr double kMaxCorrelationError = 1e-4;  // error of a correlation when a covariance is rounded to five digits

void require_within(double value, const std::array<double, 2>& range, const char* key, const char* in_words) {
    if (!(value >= range[0] && value <= range[1]))
        throw Error("out-of-range", std::string(key) + " must be within " + in_words, std::string("paint.") + key,
                    value, range);
}

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
        refuse("covariance must have " + std::to_string(n) + " rows of as many numbers: one for narrows_per_m" +
               (n == 2 ? ", one for lasts_mm" : ""));
    for (const std::vector<double>& row : c)
        for (const double value : row)
            if (!std::isfinite(value)) throw Error("not-finite", "a number is not finite", "paint.covariance");
    for (std::size_t i = 0; i < n; ++i)
        if (c[i][i] < 0.0) refuse("a variance must not be negative");
    if (n == 1) return;
    const double most = std::sqrt(c[0][0]) * std::sqrt(c[1][1]);
    if (std::abs(c[0][1] - c[1][0]) > kMaxCorrelationError * most) refuse("a covariance is symmetric");
    if (std::abs(c[0][1]) > (1.0 + kMaxCorrelationError) * most)
        refuse("some sum of the numbers would have a negative variance: a covariance is positive semi-definite");
}

}  // namespace

double Paint::width_share(double way_mm) const { return std::exp(-1e-3 * narrows_per_m * way_mm); }

double Paint::path_to_share_mm(double share) const {
    if (!(narrows_per_m > 0.0)) return std::numeric_limits<double>::infinity();
    return -1e3 * std::log(share) / narrows_per_m;
}

void check(const Paint& paint) {
    require_within(paint.narrows_per_m, kNarrowingRangePerM, "narrows_per_m", "[0, 20] per metre");
    if (paint.lasts_mm) require_within(*paint.lasts_mm, kLoadLengthRangeMm, "lasts_mm", "[1, 1e6] mm");
    if (const auto& measured = paint.calibrated_mm;
        measured &&
        !((*measured)[0] >= 0.0 && (*measured)[0] < (*measured)[1] && (*measured)[1] <= kLoadLengthRangeMm[1]))
        throw Error("out-of-range", "the ways that were measured must rise within [0, 1e6] mm", "paint.calibrated_mm");
    if (paint.degrees_of_freedom)
        require_within(*paint.degrees_of_freedom, {1.0, 1e9}, "degrees_of_freedom", "[1, 1e9]");
    check_covariance(paint);
}

}  // namespace brushsvg
