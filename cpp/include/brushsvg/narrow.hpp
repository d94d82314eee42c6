#pragma once

#include <vector>

#include "brushsvg/marks.hpp"
#include "brushsvg/paint.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Fill in `width_share` of marks made by simulate(), as the paint runs out.
///
/// The passes are in the order in which they are painted. The width depends on the path of the TCP on the paper since
/// the last dip.
///
/// `dips_mm`: for each pass, the places along its path [mm] at which the brush has just fetched paint, ascending. 0 is
/// before the pass; a pass without dips continues with the paint of the pass before. The first pass always begins
/// freshly dipped.
///
/// Long rows are divided, so that the width is linear in between. A dip inside a pass gets two rows.
///
/// Throws Error if there are not as many lists of dips as passes, if a list does not ascend, or for marks without a
/// TCP.
void narrow(Marks& marks, const Paint& paint, const std::vector<std::vector<double>>& dips_mm);

}  // namespace brushsvg
