#include "closed_form.hpp"

#include <cmath>
#include <optional>

#include "brushsvg/lag_arc.hpp"
#include "dot.hpp"
#include "hidden_beginning.hpp"
#include "inverse_lag.hpp"
#include "landing.hpp"
#include "stroke_ends.hpp"
#include "turned_beginning.hpp"

namespace brushsvg {
namespace {

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

/// Along the samples, from where the brush is taut at the first.
void lead(const Samples& samples, const Brush& brush, PoseList& out, bool& turns) {
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
}

}  // namespace

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

PoseList closed_form(const Stroke& stroke, const Brush& brush, const Line& line, Beginning start, double step_tolerance,
                     bool& turns, std::optional<double> turned_depth_mm) {
    auto [s0, s1] = painted_stretch(stroke, brush, line.length());
    const InverseLag drawn(line, brush);
    std::optional<HiddenBeginning> hidden;
    if (start == Beginning::hidden) hidden = hidden_beginning(stroke, brush, line, drawn, s1, step_tolerance);
    std::optional<TurnedBeginning> turned;
    if (start == Beginning::turned || (start == Beginning::hidden && !hidden))
        turned = turned_beginning(stroke, brush, step_tolerance);
    std::optional<Vector2d> first;
    if (hidden) {
        s0 = hidden->on_from_mm;
        first = hidden->on_along;
    } else if (turned) {
        s0 = turned->on_from_mm;
        first = turned->on_along;
    }
    const Stroke& painted = hidden ? hidden->onward : turned ? turned->onward : stroke;
    const Line onward(painted, brush);
    std::optional<InverseLag> led_anew;
    if (onward.length() != line.length()) led_anew.emplace(onward, brush);  // amid a cap
    const InverseLag& inverse = led_anew ? *led_anew : drawn;
    s1 += onward.length() - line.length();
    Samples samples;
    if (line.length() > 0.0 && s1 - s0 > 1e-6)
        samples = onward.coarse(s0, s1, places_of_depths(painted, brush, onward.length(), inverse.crossings()));
    if (samples.size() < 2) {
        hidden.reset();
        turned.reset();
        turned_depth_mm.reset();
        samples = dab(stroke, line);
        drawn(samples);
    } else {
        refine_steps(onward, samples, step_tolerance, [&](Samples& all) { inverse(all, first); });
    }
    PoseList out;
    if (hidden) {
        land(stance_of(hidden->back.front()), brush, out);
        for (const Sample& sample : hidden->back) out.add(sample.tcp, sample.depth);
        turn_over(stance_of(hidden->back.back()), stance_of(samples.front()), brush, out);
    } else if (turned) {
        const Vector2d heading = turn(*turned, brush, out);
        turn_over({turned->at_mm, heading, turned->depth_mm}, stance_of(samples.front()), brush, out);
    } else {
        land(stance_of(samples.front()), brush, out);
    }
    lead(samples, brush, out, turns);
    const Stance last = stance_of(samples.back());
    lift(turned_depth_mm ? turn_round_ahead(last, *turned_depth_mm, brush, out) : last, brush, out);
    return out;
}

PoseList closed_form(const SquaredDot& dot, const Brush& brush, double step_tolerance, bool& turns) {
    const Line line(dot.way, brush);
    const InverseLag inverse(line, brush);
    Samples samples = line.coarse(dot.on_from_mm, line.length(), {});
    refine_steps(line, samples, step_tolerance, [&](Samples& all) { inverse(all, dot.on_along); });
    PoseList out;
    const Stance turned = turn(dot.dot, brush, out);
    turn_over(turned, stance_of(samples.front()), brush, out);
    lead(samples, brush, out, turns);
    lift(stance_of(samples.back()), brush, out);
    return out;
}

}  // namespace brushsvg
