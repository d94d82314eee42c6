#include "refine.hpp"

#include <algorithm>
#include <cmath>

#include "brushsvg/coverage.hpp"
#include "brushsvg/region.hpp"
#include "brushsvg/simulate.hpp"
#include "brushsvg/thin_out.hpp"
#include "brushsvg/wanted.hpp"
#include "outline_fit.hpp"
#include "patch_path.hpp"

namespace brushsvg::fit {
namespace {

using Eigen::Index;

// Samples of the patch's way, in half widths of the mark: farther apart the footprints leave waists between them.
constexpr double kStep = 0.3, kWidestStep = 0.6;
constexpr std::size_t kMostSamples = 1000;
// Controls of the splines along the way, in half widths: twice as far apart ends and corners keep what they miss (0.002
// of overlap), closer nothing is won. At most so many, since the effort grows with their cube.
constexpr double kControl = 1.5;
constexpr int kMostControls = 60;
// Less paints nothing that would not dry on the way.
constexpr double kLeastDepthMm = 0.2;
// Reach of the TCP beyond the sheet, that of a machine which says nothing else.
constexpr double kBeyondSheetMm = 30.0;
// A blunt beginning needs a patch that comes in from the side, which no small step finds: where the overlap stays below
// what is good, the way is turned at its beginning by so much [rad] and tried again.
constexpr std::array<double, 3> kFirstTurns{0.0, 1.2, -1.2};
constexpr double kGood = 0.93;
// Pixels judge by themselves where marks differ by more than they err (0.0017 on a taper).
constexpr double kSurely = 0.005;
constexpr double kPixelsToHalfWidth = 15.0, kLeastPixels = 8.0, kMostPixels = 2000.0;
// Shares of the tolerance: of the tool's chords, and of what fewer poses may change of the mark. At twice as much of
// the latter a tenth of them is saved, and the overlap loses as much again (0.0025 on characters) as it did (0.0006).
constexpr double kChords = 0.2, kThinned = 0.5;
constexpr double kRingTolerance = 0.01;  // as in the report

double mean_half_width(const Stroke& stroke, const Brush& brush) {
    if (!brush.width_follows_depth()) return brush.half_width(brush.paint_depth_mm);
    double sum = 0.0;
    for (int i = 0; i <= 100; ++i) sum += half_width_at(stroke, i / 100.0);
    return sum / 101.0;
}

/// Depths that the brush was measured at, and those that the stroke needs anyway: no warning comes on top.
std::array<double, 2> depths_for(const PatchSamples& samples, const Brush& brush) {
    double least = samples[0].depth_mm, greatest = least;
    for (const PatchSample& sample : samples) {
        least = std::min(least, sample.depth_mm);
        greatest = std::max(greatest, sample.depth_mm);
    }
    if (!brush.width_follows_depth()) return {least, least};
    double lo = std::max(kLeastDepthMm, brush.depth_range_mm[0]), hi = brush.depth_range_mm[1];
    for (const Profile* profile : {&brush.lag, &brush.tip_gap, &brush.tip_to_widest, &brush.half_width}) {
        if (!profile->calibrated_mm) continue;
        lo = std::max(lo, (*profile->calibrated_mm)[0]);
        hi = std::min(hi, (*profile->calibrated_mm)[1]);
    }
    return {std::min(lo, least), std::max(hi, greatest)};
}

/// How far a box reaches beyond the sheet [mm].
double beyond(const std::array<double, 4>& box, const std::array<double, 2>& sheet) {
    return std::max({-box[0], -box[1], box[2] - sheet[0], box[3] - sheet[1]});
}
std::array<double, 4> box_of(const Poses& poses) {
    return {poses.col(0).minCoeff(), poses.col(1).minCoeff(), poses.col(0).maxCoeff(), poses.col(1).maxCoeff()};
}

/// Two plans for one wanted mark, and which of them paints it better.
class Judge {
 public:
    Judge(const Brush& brush, const Rings& wanted, double half_width, const Pass& a, const Pass& b)
        : brush_(brush), wanted_(wanted), passes_{&a, &b}, marks_{simulate(a, brush, 0.03), simulate(b, brush, 0.03)} {
        bounds_ = {painted_bounds(marks_[0], brush), painted_bounds(marks_[1], brush)};
        auto box = bounds_[0];
        const auto include = [&](double left, double low, double right, double high) {
            box = {std::min(box[0], left), std::min(box[1], low), std::max(box[2], right), std::max(box[3], high)};
        };
        include(bounds_[1][0], bounds_[1][1], bounds_[1][2], bounds_[1][3]);
        for (const Ring& ring : wanted)
            include(ring.col(0).minCoeff(), ring.col(1).minCoeff(), ring.col(0).maxCoeff(), ring.col(1).maxCoeff());
        const Window window{box[0], box[1], box[2] - box[0], box[3] - box[1]};
        const double px_per_mm =
            std::min(kPixelsToHalfWidth / half_width, kMostPixels / std::max(window.width_mm, window.height_mm));
        fine_enough_ = px_per_mm * half_width >= kLeastPixels;
        const Coverage meant = coverage(wanted, window, px_per_mm);
        for (int k : {0, 1}) {
            Marks all;
            all.passes.push_back(marks_[k]);
            const Coverage painted = coverage(all, brush, window, px_per_mm);
            overlap_[k] = painted.cwiseMin(meant).cast<double>().sum() / painted.cwiseMax(meant).cast<double>().sum();
        }
        if (fine_enough_ && std::abs(overlap_[1] - overlap_[0]) > kSurely) return;
        for (int k : {0, 1}) overlap_[k] = brushsvg::overlap(outline(simulate(*passes_[k], brush), brush), wanted);
    }
    double overlap(int k) const { return overlap_[k]; }
    const std::array<double, 4>& painted(int k) const { return bounds_[k]; }

 private:
    const Brush& brush_;
    const Rings& wanted_;
    std::array<const Pass*, 2> passes_;
    std::array<PassMarks, 2> marks_;
    std::array<std::array<double, 4>, 2> bounds_;
    std::array<double, 2> overlap_{};
    bool fine_enough_ = false;
};

}  // namespace

RefinedPass refine(const Stroke& stroke, const Brush& brush, const RefineOptions& options) {
    RefinedPass closed;
    CompensateOptions how{Compensation::closed, options.tolerance_mm, {}, options.speed_mm_s};
    closed.plan = compensate(stroke, brush, how);
    how.few_poses = false;  // poses that lie beside the path would be taken for its bends
    const Pass dense = compensate(stroke, brush, how).pass;
    const double half_width = mean_half_width(stroke, brush);
    const PatchSamples base = patch_path(dense, brush, kStep * half_width, kMostSamples);
    const Rings wanted = wanted_outline(stroke, kRingTolerance);
    if (base.size() < 2 || brush.is_rigid() || wanted.empty()) return closed;
    const double way = way_of(base);
    if (way > kWidestStep * half_width * double(base.size())) return closed;  // a thread: no footprint shows in it

    const int controls = std::clamp(int(std::lround(way / (kControl * half_width))) + 3, 5, kMostControls);
    const PatchPath path(base, controls, depths_for(base, brush));
    const auto stays = [&](const std::array<double, 4>& box, const std::array<double, 4>& before, double reach) {
        return beyond(box, options.sheet_mm) <= std::max(reach, beyond(before, options.sheet_mm));
    };
    const bool anywhere = options.sheet_mm == std::array<double, 2>{0.0, 0.0};
    const auto painted_before = painted_bounds(simulate(closed.plan.pass, brush, 0.03), brush);
    RefinedPass best = closed;
    for (double turn : kFirstTurns) {
        Eigen::VectorXd start = Eigen::VectorXd::Zero(path.unknowns());
        start[2] = turn;
        start[3] = 0.3 * turn;
        RefinedPass moved = closed;
        moved.plan.pass.arcs.clear();
        moved.plan.pass.poses_mm =
            poses_along(path.at(fit_outline(path, brush, wanted, 2.0 * half_width, options.iterations, start)), brush,
                        kChords * options.tolerance_mm);
        moved.plan.pass = thin_out(moved.plan.pass, brush, kThinned * options.tolerance_mm);
        const Judge judge(brush, wanted, half_width, best.plan.pass, moved.plan.pass);
        best.overlap = judge.overlap(0);
        if (!best.bettered) best.overlap_closed = best.overlap;
        moved.overlap_closed = best.overlap_closed;
        moved.overlap = judge.overlap(1);
        moved.bettered = true;
        const bool in_bounds =
            anywhere || (stays(judge.painted(1), painted_before, 0.0) &&
                         stays(box_of(moved.plan.pass.poses_mm), box_of(closed.plan.pass.poses_mm), kBeyondSheetMm));
        if (in_bounds && moved.overlap > best.overlap) best = moved;
        if (best.overlap >= kGood) break;
    }
    if (best.bettered) best.plan.miss = miss_of(best.plan.pass, stroke, brush, options.tolerance_mm);
    return best;
}

}  // namespace brushsvg::fit
