#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/stroke.hpp"

namespace brushsvg {

/// Largest turn of the heading between two samples [rad]. It keeps the heading between them close to theirs.
constexpr double kMaxTurnStepRad = 0.2;
/// Largest turn per chord of a turn in place [rad]. The patch rests at any value. With a much larger one the bristles
/// relax half way along the chord, by its cosine.
constexpr double kMaxTurnChordRad = 0.4;
/// Most samples that are added to the initial ones. Where a line needs more (a taper far too steep for the lever),
/// finer steps no longer help. The tracking error is reported then.
constexpr std::size_t kMaxAddedSamples = 20000;

/// Least step of a cubic's parameter between two samples. At a cusp, the lengths of a cubic's parts do not add up to
/// its own length. The difference exceeds the least step, so two samples there would never come close enough, and each
/// round would split the same step.
constexpr double kMinParameterStep = 1e-9;

/// A place on the middle line, and the solution of the inverse there.
struct Sample {
    Place place;
    double s;                ///< arc length from the start [mm]
    Eigen::Vector2d middle;  ///< m
    double depth;
    Eigen::Vector2d contact;  ///< P
    Eigen::Vector2d heading;  ///< u
    Eigen::Vector2d tcp;      ///< q
    bool taut = true;         ///< the lever from P to m is taut; it is loose where the line turns too sharply for it
    bool settled = false;     ///< the chord to the next sample is close enough
};
using Samples = std::vector<Sample>;

/// Return the press depth [mm] at a fraction of the stroke's arc length. Throws an error if the brush cannot paint the
/// width there.
double depth_of(const Stroke& stroke, const Brush& brush, double fraction);

/// Return the signed angle from one direction to another.
double angle_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to);

/// The middle line with its arc length, and the depth along it.
class Line {
 public:
    Line(const Stroke& stroke, const Brush& brush) : stroke_(stroke), brush_(brush) {
        start_.push_back(0.0);
        for (Eigen::Index i = 0; i < stroke.middle_mm.rows(); ++i)
            start_.push_back(start_.back() + arc_length(stroke.middle_mm, i, 0.0, 1.0));
    }
    double length() const { return start_.back(); }

    Sample at(const Place& place, double s) const {
        Sample sample;
        sample.place = place;
        sample.s = s;
        sample.middle = point_at(stroke_.middle_mm, place);
        sample.depth = depth_of(stroke_, brush_, length() > 0.0 ? s / length() : 0.0);
        return sample;
    }
    Sample at(double s) const {
        Eigen::Index i = std::upper_bound(start_.begin(), start_.end(), s) - start_.begin() - 1;
        i = std::clamp<Eigen::Index>(i, 0, stroke_.middle_mm.rows() - 1);
        const double target = s - start_[i], whole = start_[i + 1] - start_[i];
        if (target <= 0.0) return at({i, 0.0}, start_[i]);
        if (target >= whole) return at({i, 1.0}, start_[i + 1]);
        return at({i, parameter_at(stroke_.middle_mm, i, target)}, s);
    }
    Sample between(const Sample& a, const Sample& b, double c) const {
        const Place place{a.place.cubic, a.place.t + c * (b.place.t - a.place.t)};
        return at(place, a.s + arc_length(stroke_.middle_mm, place.cubic, a.place.t, place.t));
    }
    Eigen::Vector2d tangent(const Sample& sample) const { return tangent_at(stroke_.middle_mm, sample.place); }

    /// Return samples at both ends of every cubic and at the given arc lengths, between s0 and s1. Neighbours share a
    /// cubic, or are on the same point where one cubic ends and the next begins.
    Samples coarse_samples(double s0, double s1, std::vector<double> extra) const {
        extra.push_back(s0);
        extra.push_back(s1);
        std::sort(extra.begin(), extra.end());
        Samples samples;
        for (Eigen::Index i = 0; i < stroke_.middle_mm.rows(); ++i) {
            if (start_[i + 1] < s0 || start_[i] > s1 || start_[i + 1] == start_[i]) continue;
            const auto push = [&](const Sample& sample) {
                if (samples.empty() || samples.back().place.cubic != sample.place.cubic ||
                    samples.back().place.t < sample.place.t)
                    samples.push_back(sample);
            };
            if (start_[i] >= s0) push(at({i, 0.0}, start_[i]));
            for (double s : extra) {
                if (!(s > start_[i] && s < start_[i + 1] && s >= s0 && s <= s1)) continue;
                Sample sample = at(s);
                sample.place.cubic = i;
                push(sample);
            }
            if (start_[i + 1] <= s1) push(at({i, 1.0}, start_[i + 1]));
        }
        if (samples.size() > 1 && samples[0].place.cubic != samples[1].place.cubic) samples.erase(samples.begin());
        while (samples.size() > 1 && samples[samples.size() - 2].place.cubic != samples.back().place.cubic)
            samples.pop_back();
        return samples;
    }

 private:
    const Stroke& stroke_;
    const Brush& brush_;
    std::vector<double> start_;
};

/// Return how far a sample's TCP is from the chord between two others [mm]. A difference in depth counts half.
double distance_from_chord(const Sample& a, const Sample& b, const Sample& between);

/// Split the steps along the line until all chords are within `tolerance` of the TCP's path, depth included. Both
/// thirds of a step are checked, because the middle of an S is on its chord. `solve` fills in contact, heading and tcp
/// of all samples.
template <class Solve>
void refine_steps(const Line& line, Samples& samples, double tolerance, Solve&& solve) {
    const double least = std::min(1e-3, 0.1 * tolerance);
    const std::size_t most = samples.size() + kMaxAddedSamples;
    for (bool done = false; !done && samples.size() < most;) {
        Samples finer;
        std::vector<bool> trial;
        done = true;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            finer.push_back(samples[i]);
            trial.push_back(false);
            if (i + 1 == samples.size() || samples[i].settled || samples[i].place.cubic != samples[i + 1].place.cubic)
                continue;
            if (samples[i + 1].s - samples[i].s < least) continue;
            if (samples[i + 1].place.t - samples[i].place.t < kMinParameterStep) continue;
            for (double c : {1.0 / 3.0, 2.0 / 3.0}) {
                finer.push_back(line.between(samples[i], samples[i + 1], c));
                trial.push_back(true);
            }
            done = false;
        }
        checkpoint(int(finer.size()));
        solve(finer);
        samples.clear();
        for (std::size_t i = 0; i < finer.size(); ++i) {
            samples.push_back(finer[i]);
            if (i + 3 >= finer.size() || !trial[i + 1]) continue;
            const Sample &a = finer[i], &b = finer[i + 3];
            bool close = std::abs(angle_between(a.heading, b.heading)) <= kMaxTurnStepRad;
            for (std::size_t k : {i + 1, i + 2}) close = close && distance_from_chord(a, b, finer[k]) <= tolerance;
            if (close) {
                samples.back().settled = true;
            } else {
                samples.push_back(finer[i + 1]);
                samples.push_back(finer[i + 2]);
            }
            i += 2;
        }
    }
}

}  // namespace brushsvg
