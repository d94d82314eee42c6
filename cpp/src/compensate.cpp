#include "brushsvg/compensate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/coverage.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/excess_turning.hpp"
#include "brushsvg/lag_arc.hpp"
#include "brushsvg/mark_overlap.hpp"
#include "brushsvg/simulate.hpp"
#include "dot.hpp"
#include "hidden_beginning.hpp"
#include "inverse.hpp"
#include "landing.hpp"
#include "middle_line.hpp"
#include "stroke_ends.hpp"
#include "thin_out_after_turn.hpp"
#include "tolerance.hpp"
#include "usable.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Chords of the circle about the contact from one heading to the other. Inscribed chords leave the lever loose, so the
/// patch rests; tangent ones would drag it. Noted as an arc too, of radius r and not a hair less: a radius too large by
/// some rounding lets the patch creep by (1 + turn^2 / 2) times that, 0.6 um for 1e-4 mm and half a turn.
void turn_in_place(const Sample& from, const Sample& to, const Brush& brush, PoseList& out) {
    const double angle = angle_between(from.heading, to.heading);
    const int n = int(std::ceil(std::abs(angle) / kTurnChordRad));
    for (int k = 1; k < n; ++k) {
        const double c = double(k) / n, depth = from.depth + c * (to.depth - from.depth);
        out.add(from.contact + brush.lag(depth) * turned_by<double>(from.heading, c * angle), depth);
    }
}

/// Arc lengths where the depth passes a given one: samples must stand there.
std::vector<double> places_of_depths(const Stroke& stroke, const Brush& brush, double length,
                                     const std::vector<double>& depths) {
    std::vector<double> out;
    for (std::size_t k = 0; k < stroke.half_width.size(); ++k) {
        const WidthKnot& knot = stroke.half_width[k];
        if (knot.at > 0.0 && knot.at < 1.0) out.push_back(knot.at * length);
        if (k == 0) continue;
        const WidthKnot& before = stroke.half_width[k - 1];
        for (double depth : depths) {
            const double h = brush.half_width(depth), rise = knot.half_width_mm - before.half_width_mm;
            if ((before.half_width_mm - h) * (knot.half_width_mm - h) < 0.0)
                out.push_back((before.at + (knot.at - before.at) * (h - before.half_width_mm) / rise) * length);
        }
    }
    return out;
}

/// A mark no longer than a footprint: one landing that leaves the widest section at the path's end.
Samples dab(const Stroke& stroke, const Line& line) {
    Sample sample = line.at(line.length());
    const Vector2d across =
        point_at(stroke.middle_mm, {stroke.middle_mm.rows() - 1, 1.0}) - point_at(stroke.middle_mm, {0, 0.0});
    // a point has no direction: left to right, as one writes
    sample.heading = line.length() > 0.0 ? line.tangent(sample) : Vector2d(1.0, 0.0);
    if (across.norm() > 0.5 * line.length() && line.length() > 0.0) sample.heading = across.normalized();
    return {sample};
}

Stance stance_of(const Sample& sample) { return {sample.contact, sample.heading, sample.depth}; }

PoseList closed_form(const Stroke& stroke, const Brush& brush, const Line& line, Beginning start, double step_tolerance,
                     bool& turns) {
    auto [s0, s1] = painted_stretch(stroke, brush, line.length());
    const Inverse inverse(line, brush);
    std::optional<HiddenBeginning> hidden;
    if (start == Beginning::hidden) hidden = hidden_beginning(stroke, brush, line, inverse, s1, step_tolerance);
    std::optional<Vector2d> first;
    if (hidden) {
        s0 = hidden->on_from_mm;
        first = hidden->on_along;
    }
    const Stroke& painted = hidden ? hidden->onward : stroke;
    const Line onward(painted, brush);
    Samples samples;
    if (line.length() > 0.0 && s1 - s0 > 1e-6)
        samples = onward.coarse(s0, s1, places_of_depths(painted, brush, line.length(), inverse.crossings()));
    if (samples.size() < 2) {
        hidden.reset();
        samples = dab(stroke, line);
        inverse(samples);
    } else {
        refine_steps(onward, samples, step_tolerance, [&](Samples& all) { inverse(all, first); });
    }
    PoseList out;
    if (hidden) {
        land(stance_of(hidden->back.front()), brush, out);
        for (const Sample& sample : hidden->back) out.add(sample.tcp, sample.depth);
        turn_over(stance_of(hidden->back.back()), stance_of(samples.front()), brush, out);
    } else {
        land(stance_of(samples.front()), brush, out);
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
        turns = turns || !samples[i].taut;
        if (i > 0 && !brush.is_rigid()) {
            const double moved = (samples[i].contact - samples[i - 1].contact).norm();
            const double angle = angle_between(samples[i - 1].heading, samples[i].heading);
            const std::int64_t before = out.last();
            if (std::abs(angle) > kTurnStepRad && moved < 0.1 * brush.lag(samples[i].depth))
                turn_in_place(samples[i - 1], samples[i], brush, out);
            out.add(samples[i].tcp, samples[i].depth);
            if (moved < kSameCircleMm) out.arc(before, samples[i].contact, angle);
        } else {
            out.add(samples[i].tcp, samples[i].depth);
        }
    }
    lift(stance_of(samples.back()), brush, out);
    return out;
}

/// TCP at m + r0 T: r0 = 0 is no compensation.
PoseList offset(const Stroke& stroke, const Brush& brush, const Line& line, double r0, double step_tolerance) {
    Samples samples;
    if (line.length() > 0.0)
        samples = line.coarse(0.0, line.length(), places_of_depths(stroke, brush, line.length(), {}));
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
            const int n = int(std::ceil(std::abs(angle) / std::min(kTurnStepRad, 2.0 * std::acos(sagitta))));
            const std::int64_t before = out.last();
            for (int k = 1; k < n; ++k)
                out.add(samples[i].middle + r0 * turned_by<double>(samples[i - 1].heading, angle * k / n),
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

void warn(const Stroke& stroke, const Brush& brush, std::vector<Warning>& warnings) {
    double least = std::numeric_limits<double>::infinity(), greatest = 0.0;
    for (const WidthKnot& knot : stroke.half_width) {
        const double depth = brush.depth_for_half_width(knot.half_width_mm, stroke.id);
        least = std::min(least, depth);
        greatest = std::max(greatest, depth);
    }
    double lo = brush.depth_range_mm[0], hi = brush.depth_range_mm[1];
    for (const Profile* profile : {&brush.lag, &brush.tip_gap, &brush.tip_to_widest, &brush.half_width}) {
        if (!profile->calibrated_mm) continue;
        lo = std::max(lo, (*profile->calibrated_mm)[0]);
        hi = std::min(hi, (*profile->calibrated_mm)[1]);
    }
    if (least >= lo - 1e-9 && greatest <= hi + 1e-9) return;
    char text[200];
    std::snprintf(text, sizeof text, "depth %.2f mm is outside the range [%.1f, %.1f] mm in which brush ",
                  least < lo - 1e-9 ? least : greatest, lo, hi);
    warnings.push_back(Warning{"depth-not-measured", stroke.id, text + brush.name + " was measured"});
}

constexpr double kLongestLagMm = 1000.0;  // no brush is longer

/// What the steps along the line use up of the tolerance where poses are thinned out afterwards: more leaves too little
/// of it for that, less costs time, and poses where the brush is loose, which stay as they are.
constexpr double kStepShare = 0.35;
/// And no more of it than of the default one: the steps' own corners would show, and from the same steps a coarser
/// tolerance has no more poses left than a finer one.
constexpr double kMostStepToleranceMm = 0.00875;
/// Below a tolerance those that are tried as well.
constexpr double kFinerTolerancesMm[] = {0.5, 0.2, 0.1, 0.05};
/// Shares of the tolerance: what thinning out may use up, and the miss that is accepted then. Rows of the check lie a
/// little off the truth between them: at 0.95 a mark was 0.0002 mm off too far.
constexpr double kThinShare = 0.9, kSurely = 0.9;
/// And what fewer poses may add to a miss that is larger anyway: with none a cusp's poses were all kept for 1e-4 mm.
constexpr double kHairShare = 0.1;

/// Half a side of the square about the beginning that is looked at, and how far the mark is made for it, in half
/// widths; pixels on one half width. A pointed footprint reaches back by two half widths from its widest section.
constexpr double kLookedAt = 3.0, kMade = 6.0, kPixels = 8.0;
/// What hiding must win, in squares of the half width: of the 1.5 that a pointed beginning lacks, what one has to look
/// for.
constexpr double kWorthHiding = 0.2;
/// And what a full turn more of the mark's outline weighs against it, in squares of the greatest half width: knobs on
/// the thin ends of drops.
constexpr double kCalm = 0.3;

/// The pass up to where its path is so long, the brush left on the paper.
Pass beginning_of(const Pass& pass, double length_mm) {
    Pass out;
    out.stroke = pass.stroke;
    Index n = std::min<Index>(2, pass.poses_mm.rows());
    for (double way = 0.0; n < pass.poses_mm.rows() && way < length_mm; ++n)
        way += (pass.poses_mm.row(n) - pass.poses_mm.row(n - 1)).norm();
    out.poses_mm = pass.poses_mm.topRows(n);
    return out;
}

/// The beginning that differs less from the wanted mark, near it.
Beginning best_beginning(const Stroke& wanted_stroke, const Stroke& stroke, const Brush& brush, const Line& line,
                         double step_tolerance) {
    const double last_mm = painted_stretch(stroke, brush, line.length())[1];
    const std::optional<Dot> dot = dot_of(wanted_stroke, brush);
    if (!dot && !hidden_beginning(stroke, brush, line, Inverse(line, brush), last_mm, step_tolerance))
        return Beginning::exposed;
    bool turns = false;
    Pass exposed, hidden;
    closed_form(stroke, brush, line, Beginning::exposed, step_tolerance, turns).into(exposed);
    (dot ? poses_of(*dot, brush) : closed_form(stroke, brush, line, Beginning::hidden, step_tolerance, turns))
        .into(hidden);
    const double depth = depth_of(stroke, brush, 0.0), half = brush.half_width(depth);
    const Vector2d at = line.at(0.0).middle;
    const double side = 2.0 * kLookedAt * half, made = kMade * half + 4.0 * brush.lag(depth);
    const Window window{at.x() - 0.5 * side, at.y() - 0.5 * side, side, side};
    const Coverage wanted = wanted_coverage({wanted_stroke}, window, kPixels / half);
    const auto mark = [&](const Pass& pass) {
        Marks marks;
        marks.passes = {simulate(dot ? pass : beginning_of(pass, made), brush, 0.05 * half)};
        return marks;
    };
    const auto differs = [&](const Marks& marks) {
        return (coverage(marks, brush, window, kPixels / half) - wanted).cwiseAbs().sum() / (kPixels * kPixels);
    };
    const Marks pointed = mark(exposed), round = mark(hidden);
    const double won = differs(pointed) - differs(round) - kWorthHiding;
    if (!(won > 0.0)) return Beginning::exposed;
    const double turned = excess_turning(outline(round.passes[0], brush), outline(pointed.passes[0], brush));
    double greatest = half;
    for (const auto& knot : stroke.half_width) greatest = std::max(greatest, knot.half_width_mm);
    return won * half * half > kCalm * turned * greatest * greatest ? Beginning::hidden : Beginning::exposed;
}

/// Replaces pass and miss where fewer poses miss the line by no more than the larger of the limit and of that miss.
bool thin_out(const Pass& from, double share, double limit_mm, const Stroke& stroke, const Brush& brush,
              double tolerance_mm, Pass& pass, TrackingError& miss) {
    const Pass fewer = thin_out_after_turn(from, brush, share * tolerance_mm);
    const TrackingError remains = tracking_error_of(fewer, stroke, brush, tolerance_mm);
    if (remains.largest_mm > limit_mm) return false;
    pass = fewer;
    miss = remains;
    return true;
}

}  // namespace

Beginning beginning_named(const std::string& name, const std::string& where) {
    for (const auto& [known, value] : kBeginnings)
        if (name == known) return value;
    throw Error("choice-unknown", "a stroke's start is exposed, hidden or auto, not \"" + name + "\"", where);
}

namespace {

CompensatedPass at_its_tolerance(const Stroke& stroke, const Brush& brush, const CompensateOptions& options) {
    check(stroke);
    require_usable(brush);
    require_tolerance(options.tolerance_mm, stroke.id);
    if (options.lag_mm && !(*options.lag_mm >= 0.0 && *options.lag_mm <= kLongestLagMm))
        throw Error("out-of-range", "the lag is not within [0, 1000] mm", stroke.id, *options.lag_mm,
                    std::array<double, 2>{0.0, kLongestLagMm});
    if (!(options.speed_mm_s > 0.0) || std::isinf(options.speed_mm_s))
        throw Error("out-of-range", "the speed must be finite and greater than 0 mm/s", stroke.id, options.speed_mm_s);
    const Line line(stroke, brush);
    CompensatedPass result;
    warn(stroke, brush, result.warnings);
    Pass& pass = result.pass;
    pass.stroke = stroke.id;
    pass.speed_mm_s = std::min(options.speed_mm_s, brush.max_speed_mm_s);
    pass.layer = stroke.layer;
    pass.colour = stroke.colour;
    pass.settings = stroke.settings;

    double step_tolerance = 0.5 * options.tolerance_mm;
    if (options.method != Compensation::closed) {
        double r0 = 0.0;
        if (options.method == Compensation::constant)
            r0 = options.lag_mm ? *options.lag_mm : brush.lag(median_depth(stroke, brush));
        offset(stroke, brush, line, r0, step_tolerance).into(pass);
        result.miss = tracking_error_of(pass, stroke, brush, options.tolerance_mm);
        return result;
    }
    const Stroke whole = up_to_its_end(stroke, brush);
    const Line whole_line(whole, brush);
    Beginning start = stroke.settings.start ? beginning_named(*stroke.settings.start, stroke.id) : options.start;
    const bool choose = start == Beginning::automatic;
    if (choose) start = best_beginning(stroke, whole, brush, whole_line, step_tolerance);
    if (const std::optional<Dot> dot = dot_of(stroke, brush); dot && start == Beginning::hidden) {
        poses_of(*dot, brush).into(pass);
        result.miss = tracking_error_of(pass, stroke, brush, options.tolerance_mm);
        return result;
    }
    // the plan is simulated before it is handed over; finer steps as long as they help
    if (options.few_poses) step_tolerance = std::min(kStepShare * step_tolerance, kMostStepToleranceMm);
    for (int attempt = 0; attempt < 8; ++attempt, step_tolerance *= 0.4) {
        bool turns = false;
        Pass trial = pass;
        closed_form(whole, brush, whole_line, start, step_tolerance, turns).into(trial);
        if (options.few_poses && thin_out(trial, kThinShare, kSurely * options.tolerance_mm, stroke, brush,
                                          options.tolerance_mm, result.pass, result.miss)) {
            result.miss.has_turn_in_place = turns;
            return result;
        }
        TrackingError miss = tracking_error_of(trial, stroke, brush, options.tolerance_mm);
        miss.has_turn_in_place = turns;
        const bool better = attempt == 0 || miss.largest_mm < 0.95 * result.miss.largest_mm;
        if (better) {
            result.miss = miss;
            pass = trial;
        }
        // rows of the check lie a little off the truth between them; fewer poses need more to spare
        const bool sure = !options.few_poses && miss.largest_mm <= 0.9 * options.tolerance_mm;
        if (sure || ((turns || (options.few_poses && result.miss.within_tolerance)) && !better) ||
            trial.poses_mm.rows() >= Index(kMostSamples))
            break;
    }
    // a line that cannot be followed to the tolerance: as well as with all poses, then, but for a hair
    const bool turns = result.miss.has_turn_in_place;
    const double missed_mm = result.miss.largest_mm, tolerance_mm = options.tolerance_mm;
    const double limit_mm = missed_mm <= tolerance_mm ? tolerance_mm : missed_mm + kHairShare * tolerance_mm;
    if (options.few_poses)
        thin_out(result.pass, 0.5, limit_mm, stroke, brush, options.tolerance_mm, result.pass, result.miss);
    result.miss.has_turn_in_place = turns;
    if (choose && start == Beginning::hidden && !result.miss.within_tolerance) {
        Stroke plain = stroke;
        plain.settings.start.reset();
        CompensateOptions pointed = options;
        pointed.start = Beginning::exposed;
        CompensatedPass other = at_its_tolerance(plain, brush, pointed);
        other.pass.settings = stroke.settings;
        if (other.miss.largest_mm < result.miss.largest_mm) return other;
    }
    return result;
}

}  // namespace

CompensatedPass compensate(const Stroke& stroke, const Brush& brush, const CompensateOptions& options) {
    CompensatedPass result = at_its_tolerance(stroke, brush, options);
    if (options.method != Compensation::closed || !options.few_poses) return result;
    // who goes as far as he may in each move does not always get there in the fewest
    for (const double finer_mm : kFinerTolerancesMm) {
        if (finer_mm >= options.tolerance_mm) continue;
        CompensateOptions finely = options;
        finely.tolerance_mm = finer_mm;
        CompensatedPass finer = at_its_tolerance(stroke, brush, finely);
        if (finer.pass.poses_mm.rows() >= result.pass.poses_mm.rows() ||
            finer.miss.largest_mm > std::max(options.tolerance_mm, result.miss.largest_mm))
            continue;
        finer.miss.within_tolerance = finer.miss.largest_mm <= options.tolerance_mm;
        result = finer;
    }
    return result;
}

}  // namespace brushsvg
