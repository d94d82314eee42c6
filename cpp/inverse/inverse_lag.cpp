#include "inverse/inverse_lag.hpp"

#include <algorithm>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg {

using Eigen::Vector2d;

InverseLag::InverseLag(const Line& line, const Brush& brush) : line_(line), brush_(brush) {
    const auto [lo, hi] = brush.depth_range_mm;
    const auto e = difference(brush.tip_to_widest, brush.tip_gap, lo, hi);
    ahead_ = make_law(e);
    behind_ = make_law(e, -1.0);
    for (const PolynomialPiece& piece : e)
        for (double root : real_roots(piece.coefficients, piece.lo, piece.hi))
            if (root > lo && root < hi) crossings_.push_back(root);
}

void InverseLag::operator()(Samples& samples, const std::optional<Vector2d>& first) const {
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

int InverseLag::sign_of(const Samples& samples, std::size_t i) const {
    if (ahead_.rigid) return 0;
    const double e = brush_.lever_to_widest(0.5 * (samples[i].depth + samples[i + 1].depth));
    return e > 0.0 ? 1 : e < 0.0 ? -1 : 0;
}

void InverseLag::follow_tangent(Samples& samples, std::size_t begin, std::size_t end) const {
    for (std::size_t i = begin; i <= end; ++i) {
        samples[i].heading = line_.tangent(samples[i]);
        samples[i].contact = samples[i].middle;
    }
}

void InverseLag::forwards(Samples& samples, std::size_t begin, std::size_t end, const Vector2d& heading) const {
    LagState<double> state;
    state.heading = heading;
    start(samples, begin, ahead_, 1.0, state);
    for (std::size_t i = begin + 1; i <= end; ++i) step(samples, i - 1, i, ahead_, 1.0, state);
}

void InverseLag::backwards(Samples& samples, std::size_t begin, std::size_t end) const {
    LagState<double> state;
    state.heading = -line_.tangent(samples[end]);
    start(samples, end, behind_, -1.0, state);
    for (std::size_t i = end; i > begin; --i) step(samples, i, i - 1, behind_, -1.0, state);
}

void InverseLag::start(Samples& samples, std::size_t i, const LagLaw<double>& law, double sign,
                       LagState<double>& state) const {
    state.taut = state.heading_known = true;
    state.contact = samples[i].middle - std::max(0.0, law.at(samples[i].depth)) * state.heading;
    store(samples[i], sign, state);
}

void InverseLag::step(Samples& samples, std::size_t from, std::size_t to, const LagLaw<double>& law, double sign,
                      LagState<double>& state) const {
    checkpoint();
    advance(law, Move<double>(samples[from].middle, samples[to].middle, samples[from].depth, samples[to].depth), state);
    store(samples[to], sign, state);
}

void InverseLag::store(Sample& sample, double sign, const LagState<double>& state) {
    sample.contact = state.contact;
    sample.heading = sign * state.heading;
    sample.taut = state.taut;
}

}  // namespace brushsvg
