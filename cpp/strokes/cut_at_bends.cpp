#include "strokes/cut_at_bends.hpp"

#include <algorithm>
#include <cmath>

#include "inverse/middle_line.hpp"
#include "strokes/stroke_variants.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr double kToleranceMm = 0.01;  // of flattened lines
// Least length of the chords before and behind a bend.
constexpr double kMinReachMm = 0.1;
// A brush can go round a bend that turns less.
constexpr double kMinBendRad = 30.0 / 180.0 * 3.14159265358979323846;
constexpr std::size_t kMaxBends = 8;  // bends at which one stroke may be cut at most: limits the work

}  // namespace

std::vector<Gap> find_gaps(const Stroke& stroke) {
    std::vector<Gap> gaps;
    if (stroke.closed) return gaps;
    const MiddlePolyline line = flatten(stroke, kToleranceMm);
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
        const double at = line(i, 2), reach = std::max(line(i, 3), kMinReachMm);
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
    const MiddlePolyline line = flatten(stroke, kToleranceMm);
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
