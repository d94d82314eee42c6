#include "track_fit.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "brushsvg/error.hpp"
#include "refusal.hpp"
#include "trace.hpp"

using namespace brushsvg;
using namespace brushsvg::fit;

namespace {

const std::vector<double> kLag{3.1, 0.86, 0.31, -0.05, 0.0021};

/// A wandering line with corners beyond 90 degrees, seen at every half pose; where the patch went from the simulator.
Track wander(int seed, bool set_down) {
    Track track;
    track.poses_mm.resize(25, 3);
    double heading = seed;
    Eigen::Vector2d q(3.0 * seed, 1.0);
    for (Eigen::Index i = 0; i < 25; ++i) {
        const double depth = set_down && i == 0 ? 0.0 : 4.0 + 3.0 * std::sin(0.5 * double(i) + seed);
        track.poses_mm.row(i) << q.x(), q.y(), -depth;
        heading += i % 7 == 5 ? 2.5 : 0.3 * std::sin(double(i * seed));
        q += 2.0 * Eigen::Vector2d(std::cos(heading), std::sin(heading));
    }
    for (int k = 1; k <= 48; ++k) track.pose.push_back(0.5 * k);
    track.seen_mm.resize(48, 2);
    if (!set_down) track.heading_rad = seed + 0.4;
    const LagLaw<double> law = law_of(kLag, 0.0, 10.0);
    LagState<double> begun;
    if (!set_down) {
        begun.heading = {std::cos(track.heading_rad), std::sin(track.heading_rad)};
        begun.contact = track.poses_mm.row(0).head<2>().transpose() - law.at(-track.poses_mm(0, 2)) * begun.heading;
        begun.taut = begun.heading_known = true;
    }
    const std::vector<Arc> arcs;
    const CommandedWay<double> way{track.poses_mm, arcs, 0.0};
    trace(law, way, track.pose, set_down ? nullptr : &begun,
          [&](std::size_t k, const Trace<double>& at) { track.seen_mm.row(k) = at.state.contact.transpose(); });
    return track;
}

}  // namespace

TEST_CASE("exact tracks give the lag that made them, through landings, corners and rests") {
    std::vector<Track> tracks;
    for (int seed = 1; seed <= 8; ++seed) tracks.push_back(wander(seed, seed % 2 == 0));
    const TrackFit fit = fit_tracks(tracks, {5.0, 0.5, 0.0, 0.0, 0.0}, {});
    CHECK(fit.converged);
    for (double d = 1.0; d < 7.1; d += 0.5)
        CHECK(fit.lag(d) ==
              doctest::Approx(kLag[0] + d * (kLag[1] + d * (kLag[2] + d * (kLag[3] + d * kLag[4])))).epsilon(1e-5));
}

TEST_CASE("a free heading and a displacement are found along with the lag") {
    std::vector<Track> tracks;
    for (int seed = 1; seed <= 8; ++seed) {
        tracks.push_back(wander(seed, false));
        tracks.back().seen_mm.rowwise() += Eigen::RowVector2d(0.3 * seed, -1.0);
        tracks.back().heading_rad += 0.2;
    }
    TrackOptions options;
    options.free_heading = true;
    options.displaced = Displaced::both;
    const TrackFit fit = fit_tracks(tracks, {5.0, 0.5, 0.0, 0.0, 0.0}, options);
    CHECK(fit.lag(4.0) == doctest::Approx(8.8376).epsilon(1e-4));
    CHECK(fit.heading_rad[2] == doctest::Approx(3.4).epsilon(1e-4));
    CHECK(fit.displacement_mm(2, 0) == doctest::Approx(0.9).epsilon(1e-4));
    CHECK(fit.displacement_mm(2, 1) == doctest::Approx(-1.0).epsilon(1e-4));
}

TEST_CASE("strokes that leave the lag open are refused, and so is nonsense") {
    Track straight;
    straight.poses_mm.resize(2, 3);
    straight.poses_mm << 0, 0, -3, 30, 0, -3;
    straight.heading_rad = 0.0;
    straight.pose = {0.5, 1.0};
    straight.seen_mm.resize(2, 2);
    straight.seen_mm << 8, 0, 23, 0;
    CHECK(fit_tracks({straight}, {5.0}, {}).lag(3.0) == doctest::Approx(7.0));
    CHECK(agrees(refusal([&] { fit_tracks({straight}, {5.0, 1.0}, {}); }), "law-undetermined", "lag"));
    CHECK_THROWS_AS(fit_tracks({straight}, {-5.0}, {}), Error);
    straight.seen_mm(0, 0) = NAN;
    CHECK_THROWS_AS(fit_tracks({straight}, {5.0}, {}), Error);
    CHECK_THROWS_AS(fit_tracks({}, {5.0}, {}), Error);
}
