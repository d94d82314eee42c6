#include "stroke_ends.hpp"

#include <algorithm>

#include "brushsvg/footprint.hpp"
#include "middle_line.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// What a front may stay short of the drawn end, as a share of its half width: less is not seen and costs a pose.
constexpr double kShortOfEnd = 0.05;

constexpr double kStraightBack = 0.5;  // cosine

}  // namespace

double beyond_the_end(const Brush& brush, double depth, double half_width_mm) {
    const auto front_of_contact = [&](double d) {
        return footprint_at(brush.footprints, d, 1.0).col(0).maxCoeff() - brush.tip_gap(d);
    };
    const double end_mm = brush.lever_to_widest(depth) + half_width_mm;
    double farthest = front_of_contact(depth);
    if (farthest >= end_mm) return farthest - end_mm;
    for (const Footprint& measured : brush.footprints.dragged)
        if (measured.depth_mm < depth) farthest = std::max(farthest, front_of_contact(measured.depth_mm));
    return std::min(farthest - end_mm, 0.0);
}

std::array<double, 2> painted_stretch(const Stroke& stroke, const Brush& brush, double length) {
    if (stroke.closed) return {0.0, length};
    const double h0 = half_width_at(stroke, 0.0), h1 = half_width_at(stroke, 1.0);
    constexpr int n = 400;
    double s0 = 0.0, s1 = length;
    for (int i = 0; i <= n; ++i) {
        s0 = length * i / n;
        if (s0 - brush.tip_to_widest(depth_of(stroke, brush, s0 / std::max(length, 1e-300))) + h0 >= 0.0) break;
    }
    if (s0 > 0.0) {  // the crossing lies in the last step
        double a = std::max(0.0, s0 - length / n), b = s0;
        for (int i = 0; i < 60; ++i) {
            const double s = 0.5 * (a + b);
            (s - brush.tip_to_widest(depth_of(stroke, brush, s / length)) + h0 >= 0.0 ? b : a) = s;
        }
        s0 = b;
    }
    s1 = length - std::max(0.0, beyond_the_end(brush, depth_of(stroke, brush, 1.0), h1));
    return {s0, s1};
}

Stroke up_to_its_end(const Stroke& stroke, const Brush& brush) {
    if (stroke.closed || brush.is_rigid()) return stroke;
    Stroke painted = stroke;  // what is wider than the brush is painted as wide as that
    const auto [least, greatest] = brush.half_width_range_mm();
    for (WidthKnot& knot : painted.half_width) knot.half_width_mm = std::clamp(knot.half_width_mm, least, greatest);
    const Line line(painted, brush);
    const double length_mm = line.length(), half_mm = half_width_at(painted, 1.0);
    const double beyond_mm = -beyond_the_end(brush, depth_of(painted, brush, 1.0), half_mm);
    if (!(length_mm > 0.0) || !(beyond_mm > kShortOfEnd * half_mm)) return stroke;
    const auto [s0, s1] = painted_stretch(painted, brush, length_mm);
    if (!(s1 - s0 > 1e-6)) return stroke;  // a dab
    Stroke out = stroke;
    const Index last = stroke.middle_mm.rows();
    const Sample end = line.at(length_mm);
    out.middle_mm.conservativeResize(last + 1, Eigen::NoChange);
    for (int i = 0; i < 4; ++i)
        out.middle_mm.row(last).segment<2>(2 * i) = end.middle + i / 3.0 * beyond_mm * line.tangent(end);
    for (WidthKnot& knot : out.half_width) knot.at *= length_mm / (length_mm + beyond_mm);
    return out;
}

bool rear_lies_inside(const Stroke& stroke, const Brush& brush, const Line& line, double widest_mm) {
    constexpr int n = 6;
    const Sample widest = line.at(widest_mm);
    const Vector2d along = line.tangent(widest);
    const double rear = brush.tip_to_widest(widest.depth);
    if (along.dot(line.tangent(line.at(0.0))) < kStraightBack) return false;
    for (int i = 1; i <= n; ++i) {
        const double t = double(i) / n, s = widest_mm + t * rear;
        const double half = half_width_at(stroke, std::min(1.0, s / line.length()));
        const Vector2d on_line = s <= line.length() ? line.at(s).middle : line.at(line.length()).middle;
        if ((widest.middle + t * rear * along - on_line).norm() > half - (1.0 - t) * brush.half_width(widest.depth))
            return false;
    }
    return true;
}

}  // namespace brushsvg
