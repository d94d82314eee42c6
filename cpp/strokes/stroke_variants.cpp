#include "strokes/stroke_variants.hpp"

#include <algorithm>
#include <cmath>

#include "inverse/middle_line.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr double kLengthToleranceMm = 0.1;       // of flattened lines, for their length
constexpr double kMinRemainingHalfWidths = 0.8;  // least length of a stroke that is cut short, in half widths

/// Return a cubic between two parameters (de Casteljau).
Eigen::Matrix<double, 1, 8> sub_cubic(Eigen::Matrix<double, 1, 8> cubic, double t0, double t1) {
    const auto point = [&](Index k) { return cubic.segment<2>(2 * k); };
    for (Index last = 3; last > 0; --last)  // cut off the part after t1
        for (Index k = 3; k > 3 - last; --k)
            cubic.segment<2>(2 * k) = (point(k - 1) + t1 * (point(k) - point(k - 1))).eval();
    const double t = t1 > 0.0 ? t0 / t1 : 0.0;
    for (Index last = 3; last > 0; --last)  // cut off the part before t0
        for (Index k = 0; k < last; ++k) cubic.segment<2>(2 * k) = (point(k) + t * (point(k + 1) - point(k))).eval();
    return cubic;
}

Stroke reversed(Stroke stroke) {
    const Cubics back = stroke.middle_mm.colwise().reverse();
    for (Index i = 0; i < 4; ++i) stroke.middle_mm.middleCols(2 * i, 2) = back.middleCols(6 - 2 * i, 2);
    std::reverse(stroke.half_width.begin(), stroke.half_width.end());
    for (WidthKnot& knot : stroke.half_width) knot.at = 1.0 - knot.at;
    std::swap(stroke.start_covered, stroke.end_covered);
    return stroke;
}

}  // namespace

Stroke part_between(const Stroke& stroke, double from_mm, double to_mm) {
    Stroke part = stroke;
    const Index count = stroke.middle_mm.rows();
    std::vector<Eigen::Matrix<double, 1, 8>> cubics;
    double at = 0.0, length = 0.0;
    for (Index k = 0; k < count; ++k) {
        const double own = arc_length(stroke.middle_mm, k, 0.0, 1.0);
        const double first = std::clamp(from_mm - at, 0.0, own), last = std::clamp(to_mm - at, 0.0, own);
        if (last > first) {
            const double t0 = first > 0.0 ? parameter_at(stroke.middle_mm, k, first) : 0.0;
            const double t1 = last < own ? parameter_at(stroke.middle_mm, k, last) : 1.0;
            cubics.push_back(sub_cubic(stroke.middle_mm.row(k), t0, t1));
        }
        at += own;
    }
    length = at;
    if (cubics.empty()) return part;
    part.middle_mm.resize(Index(cubics.size()), 8);
    for (Index k = 0; k < part.middle_mm.rows(); ++k) part.middle_mm.row(k) = cubics[std::size_t(k)];
    const double from = from_mm / length, to = to_mm / length;
    part.half_width = {{0.0, half_width_at(stroke, from)}};
    for (const WidthKnot& knot : stroke.half_width)
        if (knot.at > from && knot.at < to)
            part.half_width.push_back({(knot.at - from) / (to - from), knot.half_width_mm});
    part.half_width.push_back({1.0, half_width_at(stroke, to)});
    return part;
}

std::optional<Stroke> apply_variant(const Stroke& given, const Variant& variant, const std::array<double, 2>& half_mm) {
    Stroke stroke = given;
    if (!variant.is_square) stroke.target_mm.clear();
    if (variant.is_pointed) stroke.settings.start = "pointed";
    if (variant.cut[0] > 0.0 || variant.cut[1] > 0.0) {
        const MiddlePolyline line = flatten(given, kLengthToleranceMm);
        const double half = line.col(3).maxCoeff(), length = line(line.rows() - 1, 2);
        const double first = variant.cut[0] * half, last = length - variant.cut[1] * half;
        if (last - first < kMinRemainingHalfWidths * half) return std::nullopt;
        stroke = part_between(stroke, first, last);
    }
    for (WidthKnot& knot : stroke.half_width)
        knot.half_width_mm = std::clamp(variant.width * knot.half_width_mm, half_mm[0], half_mm[1]);
    return variant.is_reversed ? reversed(stroke) : stroke;
}

}  // namespace brushsvg
