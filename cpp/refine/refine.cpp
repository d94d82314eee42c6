#include "refine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brushsvg/coverage.hpp"
#include "brushsvg/excess_turning.hpp"
#include "brushsvg/mark_overlap.hpp"
#include "brushsvg/simulate.hpp"
#include "brushsvg/target_mark.hpp"
#include "inverse/all_poses.hpp"
#include "inverse/ends/end_styles.hpp"
#include "inverse/simplify_after_turn.hpp"
#include "outline_fit.hpp"
#include "patch_path.hpp"

namespace brushsvg::fit {
namespace {

using Eigen::Index;

// Spacing of samples along the patch's path, in half widths of the mark. With a wider spacing, waists show between the
// footprints.
constexpr double kSampleSpacingHalfWidths = 0.3, kMaxSpacingHalfWidths = 0.6;
constexpr std::size_t kMaxSamples = 1000;
// Spacing of the splines' controls along the path, in half widths. At twice the spacing, ends and corners keep their
// errors (0.002 of overlap); a smaller spacing wins nothing. The number of controls is limited because the effort grows
// with its cube.
constexpr double kControlSpacingHalfWidths = 1.5;
constexpr int kMaxControls = 60;
// Least depth [mm]: with less depth, the paint would dry on the way.
constexpr double kMinDepthMm = 0.2;
// How far the TCP may go beyond the sheet [mm], if the machine does not specify it.
constexpr double kMaxBeyondSheetMm = 30.0;
// A blunt start needs a patch that comes in from the side, which no small step finds. Where the overlap stays below
// kMinGoodOverlap, the path is turned at its start by kStartTurnRad [rad] and fitted again.
constexpr double kStartTurnRad = 1.2, kMinGoodOverlap = 0.93;
// How large the first step may be. If a mark had kMinMissedOverlap more overlap but no such mark is calm enough,
// smaller steps find another one. Without them, a bar of 12 mm keeps its pointed start.
constexpr double kInitialTrust = 1e4, kReducedTrust = 3e2, kMinMissedOverlap = 0.01;
// Shares of the tolerance: for the tool's chords, and for how much fewer poses may change the mark. Twice the second
// share saves a tenth of the poses. The overlap then loses as much again (0.0025 on characters) as before (0.0006).
constexpr double kChordToleranceShare = 0.2, kSimplifyToleranceShare = 0.5;
constexpr double kRingToleranceMm = 0.01;  // tolerance of outlines [mm], as in the report
// Pixels of the trial marks: on half the width of the mark, and in all. The report's pixels are elsewhere, and their
// overlap may differ by kPixelOverlapError.
constexpr double kPxPerHalfWidth = 6.0, kMaxPx = 4e6, kPixelOverlapError = 0.005;
constexpr std::array<double, 2> kPxPerMmRange{8.0, 40.0};
// Overlap that a full turn of the mark's outline costs, and a thorn. Curls and thorns cover more, and the eye sees them
// first. At 0.15 and 0.03, strokes of characters lose 0.003 of overlap. At half the values, marks of letters turn more
// than in closed form. Letters as a whole are checked in Python (planning/touching_strokes.py).
constexpr double kTurnCost = 0.1, kThornCost = 0.02;
// Parts of the step that are tried where the whole step is not calm. Without them, strokes of letters overlap by 0.002
// less, strokes of characters by 0.003.
constexpr std::array<double, 4> kStepParts{1.0, 0.75, 0.5, 0.25};

double mean_half_width(const Stroke& stroke, const Brush& brush) {
    if (!brush.width_follows_depth()) return brush.half_width(brush.paint_depth_mm);
    double sum = 0.0;
    for (int i = 0; i <= 100; ++i) sum += half_width_at(stroke, i / 100.0);
    return sum / 101.0;
}

/// Return the depths that were measured for the brush, extended to the depths that the stroke needs anyway. This adds
/// no warning.
std::array<double, 2> depth_limits(const PatchSamples& samples, const Brush& brush) {
    double least = samples[0].depth_mm, greatest = least;
    for (const PatchSample& sample : samples) {
        least = std::min(least, sample.depth_mm);
        greatest = std::max(greatest, sample.depth_mm);
    }
    if (!brush.width_follows_depth()) return {least, least};
    double lo = std::max(kMinDepthMm, brush.depth_range_mm[0]), hi = brush.depth_range_mm[1];
    for (const Profile* profile : {&brush.lag, &brush.tip_gap, &brush.tip_to_widest, &brush.half_width}) {
        if (!profile->calibrated_mm) continue;
        lo = std::max(lo, (*profile->calibrated_mm)[0]);
        hi = std::min(hi, (*profile->calibrated_mm)[1]);
    }
    return {std::min(lo, least), std::max(hi, greatest)};
}

/// Return how far a box reaches beyond the sheet [mm].
double overshoot_mm(const std::array<double, 4>& box, const std::array<double, 2>& sheet) {
    return std::max({-box[0], -box[1], box[2] - sheet[0], box[3] - sheet[1]});
}
std::array<double, 4> box_of(const Poses& poses) {
    return {poses.col(0).minCoeff(), poses.col(1).minCoeff(), poses.col(0).maxCoeff(), poses.col(1).maxCoeff()};
}

/// The target of a stroke as an outline and in pixels, made once for all trials.
struct Target {
    Rings outline;
    Window window{};
    double px_per_mm = 0.0, area_mm2 = 0.0;
    Coverage pixels;

    Target(Rings rings, double half_width_mm) : outline(std::move(rings)), area_mm2(area(outline)) {
        Eigen::RowVector2d low = Eigen::RowVector2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
        for (const Ring& ring : outline) {
            if (ring.rows() == 0) continue;
            low = low.cwiseMin(ring.colwise().minCoeff());
            high = high.cwiseMax(ring.colwise().maxCoeff());
        }
        window = {low.x(), low.y(), high.x() - low.x(), high.y() - low.y()};
        px_per_mm = std::min(std::clamp(kPxPerHalfWidth / half_width_mm, kPxPerMmRange[0], kPxPerMmRange[1]),
                             std::sqrt(kMaxPx / (window.width_mm * window.height_mm)));
        pixels = coverage(outline, window, px_per_mm);
    }
    double overlap_with(const Rings& mark) const {
        const Coverage painted = coverage(mark, window, px_per_mm);
        double common = 0.0;
        for (Eigen::Index row = 0; row < pixels.rows(); ++row)
            common += pixels.row(row).cwiseMin(painted.row(row)).sum();
        common /= px_per_mm * px_per_mm;
        return common / (area_mm2 + area(mark) - common);
    }
};

/// A pass and how well it paints its stroke.
struct Trial {
    std::array<double, 4> painted_bounds, tool_bounds;
    double overlap, turning;  ///< turning: of the mark's outline, more than of the target [full turns]
    int thorns;
    Trial(const Pass& pass, const Target& target, const Brush& brush, Terminal start) {
        const PassMarks marks = simulate(pass, brush);
        painted_bounds = brushsvg::painted_bounds(marks, brush);
        tool_bounds = box_of(pass.poses_mm);
        const Rings mark = outline(marks, brush);
        overlap = target.overlap_with(mark);
        turning = excess_turning(mark, target.outline);
        // do not count the point of a start that was requested as pointed
        thorns = std::max(0, brushsvg::thorns(mark, target.outline) - (start == Terminal::pointed ? 1 : 0));
    }
    /// Return the overlap less the cost of turning and thorns. Negative turning counts as well. The pieces of a letter
    /// that strokes paint are ragged where other pieces were cut from them, so every mark turns less.
    double merit() const { return overlap - kTurnCost * turning - kThornCost * thorns; }
    bool is_as_calm_as(const Trial& other) const { return turning <= other.turning && thorns <= other.thorns; }
};

/// Return the overlap as the report computes it.
double reported_overlap(const Pass& pass, const Stroke& stroke, const Brush& brush) {
    return common_area(mark_overlap({simulate(pass, brush)}, {stroke}, brush)).overlap();
}

}  // namespace

RefinedPass refine(const Stroke& stroke, const Brush& brush, const RefineOptions& options) {
    const bool anywhere = options.sheet_mm == std::array<double, 2>{0.0, 0.0};
    if (!anywhere) check_sheet(options.sheet_mm);
    RefinedPass closed;
    CompensateOptions closed_options{Compensation::closed, options.tolerance_mm, {}, options.speed_mm_s};
    closed_options.start = options.start;
    closed_options.end = options.end;
    WithAllPoses compensated = compensate_with_all_poses(stroke, brush, closed_options);
    closed.plan = std::move(compensated.plan);
    // poses next to the path would be mistaken for its bends if there were few
    const Pass& dense = compensated.all_poses;
    const double half_width = mean_half_width(stroke, brush);
    const PatchSamples base = patch_path(dense, brush, kSampleSpacingHalfWidths * half_width, kMaxSamples);
    const Rings target_rings = target_outline(stroke, kRingToleranceMm);
    if (base.size() < 2 || brush.is_rigid() || !(area(target_rings) > 0.0)) return closed;
    const double way = path_length(base);
    // a thread: no footprint shows in it
    if (way > kMaxSpacingHalfWidths * half_width * double(base.size())) return closed;

    const int controls =
        std::clamp(int(std::lround(way / (kControlSpacingHalfWidths * half_width))) + 3, 5, kMaxControls);
    const PatchPath path(base, controls, depth_limits(base, brush));
    const auto stays_inside = [&](const std::array<double, 4>& box, const std::array<double, 4>& before, double reach) {
        return overshoot_mm(box, options.sheet_mm) <= std::max(reach, overshoot_mm(before, options.sheet_mm));
    };
    // the turned ends are round already
    if (!find_full_turns(simulate(dense, brush, 0.02, false)).empty()) return closed;
    const Terminal end = stroke.settings.end ? parse_terminal(*stroke.settings.end, stroke.id) : options.end;
    if (end == Terminal::pointed) return closed;  // the fit would fill it as far as the drawing goes
    const Target target(target_rings, half_width);
    const Trial before(closed.plan.pass, target, brush, options.start);
    closed.overlap = closed.overlap_closed = before.overlap;
    const auto in_bounds = [&](const Trial& after) {
        return anywhere || (stays_inside(after.painted_bounds, before.painted_bounds, 0.0) &&
                            stays_inside(after.tool_bounds, before.tool_bounds, kMaxBeyondSheetMm));
    };
    double best_merit = before.merit(), most = before.overlap, overlap = 0.0;
    Pass best;
    const auto try_fit = [&](double turn, double trust) {
        Eigen::VectorXd start = Eigen::VectorXd::Zero(path.unknowns());
        start[2] = turn;
        start[3] = 0.3 * turn;
        const Eigen::VectorXd x =
            fit_outline(path, brush, target_rings, 2.0 * half_width, options.iterations, start, trust);
        for (double part : kStepParts) {
            Pass moved = closed.plan.pass;
            moved.arcs.clear();
            moved.poses_mm = poses_along(path.at(part * x), brush, kChordToleranceShare * options.tolerance_mm);
            moved = simplify_after_turn(moved, brush, kSimplifyToleranceShare * options.tolerance_mm);
            const Trial after(moved, target, brush, options.start);
            if (!in_bounds(after)) continue;
            most = std::max(most, after.overlap);
            const bool is_better = after.overlap > before.overlap;
            if (is_better && after.merit() > best_merit) {
                best = moved;
                best_merit = after.merit();
                overlap = after.overlap;
            }
            if (is_better && after.is_as_calm_as(before)) break;
        }
    };
    try_fit(0.0, kInitialTrust);
    if (best.poses_mm.rows() == 0 && most > before.overlap + kMinMissedOverlap) try_fit(0.0, kReducedTrust);
    for (const double turn : {kStartTurnRad, -kStartTurnRad})
        if (most < kMinGoodOverlap) try_fit(turn, kInitialTrust);
    if (best.poses_mm.rows() == 0) return closed;
    // keep nothing that the report finds worse: its pixels are elsewhere
    if (overlap < before.overlap + kPixelOverlapError &&
        !(reported_overlap(best, stroke, brush) > reported_overlap(closed.plan.pass, stroke, brush)))
        return closed;
    RefinedPass done = closed;
    done.plan.pass = std::move(best);
    done.plan.tracking_error = tracking_error_of(done.plan.pass, stroke, brush, options.tolerance_mm);
    done.overlap = overlap;
    done.is_improved = true;
    return done;
}

}  // namespace brushsvg::fit
