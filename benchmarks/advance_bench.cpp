// ns per 0.5 mm move with the loose rule, next to the arithmetic it cannot do without and the law written with
// trigonometry, in one run. Prints medians of repeated rounds and their ratios.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "brushsvg/lag.hpp"

using namespace brushsvg;
using V = Eigen::Vector2d;

namespace {

constexpr int kMoves = 100000, kRounds = 61;

struct Path {
    std::vector<V> q;
    std::vector<double> depth;
};

/// A long wandering line of 0.5 mm moves; depth slowly up and down between 2 and 8 mm.
Path wander() {
    std::mt19937 random(3);
    std::normal_distribution<double> turn(0.0, 0.05);
    Path path;
    V q(0, 0);
    double heading = 0.0;
    for (int i = 0; i <= kMoves; ++i) {
        path.q.push_back(q);
        path.depth.push_back(5.0 + 3.0 * std::sin(i * 0.02));
        heading += turn(random);
        q += 0.5 * V(std::cos(heading), std::sin(heading));
    }
    return path;
}

double sink = 0.0;

template <class Work>
double ns_per_move(Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    sink += work();
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count() / kMoves;
}

double median(std::vector<double> x) {
    std::nth_element(x.begin(), x.begin() + x.size() / 2, x.end());
    return x[x.size() / 2];
}

}  // namespace

int main() {
    const Path path = wander();
    const std::vector<double> r{3.1, 0.86, 0.31, -0.05, 0.0021};
    const LagLaw<double> law = make_law({{0.0, 10.0, r}});

    const auto ours = [&] {
        LagState<double> state = touch_down<double>(path.q[0]);
        for (int i = 0; i < kMoves; ++i)
            advance(law, Move<double>(path.q[i], path.q[i + 1], path.depth[i], path.depth[i + 1]), state);
        return state.contact.x();
    };
    // equation (7) as printed, 5-node quadrature, no loose rule
    const auto trigonometry = [&] {
        static constexpr double x[5] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                                        0.9061798459386640};
        static constexpr double w[5] = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444, 0.2393143352496832,
                                        0.1184634425280945};
        const auto lag = [&](double d) { return r[0] + d * (r[1] + d * (r[2] + d * (r[3] + d * r[4]))); };
        double theta = 0.0, sum = 0.0;
        for (int i = 0; i < kMoves; ++i) {
            const V step = path.q[i + 1] - path.q[i];
            const double phi = std::atan2(step.y(), step.x()), middle = 0.5 * (path.depth[i] + path.depth[i + 1]),
                         half = 0.5 * (path.depth[i + 1] - path.depth[i]);
            double mean = 0.0;
            for (int k = 0; k < 5; ++k) mean += w[k] / lag(middle + half * x[k]);
            theta = phi + 2.0 * std::atan(std::tan(0.5 * (theta - phi)) * std::exp(-step.norm() * mean));
            sum +=
                path.q[i + 1].x() - lag(path.depth[i + 1]) * std::cos(theta) - lag(path.depth[i + 1]) * std::sin(theta);
        }
        return sum;
    };
    // what no closed form can do without: one exp, one sqrt, one division, each needing the one before
    const auto floor = [&] {
        double x = 1.0;
        for (int i = 0; i < kMoves; ++i) x = std::exp(-std::sqrt(path.depth[i])) / (1.0 + path.depth[i + 1]) + 1e-9 * x;
        return x;
    };

    // in turn, so that a machine that slows down slows all three, and ratios within a round hold
    std::vector<double> a, b, c, to_floor, to_peer;
    for (int round = 0; round < kRounds; ++round) {
        a.push_back(ns_per_move(ours));
        b.push_back(ns_per_move(trigonometry));
        c.push_back(ns_per_move(floor));
        to_floor.push_back(a.back() / c.back());
        to_peer.push_back(b.back() / a.back());
    }
    std::printf("advancing the brush, 0.5 mm moves, quartic lag, linear depth, %d moves, median of %d rounds\n", kMoves,
                kRounds);
    std::printf("  %-52s %7.1f ns/move\n", "closed form, vector form, with the loose rule", median(a));
    std::printf("  %-52s %7.1f ns/move  (%.1f x ours)\n", "peer: article (7) with trigonometry, no loose rule",
                median(b), median(to_peer));
    std::printf("  %-52s %7.1f ns/move\n", "floor: exp + sqrt + division", median(c));
    std::printf("  ours / floor: %.1f (aim: at most 8)\n", median(to_floor));
    return sink == 42.0;
}
