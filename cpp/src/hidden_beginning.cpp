#include "hidden_beginning.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stroke_ends.hpp"

namespace brushsvg {
namespace {

using Eigen::Vector2d;

/// Steps of the way back at a hidden beginning, a few times as long as the widest section's lever.
constexpr int kStepsBack = 12;
/// Shorter ways back that are tried where the whole one has no room.
constexpr int kShorter = 4;
constexpr int kHalvings = 40;  // of a few mm: to rounding
/// Of the front of a footprint, what is wide enough to hide a pointed rear.
constexpr double kHidingShare = 0.8;
constexpr double kWithinReach = 0.999;
/// Steps of the depth and of the way in which the mark is narrowed for that, as shares of the whole.
constexpr double kNarrowingDepths = 1.0 / 64.0, kNarrowingWay = 1.0 / 12.0;

}  // namespace

std::optional<std::pair<double, Stroke>> narrowed(const Stroke& stroke, const Brush& brush, double length_mm,
                                                  double from_mm) {
    const double step_mm = kNarrowingWay * brush.tip_to_widest(depth_of(stroke, brush, 0.0));
    std::vector<WidthKnot> knots;
    for (double s = 0.0; s < length_mm; s += step_mm) {
        const double at = s / length_mm, wanted = depth_of(stroke, brush, at);
        double depth = wanted;
        while (depth > 0.0 && s - brush.tip_to_widest(depth) < from_mm) depth -= kNarrowingDepths * wanted;
        if (!(depth > brush.depth_range_mm[0])) return {};
        knots.push_back({at, brush.half_width(depth)});
        if (depth < wanted) continue;
        if (knots.size() == 1) return {{s, stroke}};
        Stroke out = stroke;
        knots.back().half_width_mm = half_width_at(stroke, at);
        for (const WidthKnot& knot : stroke.half_width)
            if (knot.at > at) knots.push_back(knot);
        out.half_width = std::move(knots);
        return {{s, std::move(out)}};
    }
    return {};
}

std::optional<Samples> way_back(const Brush& brush, const Line& line, const InverseLag& inverse, double from_mm,
                                double to_mm, double step_tolerance) {
    Samples back;
    for (int i = 0; i <= kStepsBack; ++i) {
        const double s = from_mm + (to_mm - from_mm) * i / kStepsBack;
        Sample sample = line.at(std::max(s, 0.0));
        if (!(brush.lever_to_widest(sample.depth) > 0.0)) return {};
        if (s < 0.0) sample.middle += s * line.tangent(sample);
        back.push_back(sample);
    }
    inverse(back, -line.tangent(back.front()));
    Samples few{back.front()};
    for (std::size_t i = 1, from = 0; i + 1 < back.size(); ++i)
        for (std::size_t k = from + 1; k <= i; ++k)
            if (off_chord(back[from], back[i + 1], back[k]) > step_tolerance) {
                few.push_back(back[i]);
                from = i;
            }
    few.push_back(back.back());
    return few;
}

std::optional<double> goes_on_mm(const Stroke& onward, const Brush& brush, const Line& line, const Vector2d& contact_mm,
                                 const std::array<double, 2>& within_mm) {
    const auto beyond = [&](double s) {
        const double at = std::clamp(s / line.length(), 0.0, 1.0);
        return (line.at(s).middle - contact_mm).norm() - brush.lever_to_widest(depth_of(onward, brush, at));
    };
    auto [a, b] = within_mm;
    if (!(a < b) || beyond(a) > 0.0 || !(beyond(b) > 0.0)) return {};
    for (int i = 0; i < kHalvings; ++i) {
        const double s = 0.5 * (a + b);
        (beyond(s) > 0.0 ? b : a) = s;
    }
    return b;
}

std::optional<HiddenBeginning> hidden_beginning(const Stroke& stroke, const Brush& brush, const Line& line,
                                                const InverseLag& inverse, double last_mm, double step_tolerance) {
    if (stroke.closed || brush.is_rigid() || !(line.length() > 0.0)) return {};
    const auto lever = [&](const Stroke& of, double s) {
        return brush.lever_to_widest(depth_of(of, brush, std::clamp(s / line.length(), 0.0, 1.0)));
    };
    const double e = lever(stroke, 0.0);
    if (!(e > 0.0)) return {};
    // there the front reaches the drawn beginning, half a width before the path's
    double turn_mm = beyond_the_end(brush, depth_of(stroke, brush, 0.0), half_width_at(stroke, 0.0));
    const double front_mm = turn_mm + half_width_at(stroke, 0.0);
    const auto onward = narrowed(stroke, brush, line.length(), turn_mm - kHidingShare * front_mm);
    if (!onward) return {};
    // P may not rest so far before the path that its first point is out of reach
    turn_mm = std::max(turn_mm, -kWithinReach * (e + lever(onward->second, 0.0)));
    // as far back as it goes on from with all its width, or what there is room for; less leaves a waist
    const double way_mm = std::max(2.0 * e, onward->first - turn_mm);
    double from_mm = turn_mm + way_mm;
    for (int tries = 0; from_mm > last_mm || !rear_lies_inside(stroke, brush, line, std::max(from_mm, 0.0)); ++tries) {
        if (tries == kShorter) return {};
        from_mm -= way_mm / kShorter;
    }

    auto back = way_back(brush, line, inverse, from_mm, turn_mm, step_tolerance);
    if (!back) return {};
    const Vector2d contact = back->back().contact;
    const auto on_from_mm = goes_on_mm(onward->second, brush, line, contact,
                                       {std::max(0.0, turn_mm + e), std::min(turn_mm + 4.0 * e, last_mm)});
    if (!on_from_mm) return {};
    return HiddenBeginning{std::move(*back), onward->second, *on_from_mm,
                           (line.at(*on_from_mm).middle - contact).normalized()};
}

}  // namespace brushsvg
