#include "values/require_usable.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format_text.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

constexpr double kMaxDepthMm = 1000.0, kMaxLawValueMm = 1000.0;  // same limits as in check(brush)
constexpr int kLawSamples = 16;                                  // evaluations of a law over the depth range

void require_law(const Profile& law, double lo, double hi, bool is_length, const char* where) {
    require_law_degree(law.coefficients, where);
    for (double c : law.coefficients)
        if (!std::isfinite(c)) throw Error("not-finite", "the law has a coefficient that is not finite", where, c);
    if (std::isnan(law.floor) || law.floor > kMaxLawValueMm || !std::isfinite(law.floor_slope))
        throw Error("not-finite", "the floor of the law is not finite", where, law.floor);
    for (int i = 0; i <= kLawSamples; ++i) {
        const double d = lo + (hi - lo) * i / kLawSamples, value = law(d);
        if (!(std::abs(value) <= kMaxLawValueMm) || (is_length && value < -1e-9))
            throw Error("out-of-range",
                        format_text("the law gives %.4g mm at depth %.2f mm, outside the range [%.0f, %.0f] mm", value,
                                    d, is_length ? 0.0 : -kMaxLawValueMm, kMaxLawValueMm),
                        where, value, std::array<double, 2>{is_length ? 0.0 : -kMaxLawValueMm, kMaxLawValueMm});
    }
}

void require_outlines(const std::vector<Footprint>& shapes, Eigen::Index vertices, const char* where) {
    double depth = 0.0;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const Ring& outline = shapes[i].outline_mm;
        const auto here = [&] { return where + ("[" + std::to_string(i) + "]"); };
        if (!(shapes[i].depth_mm > depth && shapes[i].depth_mm <= kMaxLawValueMm))
            throw Error(
                "not-ascending",
                format_text("depth %.3f mm is outside the range (%.3f, 1000] mm: sort the outlines by ascending depth",
                            shapes[i].depth_mm, depth),
                here(), shapes[i].depth_mm);
        depth = shapes[i].depth_mm;
        if (outline.rows() < 3 || outline.rows() != vertices)
            throw Error(
                "footprint-invalid",
                format_text("the outline has %.0f vertices, but the first outline has %.0f: give all outlines the same "
                            "number, at least 3",
                            double(outline.rows()), double(vertices)),
                here());
        const double largest = outline.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
        if (!(largest <= kMaxLawValueMm))
            throw Error(
                "out-of-range",
                format_text("the outline has a coordinate of %.4g mm, but at most %.0f mm are allowed: check its unit",
                            largest, kMaxLawValueMm),
                here(), largest, std::array<double, 2>{0.0, kMaxLawValueMm});
    }
}

}  // namespace

void require_usable(const Brush& brush) {
    require_known_kind(brush);
    const auto [lo, hi] = brush.depth_range_mm;
    if (!(lo >= 0.0 && hi > lo && hi <= kMaxDepthMm))
        throw Error(
            "out-of-range",
            format_text("the depth range is [%.4g, %.4g] mm, but must be two ascending depths within [0, %.0f] mm", lo,
                        hi, kMaxDepthMm),
            "depth_range_mm");
    require_law(brush.lag, 0.0, hi, true, "lag");
    require_law(brush.tip_gap, lo, hi, false, "tip_gap");
    require_law(brush.tip_to_widest, lo, hi, false, "tip_to_widest");
    require_law(brush.half_width, lo, hi, true, "half_width");
    if (!(brush.paint_depth_mm >= 0.0 && brush.paint_depth_mm <= kMaxDepthMm))
        throw Error("out-of-range",
                    format_text("the painting depth is %.4g mm, outside the range [0, %.0f] mm", brush.paint_depth_mm,
                                kMaxDepthMm),
                    "paint_depth_mm", brush.paint_depth_mm, std::array<double, 2>{0.0, kMaxDepthMm});
    if (brush.footprints.dragged.empty())
        throw Error("footprint-invalid", "there is no outline, but at least one is needed", "footprints.dragged");
    const Eigen::Index vertices = brush.footprints.vertex_count();
    require_outlines(brush.footprints.dragged, vertices, "footprints.dragged");
    require_outlines(brush.footprints.pressed, vertices, "footprints.pressed");
}

void require_usable(const PassMarks& marks) {
    const std::size_t rows = marks.pose.size();
    const auto parallel = [rows](auto count) { return std::size_t(count) == rows; };
    if (!parallel(marks.contact_mm.rows()) || !parallel(marks.heading_rad.size()) || !parallel(marks.depth_mm.size()) ||
        !parallel(marks.taut.size()) || !parallel(marks.pull.size()) ||
        (marks.lean_mm_per_mm.rows() > 0 && !parallel(marks.lean_mm_per_mm.rows())) ||
        !(marks.width_share.empty() || parallel(marks.width_share.size())))
        throw Error("sizes-differ", "the columns of the marks differ in length, but each needs one entry per row",
                    marks.stroke);
    for (const double share : marks.width_share)
        if (!(share >= 0.0 && share <= 1.0))
            throw Error("out-of-range", format_text("width_share contains %.4g, outside the range [0, 1]", share),
                        marks.stroke, share, std::array<double, 2>{0.0, 1.0});
    const auto is_in_range = [](double x) { return std::abs(x) <= kMaxPaintedCoordinateMm; };
    if ((rows > 0 && !(marks.contact_mm.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kMaxPaintedCoordinateMm)) ||
        (marks.lean_mm_per_mm.rows() > 0 && !marks.lean_mm_per_mm.allFinite()) ||
        !std::all_of(marks.heading_rad.begin(), marks.heading_rad.end(), is_in_range) ||
        !std::all_of(marks.depth_mm.begin(), marks.depth_mm.end(), is_in_range) ||
        !std::all_of(marks.pull.begin(), marks.pull.end(), is_in_range))
        throw Error("geometry-out-of-range", "the marks contain a number that is not finite or beyond 1e7",
                    marks.stroke);
}

}  // namespace brushsvg
