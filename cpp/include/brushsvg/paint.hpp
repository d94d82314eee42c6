#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace [[gnu::visibility("default")]] brushsvg {

/// The law of paint: how the mark narrows with the path painted since the last dip.
///     width = width of a freshly dipped brush * exp(-narrows_per_m s / 1000)
/// s is the path of the TCP on the paper [mm]. So the share by which a stretch narrows the mark does not depend on the
/// path before it.
struct Paint {
    double narrows_per_m = 0.0;                          ///< decay of the width [1/m]
    std::optional<double> lasts_mm;                      ///< length of path after which hairs run dry; none: not known
    std::optional<std::array<double, 2>> calibrated_mm;  ///< least and greatest measured path since the dip
    std::string source;                                  ///< where the law comes from, in words
    bool assumed = false;                                ///< true if the law was not measured
    std::vector<std::vector<double>> covariance;         ///< of narrows_per_m, and of lasts_mm if known; may be empty
    std::optional<double> degrees_of_freedom;            ///< number of spare values from which the scatter is known
    std::string extra = "{}";                            ///< JSON object of unknown keys, written back as read

    /// Return the width as a share of a freshly dipped brush's width, after a path [mm].
    double width_share(double way_mm) const;
    /// Return the path [mm] after which the width has fallen to a share.
    ///
    /// The share is of a freshly dipped brush's width. Infinite if the width never falls that far.
    double path_to_share_mm(double share) const;
    /// Return how many numbers the law has, in the covariance's order.
    std::size_t count() const { return lasts_mm ? 2 : 1; }
};

/// Throw Error for values that no paint can have.
///
/// Its `where` is the key path in brush.json.
void check(const Paint& paint);

}  // namespace brushsvg
