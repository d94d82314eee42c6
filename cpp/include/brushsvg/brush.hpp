#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "brushsvg/brush_law.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/footprint.hpp"
#include "brushsvg/paint.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Kinds of brushes that the model covers. Their footprints are the same in every direction. A liner is a round brush
/// with long bristles.
inline constexpr std::array<const char*, 3> kBrushKinds{"round", "liner", "pen"};

/// A brush, measured or assumed: four laws against depth, and its footprints. All lengths are in mm.
struct Brush {
    std::string name;
    std::string kind;                                ///< one of kBrushKinds; empty: round
    std::array<double, 2> depth_range_mm{0.0, 0.0};  ///< least and greatest depth to which the brush may be pressed
    // Laws. law(d) evaluates the polynomial at any depth; law.at(d) throws Error for depths that the brush cannot have.
    Profile lag;            ///< r(d): lever from the centre of friction to the TCP while taut
    Profile tip_gap;        ///< b(d): from the patch's tip to the centre of friction
    Profile tip_to_widest;  ///< x_w(d): from the tip to the widest section
    Profile half_width;     ///< h(d): half of the greatest width
    FootprintTable footprints;
    std::vector<std::vector<double>> covariance;  ///< of all coefficients, in the order of the laws; may be empty
    std::optional<Paint> paint;                   ///< how the mark narrows between dips; none: it does not
    double max_speed_mm_s = 25.0;                 ///< greatest speed at which the model holds; it has no inertia
    double paint_depth_mm = 0.0;                  ///< painting depth if half_width does not depend on depth
    std::string sha256;                           ///< of the file that the brush was read from, or empty
    std::string extra = "{}";                     ///< JSON object of unknown keys, written back as read

    bool is_rigid() const;             ///< r is 0 at all depths: a pen, p = q, never loose
    bool width_follows_depth() const;  ///< false if half_width is constant over the depth range

    /// Return the depth [mm], never 0, that paints a half width [mm] to 0.05 mm.
    ///
    /// `where`: the element that the error names. Throws Error (width-out-of-reach), with the reachable range, if the
    /// brush cannot paint that width. If the width does not depend on depth, returns `paint_depth_mm`.
    double depth_for_half_width(double half_width_mm, const std::string& where) const;
    /// Return the least and the greatest half width [mm] within the depth range.
    std::array<double, 2> half_width_range_mm() const;

    double lever_to_widest(double depth_mm) const {  ///< e(d) = x_w(d) - b(d) [mm], signed
        return tip_to_widest(depth_mm) - tip_gap(depth_mm);
    }
};

/// Throw Error if the kind of a brush is not in kBrushKinds. An empty kind is round.
void require_known_kind(const Brush& brush);

/// Throw Error, naming the law and the depth, if a brush is not valid.
///
/// The lag must be positive over the depth range, or 0 everywhere. The half width must not fall with depth. Footprints
/// must be simple counter-clockwise rings that begin at the tip and have equal vertex counts. Outlines and laws may
/// differ by at most 0.5 mm.
void check(const Brush& brush);

/// Return warnings about a brush that check() accepts but that is unusual.
std::vector<Warning> remarks(const Brush& brush);

}  // namespace brushsvg
