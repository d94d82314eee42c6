#include "inverse/closed_form.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "brushsvg/lag_arc.hpp"
#include "inverse/inverse_lag.hpp"
#include "inverse/landing.hpp"

namespace brushsvg {
namespace {

using Eigen::Vector2d;

/// Turn in place along chords of the circle about the contact, from one heading to another. Inscribed chords leave the
/// lever loose, so the patch rests; tangent chords would drag the patch. The caller notes the poses as an arc of
/// exactly radius r. A radius that is too large by a rounding error lets the patch creep by (1 + turn^2 / 2) times that
/// error: 0.6 um for 1e-4 mm and half a turn.
void turn_in_place(const Sample& from, const Sample& to, const Brush& brush, PoseList& out) {
    const double angle = angle_between(from.heading, to.heading);
    const int n = int(std::ceil(std::abs(angle) / kMaxTurnChordRad));
    for (int k = 1; k < n; ++k) {
        const double c = double(k) / n, depth = from.depth + c * (to.depth - from.depth);
        out.add(from.contact + brush.lag(depth) * rotated<double>(from.heading, c * angle), depth);
    }
}

/// Return the sample for a mark no longer than a footprint: one landing that leaves the widest section at the path's
/// end.
Samples make_dab_sample(const Stroke& stroke, const Line& line) {
    Sample sample = line.at(line.length());
    const Vector2d across =
        point_at(stroke.middle_mm, {stroke.middle_mm.rows() - 1, 1.0}) - point_at(stroke.middle_mm, {0, 0.0});
    // a point has no direction: use left to right, as in writing
    sample.heading = line.length() > 0.0 ? line.tangent(sample) : Vector2d(1.0, 0.0);
    if (across.norm() > 0.5 * line.length() && line.length() > 0.0) sample.heading = across.normalized();
    return {sample};
}

Stance to_stance(const Sample& sample) { return {sample.contact, sample.heading, sample.depth}; }

/// Follow the samples, from where the brush is taut at the first one.
void append_samples(const Samples& samples, const Brush& brush, PoseList& out, bool& turns) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
        turns = turns || !samples[i].taut;
        if (i > 0 && !brush.is_rigid()) {
            const double moved = (samples[i].contact - samples[i - 1].contact).norm();
            const double angle = angle_between(samples[i - 1].heading, samples[i].heading);
            const std::int64_t before = out.last();
            if (std::abs(angle) > kMaxTurnStepRad && moved < 0.1 * brush.lag(samples[i].depth))
                turn_in_place(samples[i - 1], samples[i], brush, out);
            out.add(samples[i].tcp, samples[i].depth);
            if (moved < kCircleToleranceMm) out.arc(before, samples[i].contact, angle);
        } else {
            out.add(samples[i].tcp, samples[i].depth);
        }
    }
}

/// Turn the brush round on the spot. The turn starts from the heading of the move before it, or ends in the heading of
/// the move after it.
void turn_round(const TurnRound& turn, const Samples& then, std::optional<Stance>& now, const Brush& brush,
                PoseList& out) {
    const Vector2d heading = now ? now->heading : then.empty() ? turn.ends_heading : then.front().heading;
    const double first_rad = std::atan2(heading.y(), heading.x()) - (now ? 0.0 : kFullTurnRad);
    const double reach_mm = brush.lag(turn.depth_mm);
    const auto direction = [&](double angle) { return Vector2d(std::cos(angle), std::sin(angle)); };
    if (now)
        out.add(turn.at_mm + reach_mm * direction(first_rad), turn.depth_mm);
    else
        land({turn.at_mm, direction(first_rad), turn.depth_mm}, brush, out);
    const int n = int(std::ceil(kFullTurnRad / kMaxTurnChordRad));
    const std::int64_t before = out.last();
    for (int k = 1; k <= n; ++k)
        out.add(turn.at_mm + reach_mm * direction(first_rad + kFullTurnRad * k / n), turn.depth_mm);
    out.arc(before, turn.at_mm, kFullTurnRad);
    now = Stance{turn.at_mm, direction(first_rad + kFullTurnRad), turn.depth_mm};
}

/// Return the arc length where the distance of the widest section from the resting P equals its lever. None if there is
/// no such place.
std::optional<double> find_continuation_mm(const BrushMove& move, const Brush& brush, const Line& line,
                                           const Vector2d& resting_contact) {
    const auto is_beyond = [&](double s) {
        return (line.at(s).middle - resting_contact).norm() >
               brush.lever_to_widest(depth_of(*move.line, brush, std::clamp(s / line.length(), 0.0, 1.0)));
    };
    if (!(move.from_mm < move.latest_mm) || is_beyond(move.from_mm) || !is_beyond(move.latest_mm)) return {};
    return bisect(move.from_mm, move.latest_mm, is_beyond);
}

/// Return the samples of the brush along a move's line, continuing from where P rests. Empty if it cannot continue.
Samples sample_along_line(const BrushMove& move, const Brush& brush, const std::optional<Vector2d>& resting_contact,
                          double step_tolerance) {
    const Line line(*move.line, brush);
    const InverseLag inverse(line, brush);
    std::optional<double> from_mm = move.from_mm;
    std::optional<Vector2d> first;
    if (resting_contact) {
        from_mm = find_continuation_mm(move, brush, line, *resting_contact);
        if (!from_mm) return {};
        first = (line.at(*from_mm).middle - *resting_contact).normalized();
    }
    Samples samples;
    if (line.length() > 0.0 && move.to_mm - *from_mm > 1e-6)
        samples = line.coarse_samples(*from_mm, move.to_mm,
                                      find_depth_places(*move.line, brush, line.length(), inverse.crossings()));
    if (samples.size() < 2) {
        if (resting_contact) return {};
        samples = make_dab_sample(*move.line, line);
        inverse(samples);
        return samples;
    }
    refine_steps(line, samples, step_tolerance, [&](Samples& all) { inverse(all, first); });
    return samples;
}

}  // namespace

std::vector<double> find_depth_places(const Stroke& stroke, const Brush& brush, double length,
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

std::optional<PoseList> closed_form(const BrushMoves& moves, const Brush& brush, double step_tolerance, bool& turns) {
    PoseList out;
    std::optional<Stance> now;
    for (const BrushMove& move : moves) {
        Samples samples;
        if (move.line) {
            std::optional<Vector2d> resting_contact;
            if (move.turn || now) resting_contact = move.turn ? move.turn->at_mm : now->contact_mm;
            samples = sample_along_line(move, brush, resting_contact, step_tolerance);
            if (samples.empty()) return {};
        }
        if (move.turn) turn_round(*move.turn, samples, now, brush, out);
        if (!move.line) continue;
        const bool is_dab = samples.size() == 1;
        if (now)
            turn_over(*now, to_stance(samples.front()), brush, out);
        else
            land(to_stance(samples.front()), brush, out);
        append_samples(samples, brush, out, turns);
        now = to_stance(samples.back());
        if (is_dab) break;
    }
    lift(*now, brush, out);
    return out;
}

}  // namespace brushsvg
