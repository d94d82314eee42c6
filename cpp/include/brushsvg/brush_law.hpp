#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace [[gnu::visibility("default")]] brushsvg {

/// A law: one brush parameter [mm] against the press depth d [mm].
///     value(d) = max(floor + floor_slope d, c0 + c1 d + c2 d^2 + ...)
/// See article (24) to (27). The floor is the max(0, .) of (24).
struct Profile {
    std::vector<double> coefficients;                         ///< c0, c1, ..., in ascending powers of depth
    double floor = -std::numeric_limits<double>::infinity();  ///< [mm]; minus infinity: no floor
    double floor_slope = 0.0;
    std::optional<std::array<double, 2>> calibrated_mm;  ///< least and greatest measured depth; none: not known
    std::string source;                                  ///< where the law comes from, in words
    bool assumed = false;                                ///< true if the law was not measured
    std::vector<double> half_interval_95;      ///< half of the 95 % interval of each coefficient; empty: not known
    std::optional<double> rmse_mm;             ///< root mean square error of the fit; none: not known
    std::optional<double> degrees_of_freedom;  ///< number of spare values from which the scatter is known
    std::string extra = "{}";                  ///< JSON object of unknown keys, written back as read
    /// Depths to which the brush may be pressed, which limit at(). read_brush() sets them; none: any depth. They are
    /// not part of the law: comparing and writing laws ignores them.
    std::optional<std::array<double, 2>> depth_range_mm;

    /// Return the value [mm] at a depth [mm] that the brush can have.
    ///
    /// These are the depths from 0, where the brush touches the paper, to the greatest of `depth_range_mm`. Throws
    /// Error (depth-out-of-range) for other depths, where the polynomial would be meaningless.
    double at(double depth_mm) const;

    /// Return the value [mm] at any depth [mm], without a check. For inner loops. T is any scalar with arithmetic, so a
    /// solver can differentiate the law.
    template <class T>
    T operator()(const T& depth_mm) const {
        T polynomial(0.0);
        for (std::size_t i = coefficients.size(); i-- > 0;) polynomial = polynomial * depth_mm + coefficients[i];
        if (floor == -std::numeric_limits<double>::infinity()) return polynomial;
        const T least = floor + floor_slope * depth_mm;
        return polynomial < least ? least : polynomial;
    }
};

/// Greatest degree of a law's polynomial.
inline constexpr int kMaxLawDegree = 10;

/// Throw Error (law-terms) unless a law has 1 to kMaxLawDegree + 1 coefficients.
///
/// `coefficients`: c0, c1, ..., in ascending powers of depth. `where`: the law that the error names.
void require_law_degree(const std::vector<double>& coefficients, const std::string& where);

/// A polynomial (ascending coefficients) that holds on [lo, hi].
struct PolynomialPiece {
    double lo, hi;
    std::vector<double> coefficients;
};

/// Return a law as polynomials on the depths [lo, hi] [mm].
///
/// It is split where the floor and the polynomial cross.
std::vector<PolynomialPiece> pieces(const Profile& profile, double lo, double hi);

/// Return the difference a - b as polynomials on the depths [lo, hi] [mm].
///
/// It is split where either law is split.
std::vector<PolynomialPiece> difference(const Profile& a, const Profile& b, double lo, double hi);

/// Return the real roots of a polynomial in [lo, hi], in ascending order.
///
/// `coefficients`: in ascending powers.
std::vector<double> real_roots(const std::vector<double>& coefficients, double lo, double hi);

}  // namespace brushsvg
