#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "brushsvg/error.hpp"
#include "brushsvg/footprint.hpp"
#include "brushsvg/paint.hpp"
#include "brushsvg/profile.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Kinds of brush that the model covers: footprints are the same in every direction. liner: round, with long bristles.
inline constexpr std::array<const char*, 3> kBrushKinds{"round", "liner", "pen"};

/// A measured (or assumed) brush: four laws against depth and its footprints. All lengths in mm.
struct Brush {
    std::string name;
    std::string kind;  ///< one of kBrushKinds, or empty: round
    std::array<double, 2> depth_range_mm{0.0, 0.0};
    // Laws: law(d) follows the polynomial to any depth, law.at(d) refuses depths that the brush cannot have.
    Profile lag;            ///< r(d): lever from the centre of friction to the TCP, taut
    Profile tip_gap;        ///< b(d): from the patch's tip to the centre of friction
    Profile tip_to_widest;  ///< x_w(d): from the tip to the widest section
    Profile half_width;     ///< h(d): half of the greatest width
    FootprintTable footprints;
    std::vector<std::vector<double>> covariance;  ///< over all coefficients in the order of the laws, or empty
    std::optional<Paint> paint;                   ///< how its mark narrows from dip to dip; none: it does not
    double max_speed_mm_s = 25.0;
    double paint_depth_mm = 0.0;  ///< depth used where half_width does not depend on depth
    std::string sha256;           ///< of the file it was read from, or empty
    std::string extra = "{}";     ///< JSON object of unknown keys, written back as read

    bool is_rigid() const;             ///< r identically 0: a pen; p = q, no loose rule
    bool width_follows_depth() const;  ///< false where half_width is constant over the depth range

    /// Depth [mm], never 0, that paints a half width [mm] to 0.05 mm. Error with the reachable range if there is none.
    double depth_for_half_width(double half_width_mm, const std::string& where) const;
    /// Half widths [mm] reachable over the depth range.
    std::array<double, 2> half_width_range_mm() const;

    double lever_to_widest(double depth_mm) const {  ///< e(d) = x_w(d) - b(d), signed
        return tip_to_widest(depth_mm) - tip_gap(depth_mm);
    }
};

/// Throws Error where the kind of a brush is none of kBrushKinds; without one it is round.
void require_known_kind(const Brush& brush);

/// Refuses a brush that would lead a robot astray: negative lag, or lag zero in part of the range; falling
/// half width; footprints that are not simple counter-clockwise rings with the tip first and equal counts;
/// outlines that disagree with the laws by more than 0.5 mm. Throws Error naming the law and the depth.
void check(const Brush& brush);

/// What is odd about an admissible brush, in words.
std::vector<Warning> remarks(const Brush& brush);

}  // namespace brushsvg
