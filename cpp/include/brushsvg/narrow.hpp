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
/// `dips_mm`: for each pass, the ascending path lengths [mm] at which the brush was dipped into paint. 0 is before the
/// pass. A pass without dips continues with the paint of the previous pass. The first pass always begins freshly
/// dipped.
///
/// Long distances between rows are divided, because the width is linear between rows. A dip inside a pass gets two
/// rows, before and after it.
///
/// Throws Error if there are not as many lists of dips as passes, if a list does not ascend, or for marks without a
/// TCP.
void narrow(Marks& marks, const Paint& paint, const std::vector<std::vector<double>>& dips_mm);

}  // namespace brushsvg
