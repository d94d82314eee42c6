#include "brushsvg/tracking_error.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "brushsvg/compensate.hpp"
#include "regions/nearest_on_polyline.hpp"
#include "round6.hpp"

using namespace brushsvg;
using V = Eigen::Vector2d;

TEST_CASE("the tracking error of a pass next to its stroke is the distance between them") {
    const Brush brush = shipped("round-6");
    Stroke stroke;
    stroke.id = "s";
    stroke.middle_mm = polyline({V(10, 20), V(110, 20)});  // ends beyond the place to which the lift drags the brush
    stroke.half_width = {{0.0, brush.half_width(4.0)}};
    Pass pass;
    pass.poses_mm.resize(4, 3);
    pass.poses_mm << 20, 20.3, 0, 20, 20.3, -4, 85, 20.3, -4, 85, 20.3, 0;
    const TrackingError error = tracking_error_of(pass, stroke, brush, 0.05);
    CHECK(error.largest_mm == doctest::Approx(0.3).epsilon(1e-6));
    CHECK(error.mean_mm == doctest::Approx(0.3).epsilon(1e-6));
    CHECK_FALSE(error.within_tolerance);
    CHECK(tracking_error_of(pass, stroke, brush, 0.4).within_tolerance);
}

TEST_CASE("the mean error is over the length and not over the rows") {
    const Brush brush = shipped("round-6");
    Stroke stroke;
    stroke.id = "s";
    stroke.middle_mm = polyline({V(20, 20), V(60, 20), V(100, 40)});
    stroke.half_width = {{0.0, brush.half_width(4.0)}};
    Pass pass;
    pass.poses_mm.resize(5, 3);
    pass.poses_mm << 20, 20, 0, 20, 20, -4, 60, 20, -4, 100, 40, -4, 100, 40, 0;
    const TrackingError coarse = tracking_error_of(pass, stroke, brush, 0.2),
                        fine = tracking_error_of(pass, stroke, brush, 1e-4);
    CHECK(fine.mean_mm == doctest::Approx(coarse.mean_mm).epsilon(0.01));
    CHECK(fine.mean_mm > 0.1);
    CHECK(std::abs(fine.at_mm[0] - 60.0) < 5.0);  // the largest error is at the corner
}

TEST_CASE("a rotated line has the same mean error, if a landing leaves the brush taut except for rounding") {
    const Brush brush = shipped("round-6");
    const Stroke along_x = stroke_of(polyline({V(0, 0), V(80, 0)}), {{0.0, 2.5}});
    CompensateOptions options;
    options.method = Compensation::constant;
    const double mean = compensate(along_x, brush, options).tracking_error.mean_mm;
    CHECK(mean < 0.5);
    for (int k = 1; k < 40; ++k) {
        CAPTURE(k);
        const V to(80.0 * std::cos(0.1 * k), 80.0 * std::sin(0.1 * k));
        const Stroke turned = stroke_of(polyline({V(120, 90), V(120, 90) + to}), {{0.0, 2.5}});
        CHECK(compensate(turned, brush, options).tracking_error.mean_mm == doctest::Approx(mean).epsilon(0.02));
    }
}

TEST_CASE("a pass that never pulls the brush taut has no tracking error") {
    const Brush brush = shipped("round-6");
    Stroke stroke;
    stroke.id = "s";
    stroke.middle_mm = polyline({V(0, 0), V(1, 0)});
    stroke.half_width = {{0.0, 1.0}};
    Pass pass;
    pass.poses_mm.resize(2, 3);
    pass.poses_mm << 50, 50, 0, 52, 50, 0;
    CHECK(tracking_error_of(pass, stroke, brush, 0.05).largest_mm == 0.0);
}

TEST_CASE("the distance to a polyline is the distance to its nearest piece") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> anywhere(-20.0, 20.0);
    for (const Eigen::Index n : {1, 2, 3, 16, 17, 18, 40, 700}) {
        Ring line(n, 2);
        for (Eigen::Index i = 0; i < n; ++i)
            line.row(i) << (i % 7 == 3 ? line.row(i - 1).eval()
                                       : Eigen::RowVector2d(anywhere(random), anywhere(random)));
        NearestOnPolyline<Ring> nearest(line);
        for (int k = 0; k < 50; ++k) {
            const V p(anywhere(random), anywhere(random));
            double least = (p - line.row(0).transpose()).norm();
            for (Eigen::Index i = 0; i + 1 < n; ++i) {
                const V a = line.row(i).transpose(), d = line.row(i + 1).transpose() - a;
                const double t = d.norm() > 0.0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
                least = std::min(least, (p - a - t * d).norm());
            }
            CHECK(nearest.distance(p) == doctest::Approx(least).epsilon(1e-14));
        }
    }
}
