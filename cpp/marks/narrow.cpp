#include "brushsvg/narrow.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/format_text.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "values/require_usable.hpp"

namespace brushsvg {
namespace {

constexpr double kPi = 3.14159265358979323846;
// Share of the width between two rows: linear interpolation is then off by 0.03 % of the width.
constexpr double kMaxWidthStep = 0.05;

/// Rows of marks, collected one by one.
struct RowCollector {
    const PassMarks& from;
    PassMarks to;
    std::vector<Eigen::RowVector2d> tcp, contact, lean;

    /// Add the row at a share of the way from row i - 1 to row i. Values between rows are interpolated linearly, like
    /// the outline.
    void add(std::size_t i, double t, double share) {
        const std::size_t b = t < 1.0 ? i - 1 : i;
        const auto between = [&](const std::vector<double>& values) {
            return t < 1.0 ? (1.0 - t) * values[b] + t * values[i] : values[i];
        };
        const auto row = [&](const Ring& points) -> Eigen::RowVector2d {
            const double share = t < 1.0 ? t : 1.0;
            return (1.0 - share) * points.row(Eigen::Index(b)) + share * points.row(Eigen::Index(i));
        };
        to.pose.push_back(between(from.pose));
        tcp.push_back(row(from.tcp_mm));
        contact.push_back(row(from.contact_mm));
        if (from.lean_mm_per_mm.rows() > 0) lean.push_back(row(from.lean_mm_per_mm));
        const double turn = std::remainder(from.heading_rad[i] - from.heading_rad[b], 2.0 * kPi);
        to.heading_rad.push_back(t < 1.0 ? from.heading_rad[b] + t * turn : from.heading_rad[i]);
        to.depth_mm.push_back(between(from.depth_mm));
        to.taut.push_back(from.taut[i] != 0 && from.taut[b] != 0);
        to.pull.push_back(between(from.pull));
        to.width_share.push_back(share);
    }

    PassMarks finish() {
        to.stroke = from.stroke;
        to.outline_mm = from.outline_mm;
        for (auto [points, rows] :
             {std::pair{&to.tcp_mm, &tcp}, std::pair{&to.contact_mm, &contact}, std::pair{&to.lean_mm_per_mm, &lean}}) {
            points->resize(Eigen::Index(rows->size()), 2);
            for (std::size_t i = 0; i < rows->size(); ++i) points->row(Eigen::Index(i)) = (*rows)[i];
        }
        return std::move(to);
    }
};

/// Narrow a pass and return the way since the last dip at its end [mm]. `before_mm`: the way since the last dip at its
/// beginning.
double narrow_pass(PassMarks& marks, const Paint& paint, const std::vector<double>& dips_mm, double before_mm) {
    require_usable(marks);
    if (std::size_t(marks.tcp_mm.rows()) != marks.pose.size())
        throw Error("sizes-differ",
                    "the marks have no TCP positions, because they come from a file: use marks of simulate()",
                    marks.stroke);
    for (std::size_t k = 0; k < dips_mm.size(); ++k)
        if (!(dips_mm[k] >= 0.0) || (k > 0 && !(dips_mm[k] > dips_mm[k - 1])))
            throw Error("not-ascending",
                        format_text("a dip is at %.6g mm, but the path lengths of dips must ascend from 0", dips_mm[k]),
                        marks.stroke, dips_mm[k]);
    RowCollector rows{marks, {}, {}, {}, {}};
    std::size_t dip = 0;
    double way = 0.0, dipped_at = -before_mm;
    for (std::size_t i = 0; i < marks.pose.size(); ++i) {
        const bool painted = i > 0 && marks.depth_mm[i - 1] >= 0.0 && marks.depth_mm[i] >= 0.0;
        const Eigen::Index r = Eigen::Index(i);
        const double step = painted ? (marks.tcp_mm.row(r) - marks.tcp_mm.row(r - 1)).norm() : 0.0;
        const int parts = std::max(1, int(std::ceil(1e-3 * paint.narrows_per_m * step / kMaxWidthStep)));
        for (int k = 1; k <= parts; ++k) {
            checkpoint();
            const double to = way + step * k / parts;
            // narrow up to the dip, wide from there on
            for (; dip < dips_mm.size() && dips_mm[dip] <= to; ++dip) {
                const double at = std::max(dips_mm[dip], way), t = step > 0.0 ? (at - way) / step : 1.0;
                if (i > 0 && t > 0.0 && t < 1.0) {
                    rows.add(i, t, paint.width_share(at - dipped_at));
                    rows.add(i, t, 1.0);
                }
                dipped_at = dips_mm[dip];
            }
            rows.add(i, double(k) / parts, paint.width_share(to - dipped_at));
        }
        way += step;
    }
    marks = rows.finish();
    return way - dipped_at;
}

}  // namespace

void narrow(Marks& marks, const Paint& paint, const std::vector<std::vector<double>>& dips_mm) {
    check(paint);
    if (dips_mm.size() != marks.passes.size())
        throw Error("sizes-differ", "there are " + std::to_string(dips_mm.size()) + " lists of dips for " +
                                        std::to_string(marks.passes.size()) +
                                        " passes: give one list, maybe empty, for each pass");
    double way_mm = 0.0;
    for (std::size_t i = 0; i < marks.passes.size(); ++i)
        way_mm = narrow_pass(marks.passes[i], paint, dips_mm[i], way_mm);
}

}  // namespace brushsvg
