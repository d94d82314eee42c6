#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace [[gnu::visibility("default")]] brushsvg {

/// What the way painted since the brush fetched paint does to its mark:
///     width = width of a freshly dipped brush * exp(-narrows_per_m s / 1000),  s the way in mm,
/// so the share that a way takes does not depend on the way before it. The way is the TCP's on the paper.
struct Paint {
    double narrows_per_m = 0.0;
    std::optional<double> lasts_mm;                      ///< the way after which hairs run dry
    std::optional<std::array<double, 2>> calibrated_mm;  ///< ways since the dip that were measured
    std::string source;
    bool assumed = false;
    std::vector<std::vector<double>> covariance;  ///< of narrows_per_m, and lasts_mm where it is known, or empty
    std::optional<double> degrees_of_freedom;     ///< values to spare, from which their scatter is known
    std::string extra = "{}";                     ///< JSON object of unknown keys, written back as read

    /// Width over that of a freshly dipped brush, after a way [mm].
    double width_share(double way_mm) const;
    /// The way [mm] after which the width is that share of a freshly dipped brush's; infinite where it never is.
    double way_to_share_mm(double share) const;
    /// Numbers that it has, in the covariance's order.
    std::size_t count() const { return lasts_mm ? 2 : 1; }
};

/// Throws Error, with `where` = key path of brush.json, for paint that none can be.
void check(const Paint& paint);

}  // namespace brushsvg
