#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace [[gnu::visibility("default")]] brushsvg {

/// One brush parameter [mm] against press depth [mm]:
///     value(d) = max(floor + floor_slope d, c0 + c1 d + c2 d^2 + ...)
/// (article (24) to (27); the floor is the max(0, .) of (24)), with the range of depths it was measured on.
struct Profile {
    std::vector<double> coefficients;  ///< ascending powers of depth
    double floor = -std::numeric_limits<double>::infinity();
    double floor_slope = 0.0;
    std::optional<std::array<double, 2>> calibrated_mm;
    std::string source;
    bool assumed = false;
    std::vector<double> half_interval_95;  ///< per coefficient, empty when not known
    std::optional<double> rmse_mm;
    std::optional<double> degrees_of_freedom;  ///< values to spare, from which its scatter is known
    std::string extra = "{}";  ///< JSON object of the keys this version does not know; written back as read
    /// Depths at which at() answers: how deep its brush may be pressed. read_brush() sets it; none: any depth. It is
    /// no part of the law: laws are equal, and written, without it.
    std::optional<std::array<double, 2>> depth_range_mm;

    /// Value at a depth [mm] that the brush can have, from touching the paper to the deepest of `depth_range_mm`.
    /// Throws Error (depth-out-of-range) for any other depth: a polynomial is soon nonsense beyond its measurements.
    double at(double depth_mm) const;

    /// Value at any depth [mm], not checked; any scalar with arithmetic (a solver differentiates it). For inner loops.
    template <class T>
    T operator()(const T& depth_mm) const {
        T polynomial(0.0);
        for (std::size_t i = coefficients.size(); i-- > 0;) polynomial = polynomial * depth_mm + coefficients[i];
        if (floor == -std::numeric_limits<double>::infinity()) return polynomial;
        const T least = floor + floor_slope * depth_mm;
        return polynomial < least ? least : polynomial;
    }
};

/// Greatest degree of a law that is followed.
inline constexpr int kMaxLawDegree = 10;

/// A polynomial that holds on [lo, hi].
struct PolynomialPiece {
    double lo, hi;
    std::vector<double> coefficients;
};

/// The profile on [lo, hi] as polynomials, split where its floor takes over.
std::vector<PolynomialPiece> pieces(const Profile& profile, double lo, double hi);

/// a - b as polynomials on [lo, hi], split where either changes.
std::vector<PolynomialPiece> difference(const Profile& a, const Profile& b, double lo, double hi);

/// Real roots of a polynomial (ascending coefficients) inside [lo, hi], ascending.
std::vector<double> real_roots(const std::vector<double>& coefficients, double lo, double hi);

}  // namespace brushsvg
