#include "brushsvg/compensate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/format_text.hpp"
#include "base/tolerance.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/lag_arc.hpp"
#include "brushsvg/simulate.hpp"
#include "inverse/all_poses.hpp"
#include "inverse/closed_form.hpp"
#include "inverse/ends/select_ends.hpp"
#include "inverse/middle_line.hpp"
#include "inverse/simplify_after_turn.hpp"
#include "values/require_usable.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Place the TCP at m + r0 T. No compensation if r0 = 0.
PoseList offset(const Stroke& stroke, const Brush& brush, const Line& line, double r0, double step_tolerance) {
    Samples samples;
    if (line.length() > 0.0)
        samples = line.coarse_samples(0.0, line.length(), find_depth_places(stroke, brush, line.length(), {}));
    if (samples.size() < 2) {
        samples = {line.at(0.0)};
        samples[0].heading = Vector2d(1.0, 0.0);
        samples[0].contact = samples[0].middle;
        samples[0].tcp = samples[0].middle + r0 * samples[0].heading;
    } else {
        refine_steps(line, samples, step_tolerance, [&](Samples& all) {
            for (Sample& sample : all) {
                sample.heading = line.tangent(sample);
                sample.contact = sample.middle;
                sample.tcp = sample.middle + r0 * sample.heading;
            }
        });
    }
    PoseList out;
    out.add(samples.front().middle, 0.0);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (i > 0 && r0 > 0.0 && (samples[i].middle - samples[i - 1].middle).norm() <= 1e-9) {
            const double angle = angle_between(samples[i - 1].heading, samples[i].heading);
            const double sagitta = std::max(1e-3, 1.0 - step_tolerance / r0);
            const int n = int(std::ceil(std::abs(angle) / std::min(kMaxTurnStepRad, 2.0 * std::acos(sagitta))));
            const std::int64_t before = out.last();
            for (int k = 1; k < n; ++k)
                out.add(samples[i].middle + r0 * rotated<double>(samples[i - 1].heading, angle * k / n),
                        samples[i].depth);
            out.add(samples[i].tcp, samples[i].depth);
            out.arc(before, samples[i].middle, angle);
        } else {
            out.add(samples[i].tcp, samples[i].depth);
        }
    }
    out.add(samples.back().tcp, 0.0);
    return out;
}

double median_depth(const Stroke& stroke, const Brush& brush) {
    std::vector<double> depths;
    for (int i = 0; i <= 200; ++i) depths.push_back(depth_of(stroke, brush, i / 200.0));
    std::nth_element(depths.begin(), depths.begin() + 100, depths.end());
    return depths[100];
}

/// The least and the greatest depth [mm].
using Depths = std::array<double, 2>;

Depths depth_range_of_widths(const Stroke& stroke, const Brush& brush) {
    Depths found{std::numeric_limits<double>::infinity(), 0.0};
    for (const WidthKnot& knot : stroke.half_width) {
        if (!(knot.half_width_mm > 0.0))
            throw Error("width-out-of-reach",
                        "the width is 0 mm along a part of the stroke, which no brush can paint: draw it wider",
                        stroke.id, 0.0, std::array<double, 2>{0.0, 2.0 * brush.half_width_range_mm()[1]});
        const double depth = brush.depth_for_half_width(knot.half_width_mm, stroke.id);
        found = {std::min(found[0], depth), std::max(found[1], depth)};
    }
    return found;
}

void warn_unmeasured_depths(const Depths& depths, const std::string& stroke, const Brush& brush,
                            std::vector<Warning>& warnings) {
    const auto [least, greatest] = depths;
    double lo = brush.depth_range_mm[0], hi = brush.depth_range_mm[1];
    for (const Profile* profile : {&brush.lag, &brush.tip_gap, &brush.tip_to_widest, &brush.half_width}) {
        if (!profile->calibrated_mm) continue;
        lo = std::max(lo, (*profile->calibrated_mm)[0]);
        hi = std::min(hi, (*profile->calibrated_mm)[1]);
    }
    if (least >= lo - 1e-9 && greatest <= hi + 1e-9) return;
    warnings.push_back(Warning{"depth-not-measured", stroke,
                               format_text("depth %.2f mm is outside the range [%.1f, %.1f] mm in which brush ",
                                           least < lo - 1e-9 ? least : greatest, lo, hi) +
                                   brush.name + " was measured"});
}

/// Return the depths at which the brush is turned on the spot, for a stroke that begins with only a turn: a dot. Its
/// other moves may be lines, which have no turn.
std::optional<Depths> depth_range_of_turns(const BrushMoves& moves) {
    if (moves.front().line) return {};
    Depths found{std::numeric_limits<double>::infinity(), 0.0};
    for (const BrushMove& move : moves)
        if (move.turn) found = {std::min(found[0], move.turn->depth_mm), std::max(found[1], move.turn->depth_mm)};
    return found;
}

constexpr double kMaxLagMm = 1000.0;  // no brush has a longer lag

/// Share of the tolerance that the steps along the line use up if the path is simplified afterwards. A larger value
/// leaves too little of the tolerance for the simplification. A smaller one costs time, and poses where the brush is
/// loose, which are not simplified.
constexpr double kStepToleranceShare = 0.35;
/// Upper limit of that step tolerance [mm], derived from the default tolerance. With larger steps their own corners
/// would show. From equal steps, a coarser tolerance never leaves more poses than a finer one.
constexpr double kMaxStepToleranceMm = 0.00875;
/// Finer tolerances [mm] that are tried in addition to a coarser one.
constexpr double kFinerTolerancesMm[] = {0.5, 0.2, 0.1, 0.05};
/// Shares of the tolerance: how much simplification may use up, and the tracking error that is then accepted. Between
/// its rows the check is slightly off: at 0.95 the error of a mark was 0.0002 mm too large.
constexpr double kSimplifyShare = 0.9, kAcceptedErrorShare = 0.9;
/// Share of the tolerance that fewer poses may add to a tracking error that already exceeds the tolerance. With none,
/// all poses of a cusp were kept for 1e-4 mm. A plainer start must win more than this share, because it does not change
/// errors elsewhere.
constexpr double kAddedErrorShare = 0.1;

/// Use a simplified pass and its tracking error if that error is within the limit. Return whether it is.
bool try_simplified(const Pass& from, double share, double limit_mm, const Stroke& stroke, const Brush& brush,
                    double tolerance_mm, Pass& pass, TrackingError& error) {
    const Pass fewer = simplify_after_turn(from, brush, share * tolerance_mm);
    const TrackingError remains = tracking_error_of(fewer, stroke, brush, tolerance_mm);
    if (remains.largest_mm > limit_mm) return false;
    pass = fewer;
    error = remains;
    return true;
}

}  // namespace

Terminal parse_terminal(const std::string& name, const std::string& where) {
    for (const auto& [known, value] : kTerminalNames)
        if (name == known) return value;
    throw Error("choice-unknown", "the end of a stroke must be pointed, round, butt or auto, not \"" + name + "\"",
                where);
}

namespace {

/// Make a pass with poses at all steps of the closed form, as fine as the tolerance requires, or with few of them.
/// `plain`: the pass without poses. `make_poses(step_tolerance, turns)`: the closed form.
template <class MakePoses>
CompensatedPass pass_within_tolerance(const Pass& plain, bool few_poses, const Stroke& stroke, const Brush& brush,
                                      double tolerance_mm, MakePoses&& make_poses) {
    CompensatedPass result;
    result.pass = plain;
    double step_tolerance = 0.5 * tolerance_mm;
    // The plan is simulated before it is returned. Its steps get finer as long as its error decreases.
    if (few_poses) step_tolerance = std::min(kStepToleranceShare * step_tolerance, kMaxStepToleranceMm);
    for (int attempt = 0; attempt < 8; ++attempt, step_tolerance *= 0.4) {
        bool turns = false;
        Pass trial = plain;
        auto poses = make_poses(step_tolerance, turns);
        // the step tolerance with which the ends were selected
        if (!poses) poses = make_poses(0.5 * tolerance_mm, turns);
        if (!poses) return result;
        poses->write_to(trial);
        if (few_poses && try_simplified(trial, kSimplifyShare, kAcceptedErrorShare * tolerance_mm, stroke, brush,
                                        tolerance_mm, result.pass, result.tracking_error)) {
            result.tracking_error.has_turn_in_place = turns;
            return result;
        }
        TrackingError error = tracking_error_of(trial, stroke, brush, tolerance_mm);
        error.has_turn_in_place = turns;
        const bool better = attempt == 0 || error.largest_mm < 0.95 * result.tracking_error.largest_mm;
        if (better) {
            result.tracking_error = error;
            result.pass = trial;
        }
        // between its rows the check is slightly off, so a margin is needed; fewer poses need more of it
        const bool sure = !few_poses && error.largest_mm <= 0.9 * tolerance_mm;
        if (sure || ((turns || (few_poses && result.tracking_error.within_tolerance)) && !better) ||
            trial.poses_mm.rows() >= Index(kMaxAddedSamples))
            break;
    }
    // If the line cannot be followed within the tolerance, fewer poses may add only kAddedErrorShare to the error.
    const bool turns = result.tracking_error.has_turn_in_place;
    const double error_mm = result.tracking_error.largest_mm;
    const double limit_mm = error_mm <= tolerance_mm ? tolerance_mm : error_mm + kAddedErrorShare * tolerance_mm;
    if (few_poses)
        try_simplified(result.pass, 0.5, limit_mm, stroke, brush, tolerance_mm, result.pass, result.tracking_error);
    result.tracking_error.has_turn_in_place = turns;
    return result;
}

/// `all_poses`: receives the pass with all poses, if given.
CompensatedPass compensate_at_tolerance(const Stroke& stroke, const Brush& brush, const CompensateOptions& options,
                                        Pass* all_poses = nullptr) {
    check(stroke);
    require_usable(brush);
    require_tolerance(options.tolerance_mm, stroke.id);
    if (options.lag_mm && !(*options.lag_mm >= 0.0 && *options.lag_mm <= kMaxLagMm))
        throw Error("out-of-range",
                    format_text("the lag is %.4g mm, outside the range [0, %g] mm", *options.lag_mm, kMaxLagMm),
                    stroke.id, options.lag_mm, std::array<double, 2>{0.0, kMaxLagMm});
    if (!(options.speed_mm_s > 0.0) || std::isinf(options.speed_mm_s))
        throw Error("out-of-range",
                    format_text("the speed is %.4g mm/s, but must be finite and greater than 0", options.speed_mm_s),
                    stroke.id, options.speed_mm_s);
    const Line line(stroke, brush);
    CompensatedPass result;
    const Depths depths = depth_range_of_widths(stroke, brush);  // throws if the brush cannot paint a width
    Pass& pass = result.pass;
    pass.stroke = stroke.id;
    pass.speed_mm_s = std::min(options.speed_mm_s, brush.max_speed_mm_s);
    pass.layer = stroke.layer;
    pass.colour = stroke.colour;
    pass.settings = stroke.settings;

    double step_tolerance = 0.5 * options.tolerance_mm;
    if (options.method != Compensation::closed) {
        warn_unmeasured_depths(depths, stroke.id, brush, result.warnings);
        double r0 = 0.0;
        if (options.method == Compensation::constant)
            r0 = options.lag_mm ? *options.lag_mm : brush.lag(median_depth(stroke, brush));
        offset(stroke, brush, line, r0, step_tolerance).write_to(pass);
        result.tracking_error = tracking_error_of(pass, stroke, brush, options.tolerance_mm);
        return result;
    }
    const std::vector<BrushMoves> ways = select_ends(stroke, brush, options, step_tolerance);
    warn_unmeasured_depths(depth_range_of_turns(ways.front()).value_or(depths), stroke.id, brush, result.warnings);
    const Pass plain = pass;
    for (const BrushMoves& moves : ways) {
        const bool is_first = &moves == &ways.front();
        const bool few_poses =
            options.few_poses && (moves.front().line || moves.back().line);  // a disc has no poses to spare
        if (!is_first && result.tracking_error.within_tolerance) break;
        const auto make_poses = [&](double steps, bool& turns) { return closed_form(moves, brush, steps, turns); };
        CompensatedPass candidate =
            pass_within_tolerance(plain, few_poses, stroke, brush, options.tolerance_mm, make_poses);
        if (candidate.pass.poses_mm.rows() == 0) continue;
        if (!is_first && !(candidate.tracking_error.largest_mm <
                           result.tracking_error.largest_mm - kAddedErrorShare * options.tolerance_mm))
            continue;
        result.pass = std::move(candidate.pass);
        result.tracking_error = candidate.tracking_error;
        if (all_poses)
            *all_poses = pass_within_tolerance(plain, false, stroke, brush, options.tolerance_mm, make_poses).pass;
    }
    return result;
}

CompensatedPass compensate_best(const Stroke& given, const Brush& brush, const CompensateOptions& options,
                                Pass* all_poses) {
    Stroke stroke = given;
    if (options.method == Compensation::closed && !stroke.settings.end && options.end == Terminal::pointed)
        stroke.settings.end = "pointed";  // its tracking error is measured against a pointed end
    CompensatedPass result = compensate_at_tolerance(stroke, brush, options, all_poses);
    if (options.method != Compensation::closed || !options.few_poses) return result;
    // going as far as possible in each move does not always give the fewest moves
    for (const double finer_mm : kFinerTolerancesMm) {
        if (finer_mm >= options.tolerance_mm) continue;
        CompensateOptions finer_options = options;
        finer_options.tolerance_mm = finer_mm;
        CompensatedPass finer = compensate_at_tolerance(stroke, brush, finer_options);
        if (finer.pass.poses_mm.rows() >= result.pass.poses_mm.rows()) continue;
        // measure it with the tolerance of the plan that it would replace
        const bool turns = finer.tracking_error.has_turn_in_place;
        finer.tracking_error = tracking_error_of(finer.pass, stroke, brush, options.tolerance_mm);
        finer.tracking_error.has_turn_in_place = turns;
        if (finer.tracking_error.largest_mm > std::max(options.tolerance_mm, result.tracking_error.largest_mm))
            continue;
        result = finer;
    }
    return result;
}

}  // namespace

CompensatedPass compensate(const Stroke& stroke, const Brush& brush, const CompensateOptions& options) {
    return compensate_best(stroke, brush, options, nullptr);
}

WithAllPoses compensate_with_all_poses(const Stroke& stroke, const Brush& brush, const CompensateOptions& options) {
    WithAllPoses both;
    both.plan = compensate_best(stroke, brush, options, &both.all_poses);
    return both;
}

}  // namespace brushsvg
