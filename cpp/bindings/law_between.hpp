#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "base/format_text.hpp"
#include "base/within.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/lag.hpp"

inline constexpr double kMaxLengthMm = 1e6;  // limit of lengths; a longer one is an error in the data

/// Return the law of a lever between two depths [mm].
///
/// Throws Error if the lever is negative, or 0 at some depths. Only the lever of a rigid pen is 0 at all depths.
inline brushsvg::LagLaw<double> make_law_between(const brushsvg::Profile& profile, double depth0, double depth1) {
    brushsvg::require_law_degree(profile.coefficients, "");
    for (const double c : profile.coefficients)
        brushsvg::require_within(c, {-kMaxLengthMm, kMaxLengthMm}, "a coefficient of the lag");
    for (const double depth : {depth0, depth1}) brushsvg::require_within(depth, {0.0, 1000.0}, "the depth");
    const double lo = std::min(depth0, depth1), hi = std::max(depth0, depth1) + 1e-9;
    brushsvg::LagLaw<double> law = brushsvg::make_law(brushsvg::pieces(profile, lo, hi));
    if (law.rigid) return law;
    for (const auto& piece : law.pieces) {
        const std::vector<double> own(piece.coefficients.begin(), piece.coefficients.begin() + piece.degree + 1);
        const std::vector<double> zeros = brushsvg::real_roots(own, piece.lo, piece.hi);
        const bool falls = !zeros.empty() && !(zeros.size() == 1 && zeros[0] <= 1e-12);  // 0 at touch-down is valid
        if (falls || piece.at(0.5 * (piece.lo + piece.hi)) < 0.0)
            throw brushsvg::Error(
                "law-negative",
                brushsvg::format_text(
                    "the lag is not positive at all depths from %.4g to %.4g mm: correct its coefficients, or "
                    "use depths where it is positive",
                    lo, hi));
    }
    return law;
}
