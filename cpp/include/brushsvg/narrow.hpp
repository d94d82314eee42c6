#pragma once

#include <vector>

#include "brushsvg/marks.hpp"
#include "brushsvg/paint.hpp"

namespace [[gnu::visibility("default")]] brushsvg {

/// Fills width_share of marks that simulate() made, in the order in which they are painted, by the way of the TCP on
/// the paper since the last dip. dips_mm: for each pass the ways along it at which the brush has just fetched paint,
/// ascending; 0 is before it, none goes on with the paint of the pass before. The first begins freshly dipped anyway.
/// Long rows are divided, so that the width is straight in between; at a dip inside of a pass there are two rows.
/// Throws Error where there are not as many as passes, where one does not ascend, and for marks without a TCP.
void narrow(Marks& marks, const Paint& paint, const std::vector<std::vector<double>>& dips_mm);

}  // namespace brushsvg
