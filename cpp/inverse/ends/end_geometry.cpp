#include "inverse/ends/end_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brushsvg/footprint.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Split a cubic into two parts (de Casteljau).
std::array<Eigen::Matrix<double, 1, 8>, 2> split(const Cubics& middle_mm, Index cubic, double t) {
    Vector2d p[4];
    for (int i = 0; i < 4; ++i) p[i] = middle_mm.row(cubic).segment<2>(2 * i);
    std::array<Eigen::Matrix<double, 1, 8>, 2> out;
    for (int i = 0; i < 4; ++i) {
        out[0].segment<2>(2 * i) = p[0];
        out[1].segment<2>(6 - 2 * i) = p[3 - i];
        for (int k = 0; k + 1 < 4 - i; ++k) p[k] += t * (p[k + 1] - p[k]);
    }
    return out;
}

/// Return the path between two places on it, the first before the second.
Cubics sub_path(const Cubics& middle_mm, const Place& from, const Place& to) {
    // the start of a cubic is the end of the one before it
    if (to.t == 0.0 && from.cubic < to.cubic) return sub_path(middle_mm, from, {to.cubic - 1, 1.0});
    Cubics out = middle_mm.middleRows(from.cubic, to.cubic - from.cubic + 1);
    const Index last = out.rows() - 1;
    out.row(last) = split(out, last, to.t)[0];
    const double t = from.cubic < to.cubic ? from.t : to.t > 0.0 ? from.t / to.t : 0.0;
    out.row(0) = split(out, 0, t)[1];
    return out;
}

Cubics reversed(const Cubics& middle_mm) {
    Cubics out(middle_mm.rows(), 8);
    for (Index i = 0, n = middle_mm.rows(); i < n; ++i)
        for (int k = 0; k < 4; ++k) out.row(i).segment<2>(6 - 2 * k) = middle_mm.row(n - 1 - i).segment<2>(2 * k);
    return out;
}

}  // namespace

PathEnd path_end(const Stroke& stroke, const Line& line, Side side) {
    const bool at_start = side == Side::start;
    const Sample sample = line.at(at_start ? 0.0 : line.length());
    const Vector2d along = (at_start ? -1.0 : 1.0) * line.tangent(sample);
    return {sample.middle, along, {-along.y(), along.x()}, half_width_at(stroke, at_start ? 0.0 : 1.0)};
}

void StrokePath::append(const Cubics& more_mm) {
    const Index before = middle_mm_.rows();
    middle_mm_.conservativeResize(before + more_mm.rows(), Eigen::NoChange);
    middle_mm_.bottomRows(more_mm.rows()) = more_mm;
    end_mm_ = more_mm.row(more_mm.rows() - 1).tail<2>().transpose();
}

void StrokePath::add_width(double at_mm, double half_mm) {
    if (half_mm_.empty() || half_mm_.back() != std::pair(at_mm, half_mm)) half_mm_.emplace_back(at_mm, half_mm);
}

void StrokePath::follow(const Stroke& stroke, const Line& line, double from_mm, double to_mm) {
    const double before_mm = half_mm_.empty() ? 0.0 : length_mm(), whole_mm = line.length();
    const auto [first, last] = std::minmax(from_mm, to_mm);
    const Cubics part = sub_path(stroke.middle_mm, line.at(first).place, line.at(last).place);
    append(to_mm < from_mm ? reversed(part) : part);
    std::vector<double> at{from_mm, to_mm};
    for (const WidthKnot& knot : stroke.half_width)
        if (knot.at * whole_mm > first && knot.at * whole_mm < last) at.push_back(knot.at * whole_mm);
    std::stable_sort(at.begin(), at.end());
    if (to_mm < from_mm) std::reverse(at.begin(), at.end());
    for (const double s : at) add_width(before_mm + std::abs(s - from_mm), half_width_at(stroke, s / whole_mm));
}

void StrokePath::line_to(const Vector2d& to_mm, double half_mm) {
    Cubics straight(1, 8);
    for (int i = 0; i < 4; ++i) straight.row(0).segment<2>(2 * i) = end_mm_ + i / 3.0 * (to_mm - end_mm_);
    add_width(length_mm() + (to_mm - end_mm_).norm(), half_mm);
    append(straight);
}

Stroke StrokePath::with_properties_of(const Stroke& stroke) const {
    Stroke out = stroke;
    out.middle_mm = middle_mm_;
    out.half_width.clear();
    for (const auto& [s, half] : half_mm_) out.half_width.push_back({s / length_mm(), half});
    return out;
}

Stroke clamp_widths(const Stroke& stroke, const Brush& brush) {
    Stroke out = stroke;
    const auto [least, greatest] = brush.half_width_range_mm();
    for (WidthKnot& knot : out.half_width) knot.half_width_mm = std::clamp(knot.half_width_mm, least, greatest);
    return out;
}

double distance_to_outline_mm(const Rings& rings, const PathEnd& end, double left_mm) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Ring& ring : rings)
        for (Index i = 0, n = ring.rows(); i < n; ++i) {
            const Vector2d a = ring.row(i).transpose() - end.at_mm, b = ring.row((i + 1) % n).transpose() - end.at_mm;
            const double ya = a.dot(end.left) - left_mm, yb = b.dot(end.left) - left_mm;
            if ((ya > 0.0) == (yb > 0.0)) continue;
            const double x = a.dot(end.along) + (b - a).dot(end.along) * ya / (ya - yb);
            if (x > 0.0) nearest = std::min(nearest, x);
        }
    return nearest;
}

std::optional<Cut> find_cut(const Stroke& stroke, const PathEnd& end, double left_mm, Caps caps) {
    if (stroke.target_mm.empty()) return caps == Caps::straight ? std::optional(Cut{end.half_mm, 0.0}) : std::nullopt;
    const auto ahead_mm = [&](double share) { return distance_to_outline_mm(stroke.target_mm, end, share * left_mm); };
    const double right = ahead_mm(-1.0), left = ahead_mm(1.0);
    const Cut cut{0.5 * (right + left), 0.5 * (right - left) / left_mm};
    for (const double share : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        const double ahead = ahead_mm(share), deviation = ahead - (cut.ahead_mm - cut.slope * share * left_mm);
        if (!(ahead <= kEndTuning.max_cut_distance * end.half_mm &&
              std::abs(deviation) <= kEndTuning.max_cut_deviation * end.half_mm))
            return {};
    }
    return cut;
}

double reach_beyond_end_mm(const Brush& brush, double depth, double half_width_mm) {
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
    const auto tip_is_inside = [&](double s) {
        return s - brush.tip_to_widest(depth_of(stroke, brush, s / std::max(length, 1e-300))) + h0 >= 0.0;
    };
    constexpr int n = 400;
    int first = 0;
    while (first < n && !tip_is_inside(length * first / n)) ++first;
    const double s0 = first > 0 ? bisect(length * (first - 1) / n, length * first / n, tip_is_inside) : 0.0;
    return {s0, length - std::max(0.0, reach_beyond_end_mm(brush, depth_of(stroke, brush, 1.0), h1))};
}

Stroke extend_to_drawn_end(const Stroke& stroke, const Brush& brush) {
    if (stroke.closed || brush.is_rigid()) return stroke;
    const Line line(stroke, brush);
    const double length_mm = line.length();
    if (!(length_mm > 0.0)) return stroke;
    const PathEnd end = path_end(stroke, line, Side::end);
    const double beyond_mm = -reach_beyond_end_mm(brush, depth_of(stroke, brush, 1.0), end.half_mm);
    const auto [s0, s1] = painted_stretch(stroke, brush, length_mm);
    const bool is_dab = !(s1 - s0 > 1e-6);
    if (is_dab || !(beyond_mm > kEndTuning.max_end_gap * end.half_mm)) return stroke;
    StrokePath path;
    path.follow(stroke, line, 0.0, length_mm);
    path.line_to(end.place(beyond_mm, 0.0), end.half_mm);
    return path.with_properties_of(stroke);
}

}  // namespace brushsvg
