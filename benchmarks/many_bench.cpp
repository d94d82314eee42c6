// ns per 0.5 mm move of many strokes at once, next to the floor of moving the bytes and what one stroke after the other
// takes, in one run. Prints medians of repeated rounds and ratios within a round.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "many_strokes.hpp"
#ifdef BRUSHSVG_HIGHWAY
#include <hwy/targets.h>
#endif

using namespace brushsvg;

namespace {

constexpr int kRounds = 21;

/// Wandering lines of 0.5 mm moves; depth slowly up and down between 2 and 8 mm.
ManyWays wander(Eigen::Index lanes, Eigen::Index moves) {
    std::mt19937 random(3);
    std::normal_distribution<double> turn(0.0, 0.05);
    ManyWays ways;
    for (Lanes* numbers : {&ways.x_mm, &ways.y_mm, &ways.depth_mm}) numbers->resize(moves + 1, lanes);
    for (Eigen::Index lane = 0; lane < lanes; ++lane) {
        double x = 0.0, y = 0.0, heading = 0.01 * double(lane);
        for (Eigen::Index i = 0; i <= moves; ++i) {
            ways.x_mm(i, lane) = x;
            ways.y_mm(i, lane) = y;
            ways.depth_mm(i, lane) = 5.0 + 3.0 * std::sin(0.02 * double(i + lane));
            heading += turn(random);
            x += 0.5 * std::cos(heading);
            y += 0.5 * std::sin(heading);
        }
    }
    return ways;
}

double ns(const std::function<void()>& work, Eigen::Index moves) {
    const std::clock_t begin = std::clock();  // of the processor: other work on the machine does not count
    work();
    return 1e9 * double(std::clock() - begin) / CLOCKS_PER_SEC / double(moves);
}

double median(std::vector<double> x) {
    std::nth_element(x.begin(), x.begin() + Eigen::Index(x.size() / 2), x.end());
    return x[x.size() / 2];
}

struct Timed {
    std::string name;
    std::function<void()> work;
    std::vector<double> ns = {}, to_floor = {};
};

void compare(const char* title, const ManyWays& ways, const std::vector<LagLaw<double>>& lags, bool reads) {
    ManyStates out, by_floor;
    follow_many(ways, lags, out);
    by_floor = out;
    const Eigen::Index lanes = out.taut.cols(), rows = out.taut.rows(), moves = (rows - 1) * lanes;

    std::vector<Timed> all;
    all.push_back({"floor: moving the bytes", [&] {
                       const auto size = std::size_t(rows * lanes);
                       const double *x = ways.x_mm.data(), *y = ways.y_mm.data(), *d = ways.depth_mm.data();
                       double *px = by_floor.contact_x_mm.data(), *py = by_floor.contact_y_mm.data(),
                              *ux = by_floor.heading_x.data(), *uy = by_floor.heading_y.data();
                       for (std::size_t k = 0; k < size; ++k) {
                           px[k] = reads ? x[k] : 1.0;
                           py[k] = reads ? y[k] : 2.0;
                           ux[k] = uy[k] = reads ? d[k] : 3.0;
                       }
                       std::memset(by_floor.taut.data(), 1, size);
                   }});
    // of one stroke numbers are next to each other
    const auto alone = [](const Lanes& numbers) { return Lanes(numbers.transpose()); };
    const Lanes x = alone(ways.x_mm), y = alone(ways.y_mm), d = alone(ways.depth_mm);
    Lanes ux = alone(out.heading_x), uy = ux, px = ux, py = ux;
    const auto one_by_one = [&] {
        for (Eigen::Index lane = 0; lane < lanes; ++lane) {
            const Eigen::Index w = ways.x_mm.cols() == 1 ? 0 : lane;
            const LagLaw<double>& law = lags[lags.size() == 1 ? 0 : std::size_t(lane)];
            const auto at = [&](Eigen::Index i) { return Vec2<double>(x(w, i), y(w, i)); };
            auto state = touch_down(at(0));
            advance(law, Move<double>(at(0), at(0), 0.0, d(w, 0)), state);
            for (Eigen::Index i = 1; i < rows; ++i) {
                advance(law, Move<double>(at(i - 1), at(i), d(w, i - 1), d(w, i)), state);
                px(lane, i) = state.contact.x();
                py(lane, i) = state.contact.y();
                ux(lane, i) = state.heading.x();
                uy(lane, i) = state.heading.y();
            }
        }
    };
    all.push_back({"one stroke after the other", one_by_one});
#ifdef BRUSHSVG_HIGHWAY
    hwy::SetSupportedTargetsForTest(0);
    for (const int64_t target : hwy::SupportedAndGeneratedTargets())
        if (target == HWY_AVX3 || target == HWY_AVX2 || target == HWY_SSE4 || target == HWY_NEON)
            all.push_back({std::string("many at once, ") + (target == HWY_AVX3 ? "AVX-512" : hwy::TargetName(target)),
                           [&, target] {
                               hwy::SetSupportedTargetsForTest(target);
                               hwy::GetChosenTarget().Update(target);
                               follow_many(ways, lags, out);
                               hwy::SetSupportedTargetsForTest(0);
                               hwy::GetChosenTarget().Update(hwy::SupportedTargets());
                           }});
#else
    all.push_back({"many at once, built without Highway", [&] { follow_many(ways, lags, out); }});
#endif
    // in turn, so that a machine that slows down slows all of them, and ratios within a round hold
    for (int round = 0; round < kRounds; ++round)
        for (Timed& one : all) {
            one.ns.push_back(ns(one.work, moves));
            one.to_floor.push_back(one.ns.back() / all[0].ns.back());
        }
    std::printf("%s, %ld lanes of %ld moves\n", title, long(lanes), long(rows - 1));
    for (const Timed& one : all)
        std::printf("  %-40s %7.2f ns/move %6.2f x floor\n", one.name.c_str(), median(one.ns), median(one.to_floor));
}

}  // namespace

int main() {
    const std::vector<double> r{3.1, 0.86, 0.31, -0.05, 0.0021};
    const auto law = [&](double share) {
        std::vector<double> c = r;
        for (double& x : c) x *= share;
        return make_law({{0.0, 10.0, c}});
    };
    std::printf("many strokes through the law, 0.5 mm moves, quartic lag, linear depth, median of %d rounds\n",
                kRounds);
    const auto laws = [&](int count) {
        std::vector<LagLaw<double>> out;
        for (int i = 0; i < count; ++i) out.push_back(law(1.0 + 0.0002 * i));
        return out;
    };
    compare("many ways, one lag", wander(64, 16000), {law(1.0)}, true);
    compare("the same, set down more often", wander(1024, 1000), {law(1.0)}, true);
    compare("one way, many lags", wander(1, 16000), laws(64), false);
    compare("one way, few lags", wander(1, 16000), laws(10), false);
}
