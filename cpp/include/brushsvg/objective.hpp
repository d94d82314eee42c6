#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace [[gnu::visibility("default")]] brushsvg {

/// What the mark of a shape costs [mm^2], less is better: area without paint, paint outside, both again where they are
/// deep enough to be seen, how much the mark's outline turns beyond the shape's, and how many strokes it needs. Larger
/// numbers ask more of a mark: `missing` and `spill` are the measure of all others.
struct ObjectiveWeights {
    double missing = 1.0;  ///< per mm^2 of the shape without paint
    double spill = 1.0;    ///< per mm^2 of paint outside
    /// How deep [mm] an area without paint, or paint outside, is seen. Less: every edge counts, since a mark is on
    /// its shape's edge to about 0.1 mm. More: thorns of half a millimetre are free.
    double seen_mm = 0.15;
    double notch = 3.0;   ///< more per mm^2 without paint deeper than that. More: strokes into each corner
    double bulge = 12.0;  ///< more per mm^2 of paint further out. Less: strokes that stick out of corners they fill
    /// Per full turn of the mark's outline beyond what it was, in squares of the brush's greatest half width. Less:
    /// blobs and waves next to a stem. More: corners stay bare.
    double turn = 1.0;
    /// Per stroke, in squares of the greatest half width; a round mark leaves 0.21 in a right-angled corner. Less: two
    /// strokes more for each blunt end. More: only whole limbs get one.
    double stroke = 0.1;
};

/// How small an area of a shape gets a stroke of its own.
enum class Detail { draft, normal, fine };
inline constexpr std::array<std::pair<std::string_view, Detail>, 3> kDetails{
    {{"draft", Detail::draft}, {"normal", Detail::normal}, {"fine", Detail::fine}}};
/// Error for another word.
Detail detail_named(const std::string& name);

ObjectiveWeights weights_for(Detail detail);

}  // namespace brushsvg
