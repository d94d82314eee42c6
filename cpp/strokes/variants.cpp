#include "strokes/variants.hpp"

#include <algorithm>
#include <cmath>

#include "inverse/middle_line.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

// Tolerances of flattened lines, for their length and for their bends.
constexpr double kLengthToleranceMm = 0.1, kBendToleranceMm = 0.01;
// A brush can go round a bend that turns less.
constexpr double kMinBendRad = 30.0 / 180.0 * 3.14159265358979323846;
constexpr std::size_t kMaxBends = 8;             // bends at which one stroke may be cut at most: limits the work
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

std::vector<Gap> find_gaps(const Stroke& stroke) {
    std::vector<Gap> gaps;
    if (stroke.closed) return gaps;
    const MiddlePolyline line = flatten(stroke, kBendToleranceMm);
    const double length = line(line.rows() - 1, 2);
    const auto place = [&](double at) -> Vector2d {
        Index i = 0;
        while (i + 2 < line.rows() && line(i + 1, 2) < at) ++i;
        const double step = line(i + 1, 2) - line(i, 2);
        const double t = step > 0.0 ? std::clamp((at - line(i, 2)) / step, 0.0, 1.0) : 0.0;
        return (line.block<1, 2>(i, 0) + t * (line.block<1, 2>(i + 1, 0) - line.block<1, 2>(i, 0))).transpose();
    };
    std::vector<std::pair<double, double>> bends;  // the turn, and where it is
    for (Index i = 1; i + 1 < line.rows(); ++i) {
        const double at = line(i, 2), reach = std::max(line(i, 3), kLengthToleranceMm);
        if (at < reach || at > length - reach) continue;
        const Vector2d here = place(at);
        const double turn = std::abs(angle_between(here - place(at - reach), place(at + reach) - here));
        if (turn < kMinBendRad) continue;
        if (!bends.empty() && at - bends.back().second < reach) {
            if (turn > bends.back().first) bends.back() = {turn, at};
        } else if (bends.size() < kMaxBends) {
            bends.push_back({turn, at});
        }
    }
    for (std::size_t k = 0; k < bends.size(); ++k) {
        if (k > 0) gaps.push_back({bends[k - 1].second, bends[k].second});
        gaps.push_back({bends[k].second, bends[k].second});
    }
    return gaps;
}

std::vector<Stroke> cut_at_gaps(const Stroke& stroke, const std::vector<Gap>& gaps) {
    const MiddlePolyline line = flatten(stroke, kBendToleranceMm);
    std::vector<Stroke> parts;
    double from = 0.0;
    for (std::size_t k = 0; k <= gaps.size(); ++k) {
        const bool is_last = k == gaps.size();
        parts.push_back(part_between(stroke, from, is_last ? line(line.rows() - 1, 2) : gaps[k][0]));
        if (k > 0) parts.back().settings.start = "pointed";
        if (!is_last) {
            parts.back().settings.end = "round";
            from = gaps[k][1];
        }
    }
    return parts;
}

}  // namespace brushsvg
