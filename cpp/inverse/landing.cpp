#include "inverse/landing.hpp"

#include <algorithm>
#include <cmath>

#include "brushsvg/lag.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// How far inside q = P + r u a lift stays [mm]. With 0 the patch slips on straight moves (0.25 mm from depth 10). With
/// much more the patch relaxes towards its pressed shape.
constexpr double kLiftSlackMm = 0.05;
/// Largest deviation of straight moves from kLiftSlackMm [mm]. With a larger one the patch slips or relaxes.
constexpr double kLiftBandMm = 0.8 * kLiftSlackMm;
/// Number of depth steps (out of 128) in which a lift moves inside. Fewer steps would need an extra move.
constexpr double kLiftEaseSteps = 8.0;
/// Return whether the patch rests while the TCP runs up from P to P + r u and presses. It does as long as r(d)/d falls
/// with depth; otherwise the brush must be pressed down first.
bool may_press_while_running(const Brush& brush, double from, double depth) {
    const double reach = brush.lag(depth);
    for (int i = 1; i < 64; ++i) {
        const double t = i / 64.0;
        if (t * reach > brush.lag(from + t * (depth - from)) + 1e-12) return false;
    }
    return true;
}

}  // namespace

void land(const Stance& first, const Brush& brush, PoseList& out, double from_mm) {
    out.add(first.contact_mm, from_mm);
    if (!may_press_while_running(brush, from_mm, first.depth_mm)) out.add(first.contact_mm, first.depth_mm);
    out.add(first.contact_mm + brush.lag(first.depth_mm) * first.heading, first.depth_mm);
}

void lift(const Stance& last, const Brush& brush, PoseList& out, double until_mm) {
    if (brush.is_rigid()) {
        out.add(last.contact_mm, until_mm);
        return;
    }
    const auto add = [&](double reach_mm, double depth) {
        out.add(last.contact_mm + std::max(0.0, reach_mm) * last.heading, depth);
    };
    const auto reach = [&](double depth) { return brush.lag(depth) - kLiftSlackMm; };
    // Straight moves stay slightly inside the curve. Each move is as long as a straight line can be. The first move
    // begins where the brush is taut, and moves inside on its way.
    constexpr int n = 128;
    const auto depth_at = [&](int k) { return until_mm + (last.depth_mm - until_mm) * (n - k) / n; };
    int from = 0;
    double at = brush.lag(last.depth_mm);
    while (from < n) {
        double least = -1e300, most = 1e300;
        int to = from;
        double slope = 0.0;
        for (int k = from + 1; k <= n; ++k) {
            const double by = depth_at(from) - depth_at(k), target = reach(depth_at(k));
            const double inside = from > 0 ? 1.0 : std::min(1.0, double(k) / kLiftEaseSteps);
            least = std::max(least, (target - kLiftBandMm - at) / by);
            most = std::min(most, (target + kLiftSlackMm - inside * (kLiftSlackMm - kLiftBandMm) - at) / by);
            if (least > most) break;
            slope = 0.5 * (least + most);
            to = k;
        }
        if (to == from) {
            ++to;
            slope = (reach(depth_at(to)) - at) / (depth_at(from) - depth_at(to));
        }
        at += slope * (depth_at(from) - depth_at(to));
        add(at, depth_at(to));
        from = to;
    }
}

void turn_over(const Stance& before, const Stance& after, const Brush& brush, PoseList& out) {
    const double depth = std::min({kTurnOverDepthMm, before.depth_mm, after.depth_mm});
    if (depth < before.depth_mm) lift(before, brush, out, depth);
    land(after, brush, out, depth);
}

}  // namespace brushsvg
