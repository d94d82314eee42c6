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
#include "brushsvg/lag.hpp"
#include "brushsvg/lag_arc.hpp"
#include "brushsvg/mark_overlap.hpp"
#include "brushsvg/simulate.hpp"
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

/// q = m + (r - e) u with P dragged by m on the lever e (article's law read backwards).
class Inverse {
 public:
    Inverse(const Line& line, const Brush& brush) : line_(line), brush_(brush) {
        const auto [lo, hi] = brush.depth_range_mm;
        const auto e = difference(brush.tip_to_widest, brush.tip_gap, lo, hi);
        ahead_ = make_law(e);
        behind_ = make_law(e, -1.0);
        for (const PolynomialPiece& piece : e)
            for (double root : real_roots(piece.coefficients, piece.lo, piece.hi))
                if (root > lo && root < hi) crossings_.push_back(root);
    }
    /// Depths where the widest section stands over the centre of friction.
    const std::vector<double>& crossings() const { return crossings_; }

    /// `first`: the heading at the first sample; none: along the line.
    void operator()(Samples& samples, const std::optional<Vector2d>& first = {}) const {
        std::size_t begin = 0;
        while (begin + 1 < samples.size()) {
            const int sign = sign_of(samples, begin);
            std::size_t end = begin + 1;
            while (end + 1 < samples.size() && sign_of(samples, end) == sign) ++end;
            if (sign == 0)
                follow_tangent(samples, begin, end);
            else if (sign > 0)
                forwards(samples, begin, end, begin == 0 && first ? *first : line_.tangent(samples[begin]));
            else
                backwards(samples, begin, end);
            begin = end;
        }
        if (samples.size() == 1) {
            Sample& only = samples[0];
            only.contact = only.middle - brush_.lever_to_widest(only.depth) * only.heading;
        }
        for (Sample& sample : samples) sample.tcp = sample.contact + brush_.lag(sample.depth) * sample.heading;
    }

 private:
    int sign_of(const Samples& samples, std::size_t i) const {
        if (ahead_.rigid) return 0;
        const double e = brush_.lever_to_widest(0.5 * (samples[i].depth + samples[i + 1].depth));
        return e > 0.0 ? 1 : e < 0.0 ? -1 : 0;
    }
    void follow_tangent(Samples& samples, std::size_t begin, std::size_t end) const {
        for (std::size_t i = begin; i <= end; ++i) {
            samples[i].heading = line_.tangent(samples[i]);
            samples[i].contact = samples[i].middle;
        }
    }
    /// The widest section leads: the forward law with lever e, from the stretch's beginning.
    void forwards(Samples& samples, std::size_t begin, std::size_t end, const Vector2d& heading) const {
        LagState<double> state;
        state.heading = heading;
        start(samples, begin, ahead_, 1.0, state);
        for (std::size_t i = begin + 1; i <= end; ++i) step(samples, i - 1, i, ahead_, 1.0, state);
    }
    /// The widest section trails: unstable forwards, stable from the stretch's end to its beginning.
    void backwards(Samples& samples, std::size_t begin, std::size_t end) const {
        LagState<double> state;
        state.heading = -line_.tangent(samples[end]);
        start(samples, end, behind_, -1.0, state);
        for (std::size_t i = end; i > begin; --i) step(samples, i, i - 1, behind_, -1.0, state);
    }
    void start(Samples& samples, std::size_t i, const LagLaw<double>& law, double sign, LagState<double>& state) const {
        state.taut = state.heading_known = true;
        state.contact = samples[i].middle - std::max(0.0, law.at(samples[i].depth)) * state.heading;
        store(samples[i], sign, state);
    }
    void step(Samples& samples, std::size_t from, std::size_t to, const LagLaw<double>& law, double sign,
              LagState<double>& state) const {
        checkpoint();
        advance(law, Move<double>(samples[from].middle, samples[to].middle, samples[from].depth, samples[to].depth),
                state);
        store(samples[to], sign, state);
    }
    static void store(Sample& sample, double sign, const LagState<double>& state) {
        sample.contact = state.contact;
        sample.heading = sign * state.heading;
        sample.taut = state.taut;
    }

    const Line& line_;
    const Brush& brush_;
    LagLaw<double> ahead_, behind_;
    std::vector<double> crossings_;
};

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

/// Steps of the way back at a hidden beginning, a few times as long as the widest section's lever.
constexpr int kStepsBack = 12;
/// Shorter ways back that are tried where the whole one has no room.
constexpr int kShorter = 4;
constexpr int kHalvings = 30;  // of a few mm: to rounding
/// Of the front of a footprint, what is wide enough to hide a pointed rear.
constexpr double kHidingShare = 0.8;
constexpr double kWithinReach = 0.999;
constexpr double kStraightBack = 0.5;  // cosine
/// Steps of the depth and of the way in which the mark is narrowed for that, as shares of the whole.
constexpr double kNarrowingDepths = 1.0 / 64.0, kNarrowingWay = 1.0 / 12.0;

/// A hidden beginning: the brush is set down heading back along the line, and drawn back until the round front of its
/// footprint reaches the drawn beginning. There it turns over, and P rests, so it goes on where the widest section is
/// as far in front of P as it was behind.
struct HiddenBeginning {
    Samples back;
    Stroke onward;             ///< the stroke whose mark begins as narrow as the front hides it
    double on_from_mm;         ///< arc length where the widest section goes on
    Eigen::Vector2d on_along;  ///< and the heading there
};

/// Whether the pointed rear of a footprint that is set down heading back along the line stays inside the stroke: each
/// place on its axis is nearer to the line than it is to the edge, there where the rear is so narrow. And whether the
/// way back goes round no corner: P would be dragged past it.
bool lies_inside(const Stroke& stroke, const Brush& brush, const Line& line, double widest_mm) {
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

/// Arc length from which on the rear of a footprint as wide as the stroke lies behind `from_mm`, and the stroke
/// narrowed up to there so that narrower ones do too. None where no depth does.
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

/// None where the brush cannot hide: too thin a mark, whose widest section trails P, or too short a stroke.
std::optional<HiddenBeginning> hidden_beginning(const Stroke& stroke, const Brush& brush, const Line& line,
                                                const Inverse& inverse, double last_mm, double step_tolerance) {
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
    for (int tries = 0; from_mm > last_mm || !lies_inside(stroke, brush, line, std::max(from_mm, 0.0)); ++tries) {
        if (tries == kShorter) return {};
        from_mm -= way_mm / kShorter;
    }

    HiddenBeginning found{{}, onward->second, 0.0, {}};
    for (int i = 0; i <= kStepsBack; ++i) {
        const double s = from_mm + (turn_mm - from_mm) * i / kStepsBack;
        Sample sample = line.at(std::max(s, 0.0));
        if (!(lever(stroke, s) > 0.0)) return {};
        if (s < 0.0) sample.middle += s * line.tangent(sample);  // a blunt front reaches less far than round caps do
        found.back.push_back(sample);
    }
    inverse(found.back, -line.tangent(found.back.front()));
    const Vector2d contact = found.back.back().contact;
    // as few steps as the tolerance asks for: nobody thins them out
    Samples few{found.back.front()};
    for (std::size_t i = 1, from = 0; i + 1 < found.back.size(); ++i)
        for (std::size_t k = from + 1; k <= i; ++k)
            if (off_chord(found.back[from], found.back[i + 1], found.back[k]) > step_tolerance) {
                few.push_back(found.back[i]);
                from = i;
            }
    few.push_back(found.back.back());
    found.back = few;
    const auto beyond = [&](double s) { return (line.at(s).middle - contact).norm() - lever(found.onward, s); };
    double a = std::max(0.0, turn_mm + e), b = std::min(turn_mm + 4.0 * e, last_mm);
    if (!(a < b) || beyond(a) > 0.0 || !(beyond(b) > 0.0)) return {};
    for (int i = 0; i < kHalvings; ++i) {
        const double s = 0.5 * (a + b);
        (beyond(s) > 0.0 ? b : a) = s;
    }
    found.on_from_mm = b;
    found.on_along = (line.at(b).middle - contact).normalized();
    return found;
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
    if (!hidden_beginning(stroke, brush, line, Inverse(line, brush), last_mm, step_tolerance))
        return Beginning::exposed;
    bool turns = false;
    Pass exposed, hidden;
    closed_form(stroke, brush, line, Beginning::exposed, step_tolerance, turns).into(exposed);
    closed_form(stroke, brush, line, Beginning::hidden, step_tolerance, turns).into(hidden);
    const double depth = depth_of(stroke, brush, 0.0), half = brush.half_width(depth);
    const Vector2d at = line.at(0.0).middle;
    const double side = 2.0 * kLookedAt * half, made = kMade * half + 4.0 * brush.lag(depth);
    const Window window{at.x() - 0.5 * side, at.y() - 0.5 * side, side, side};
    const Coverage wanted = wanted_coverage({wanted_stroke}, window, kPixels / half);
    const auto mark = [&](const Pass& pass) {
        Marks marks;
        marks.passes = {simulate(beginning_of(pass, made), brush, 0.05 * half)};
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

CompensatedPass compensate(const Stroke& stroke, const Brush& brush, const CompensateOptions& options) {
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
    // the plan is simulated before it is handed over; finer steps as long as they help
    if (options.few_poses) step_tolerance *= kStepShare;
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
        CompensatedPass other = compensate(plain, brush, pointed);
        other.pass.settings = stroke.settings;
        if (other.miss.largest_mm < result.miss.largest_mm) return other;
    }
    return result;
}

}  // namespace brushsvg
