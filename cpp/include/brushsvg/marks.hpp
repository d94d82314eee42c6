#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// What the patch does during one pass. Rows are parallel. depth_mm < 0 marks rows where the brush is lifted.
struct PassMarks {
    std::string stroke;
    std::vector<double> pose;  ///< index into the pass's poses, fractional between poses; see pose_rows()
    Ring tcp_mm;               ///< q
    Ring contact_mm;           ///< p, centre of friction
    std::vector<double> heading_rad;
    std::vector<double> depth_mm;
    std::vector<unsigned char> taut;
    std::vector<double> pull;  ///< r'/r, 1 when taut
    Ring lean_mm_per_mm;       ///< how far a tilted brush's axis goes sideways for each mm up; empty: upright
    /// How wide the footprint is by that of a freshly dipped brush, filled from narrow() in narrow.hpp; empty: 1.
    std::vector<double> width_share;
    Rings outline_mm;  ///< filled from outline() in coverage.hpp
};

/// The footprint of a brush that leans by s, seen from its contact: a section of the brush by a plane at an angle t to
/// the one across it is 1 / cos t as long the way that it leans, S = I + s s^T / (1 + sqrt(1 + |s|^2)), |s| = tan t.
inline Eigen::Matrix2d stretch_of(const Eigen::RowVector2d& lean) {
    return Eigen::Matrix2d::Identity() + lean.transpose() * lean / (1.0 + std::sqrt(1.0 + lean.squaredNorm()));
}

struct Marks {
    std::vector<PassMarks> passes;
    Rings outline_mm;  ///< union over all passes
};

}  // namespace brushsvg
