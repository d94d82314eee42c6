#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace [[gnu::visibility("default")]] brushsvg {

/// The weights of the cost of a shape's mark [mm^2]; less is better.
///
/// The cost counts the area without paint and the paint outside, both again where they are deep enough to be seen. It
/// also counts how much the mark's outline turns beyond the shape's, and how many strokes it needs. `missing`
/// and `spill` are the reference for all other weights.
struct ObjectiveWeights {
    double missing = 1.0;  ///< per mm^2 of the shape without paint
    double spill = 1.0;    ///< per mm^2 of paint outside the shape
    /// Depth [mm] from which an area without paint, or paint outside, is seen. If smaller, every edge counts, because a
    /// mark follows its shape's edge to about 0.1 mm. If larger, thorns of half a millimetre cost nothing.
    double seen_mm = 0.15;
    double notch = 3.0;   ///< added per mm^2 without paint beyond that depth. If larger, each corner gets a stroke
    double bulge = 12.0;  ///< added per mm^2 of paint beyond that depth. If smaller, strokes stick out of the corners
                          ///< that they fill
    /// Per full turn that the mark's outline gains, in squares of the brush's greatest half width. If smaller, there
    /// are blobs and waves next to a stem. If larger, corners stay bare.
    double turn = 1.0;
    /// Per stroke, in squares of the brush's greatest half width. A round mark leaves 0.21 bare in a right-angled
    /// corner. If smaller, each blunt end gets two more strokes. If larger, only whole limbs get a stroke.
    double stroke = 0.1;
};

/// Throw Error for a weight outside [0, 1e6], or a depth outside [0, 1000] mm.
void check(const ObjectiveWeights& weights);

/// Level of detail: how small an area of a shape may be to get a stroke of its own.
enum class Detail { draft, normal, fine };
inline constexpr std::array<std::pair<std::string_view, Detail>, 3> kDetailNames{
    {{"draft", Detail::draft}, {"normal", Detail::normal}, {"fine", Detail::fine}}};
/// Return the level of detail that a word names. Throws Error for an unknown word.
Detail parse_detail(const std::string& name);

/// Return the weights for a level of detail.
ObjectiveWeights weights_for(Detail detail);

}  // namespace brushsvg
