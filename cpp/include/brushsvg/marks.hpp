#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// The motion of the contact patch during one pass, in parallel rows.
///
/// Coordinates are in the paper frame. In rows with depth_mm < 0 the brush is lifted.
struct PassMarks {
    std::string stroke;
    std::vector<double> pose;         ///< index of the pass's pose, fractional between poses; see pose_rows()
    Ring tcp_mm;                      ///< q
    Ring contact_mm;                  ///< p, the centre of friction
    std::vector<double> heading_rad;  ///< direction from the contact to the TCP
    std::vector<double> depth_mm;
    std::vector<unsigned char> taut;  ///< 1 while taut, 0 while loose or lifted
    std::vector<double> pull;         ///< r'/r, 1 when taut
    Ring lean_mm_per_mm;              ///< how far a tilted brush's axis goes sideways per mm up; empty: upright
    /// Width of the footprint as a share of a freshly dipped brush's; empty: 1. Filled in by narrow() in narrow.hpp.
    std::vector<double> width_share;
    Rings outline_mm;  ///< filled in by outline() in coverage.hpp
};

/// Return the matrix that stretches a leaning brush's footprint about its contact:
///     S = I + s s^T / (1 + sqrt(1 + |s|^2)),  |s| = tan t
/// A plane at an angle t to the brush's cross-section cuts a longer section. In the direction of the lean it is
/// 1 / cos t as long.
///
/// `lean`: s, the sideways distance of the brush's axis per mm up.
inline Eigen::Matrix2d stretch_of(const Eigen::RowVector2d& lean) {
    return Eigen::Matrix2d::Identity() + lean.transpose() * lean / (1.0 + std::sqrt(1.0 + lean.squaredNorm()));
}

/// The marks of all passes of a plan, in painting order.
struct Marks {
    std::vector<PassMarks> passes;
    Rings outline_mm;  ///< union over all passes
};

}  // namespace brushsvg
