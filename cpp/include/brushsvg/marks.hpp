#pragma once

#include <string>
#include <vector>

#include "brushsvg/ring.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// What the patch does during one pass. Rows are parallel. depth_mm < 0 marks rows where the brush is lifted.
struct PassMarks {
    std::string stroke;
    std::vector<double> pose;  ///< index into the pass's poses, fractional between poses
    Ring tcp_mm;               ///< q
    Ring contact_mm;           ///< p, centre of friction
    std::vector<double> heading_rad;
    std::vector<double> depth_mm;
    std::vector<unsigned char> taut;
    std::vector<double> pull;  ///< r'/r, 1 when taut
    /// How wide the footprint is by that of a freshly dipped brush, filled from narrow() in narrow.hpp; empty: 1.
    std::vector<double> width_share;
    Rings outline_mm;  ///< filled from outline() in coverage.hpp
};

struct Marks {
    std::vector<PassMarks> passes;
    Rings outline_mm;  ///< union over all passes
};

}  // namespace brushsvg
