#include "brushsvg/checkpoint.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "base/parallel.hpp"
#include "base/run_cancellable.hpp"
#include "brushsvg/compensate.hpp"
#include "brushsvg/medial_axis.hpp"
#include "brushsvg/region.hpp"
#include "round6.hpp"

using namespace brushsvg;

namespace {

/// Call checkpoint() once per ms. Each call reports so much work that it calls `is_over` if the pause of 50 ms is over.
void work_for(int rounds) {
    for (int i = 0; i < rounds; ++i) {
        checkpoint(1000);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

}  // namespace

TEST_CASE("work continues if no cancellation question is set") { CHECK_NOTHROW(work_for(100)); }

TEST_CASE("work is cancelled on request, and not before") {
    int asked = 0;
    {
        const CancelWhen third([&] { return ++asked == 3; });
        CHECK_THROWS_AS(work_for(100000), Cancelled);
        CHECK_THROWS_AS(work_for(1), Cancelled);  // stays cancelled
    }
    CHECK(asked == 3);
    CHECK_NOTHROW(work_for(1));
}

TEST_CASE("an exception of the cancellation question ends the work") {
    const CancelWhen fails([]() -> bool { throw std::logic_error("no"); });
    CHECK_THROWS_AS(work_for(100000), std::logic_error);
}

TEST_CASE("the innermost cancellation question is used, then the one before it") {
    const CancelWhen outer([] { return true; });
    {
        const CancelWhen inner([] { return false; });
        CHECK_NOTHROW(work_for(200));
    }
    CHECK_THROWS_AS(work_for(100000), Cancelled);
}

TEST_CASE("worker threads end with the main thread, and only the main thread is polled") {
    const auto here = std::this_thread::get_id();
    int asked = 0;
    const CancelWhen second([&] {
        CHECK(std::this_thread::get_id() == here);
        return ++asked == 2;
    });
    CHECK_THROWS_AS(parallel_for(0, 64, [](std::size_t) { work_for(100000); }), Cancelled);
}

TEST_CASE("the work on a single stroke can be cancelled") {
    // a wave of 20 m, which needs seconds of work
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < 20000; ++i) points.emplace_back(0.7 * i, (i % 2) * 0.7 + 100.0);
    const Stroke stroke = stroke_of(polyline(points), {{0.0, 0.5}, {1.0, 1.5}});
    const Brush brush = shipped("round-6");
    int asked = 0;
    const CancelWhen first([&] { return ++asked == 1; });
    CHECK_THROWS_AS(compensate(stroke, brush), Cancelled);
}

TEST_CASE("work without checkpoints can be cancelled from outside, and ends at its next checkpoint") {
    std::atomic<bool> goes_on{true}, ended{false};
    const auto here = std::this_thread::get_id();
    int asked = 0;
    {
        const CancelWhen second([&] {
            CHECK(std::this_thread::get_id() == here);
            return ++asked == 2;
        });
        CHECK_THROWS_AS(run_cancellable([&]() -> int {
                            while (goes_on) std::this_thread::yield();
                            try {
                                work_for(100000);
                            } catch (const Cancelled&) {
                                ended = true;
                            }
                            return 0;
                        }),
                        Cancelled);
    }
    goes_on = false;
    while (!ended) std::this_thread::yield();
    CHECK(asked == 2);
    CHECK(run_cancellable([] { return 7; }) == 7);
    CHECK_THROWS_AS(run_cancellable([]() -> int { throw std::logic_error("no"); }), std::logic_error);
}

TEST_CASE("unions of large rings and the axis of a large shape can be cancelled") {
    Rings rings(2, Ring(40000, 2));
    for (Eigen::Index i = 0; i < 40000; ++i) {
        const double turn = 2.0 * M_PI * double(i) / 40000.0, radius = 80.0 + 0.01 * double((i * 7919) % 13);
        rings[0].row(i) << radius * std::cos(turn), radius * std::sin(turn);
        rings[1].row(i) << 10.0 + radius * std::cos(turn), radius * std::sin(turn);
    }
    const auto is_given_up = [&](auto work) {
        int asked = 0;
        const CancelWhen first([&] { return ++asked == 1; });
        CHECK_THROWS_AS(work(), Cancelled);
        return asked == 1;
    };
    CHECK(is_given_up([&] { unite(rings); }));
    CHECK(is_given_up([&] { fill(rings, FillRule::nonzero); }));
    CHECK(is_given_up([&] { fill(rings, FillRule::evenodd); }));
    CHECK(is_given_up([&] { intersect({rings[0]}, {rings[1]}); }));
    CHECK(is_given_up([&] { overlap({rings[0]}, {rings[1]}); }));
    CHECK(is_given_up([&] { medial_axis({rings[0]}, 0.1); }));
}
