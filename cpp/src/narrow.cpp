#include "brushsvg/narrow.hpp"

#include <algorithm>
#include <string>

#include "brushsvg/error.hpp"
#include "refuse_unusable.hpp"

namespace brushsvg {
namespace {

/// The way since the last dip at the pass's end [mm]; `before_mm` at its beginning.
double narrow_pass(PassMarks& marks, const Paint& paint, const std::vector<double>& dips_mm, double before_mm) {
    require_usable(marks);
    if (std::size_t(marks.tcp_mm.rows()) != marks.pose.size())
        throw Error("sizes-differ", "the marks do not say where the TCP was, as those of a file", marks.stroke);
    for (std::size_t k = 0; k < dips_mm.size(); ++k)
        if (!(dips_mm[k] >= 0.0) || (k > 0 && !(dips_mm[k] > dips_mm[k - 1])))
            throw Error("not-ascending", "ways at which paint was fetched must ascend from 0", marks.stroke,
                        dips_mm[k]);
    std::size_t dip = 0;
    double way = 0.0, dipped_at = -before_mm;
    marks.width_share.clear();
    for (std::size_t i = 0; i < marks.pose.size(); ++i) {
        if (i > 0 && marks.depth_mm[i - 1] >= 0.0 && marks.depth_mm[i] >= 0.0)
            way += (marks.tcp_mm.row(Eigen::Index(i)) - marks.tcp_mm.row(Eigen::Index(i) - 1)).norm();
        while (dip < dips_mm.size() && dips_mm[dip] <= way) dipped_at = dips_mm[dip++];
        marks.width_share.push_back(paint.width_share(way - dipped_at));
    }
    return way - dipped_at;
}

}  // namespace

void narrow(Marks& marks, const Paint& paint, const std::vector<std::vector<double>>& dips_mm) {
    check(paint);
    if (dips_mm.size() != marks.passes.size())
        throw Error("sizes-differ", "there are dips for " + std::to_string(dips_mm.size()) + " passes, but " +
                                        std::to_string(marks.passes.size()) + " passes");
    double way_mm = 0.0;
    for (std::size_t i = 0; i < marks.passes.size(); ++i)
        way_mm = narrow_pass(marks.passes[i], paint, dips_mm[i], way_mm);
}

}  // namespace brushsvg
