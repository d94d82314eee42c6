#include "brushsvg/stroke.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "base/format_text.hpp"
#include "base/tolerance.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Largest gap between joined lines. A wider gap would be painted across by a straight line.
constexpr double kMaxGapMm = 0.01;

/// Precision of the parameter at a length: a cubic halved 47 times, which is far below a hair's width on a metre.
constexpr double kParameterStep = 0x1p-47;
/// Number of these steps that are checked where Newton's method ends, because rounding sometimes ends it next to the
/// right step.
constexpr int kNeighbourSteps = 4;
/// After a Newton step of at most this length, the next step is exact to rounding.
constexpr double kNewtonTolerance = 1e-6;

void require_cubic(const Cubics& c, Index i) {
    if (i < 0 || i >= c.rows())
        throw Error("out-of-range",
                    "the middle line has " + std::to_string(c.rows()) + " cubics, but no cubic " + std::to_string(i),
                    "", double(i));
}

Vector2d control(const Cubics& c, Index i, int k) { return c.row(i).segment<2>(2 * k).transpose(); }

/// The derivative B'(t) of one cubic.
struct Derivative {
    Vector2d a, b, d;

    Derivative(const Cubics& c, Index i)
        : a(control(c, i, 1) - control(c, i, 0)),
          b(control(c, i, 2) - control(c, i, 1)),
          d(control(c, i, 3) - control(c, i, 2)) {}
    Vector2d operator()(double t) const {
        const double u = 1.0 - t;
        return 3.0 * (u * u * a + 2.0 * u * t * b + t * t * d);
    }
    /// Returns |B'(t)| of several parameters, with the same bits as one at a time.
    template <class Numbers>
    Numbers speeds(const Numbers& t) const {
        const Numbers u = 1.0 - t, p = u * u, q = 2.0 * u * t, r = t * t;
        const Numbers x = 3.0 * (p * a.x() + q * b.x() + r * d.x()), y = 3.0 * (p * a.y() + q * b.y() + r * d.y());
        return (x * x + y * y).sqrt();
    }
};

}  // namespace

Vector2d point_at(const Cubics& c, const Place& place) {
    const double t = place.t, u = 1.0 - t;
    const Index i = place.cubic;
    require_cubic(c, i);
    return u * u * u * control(c, i, 0) + 3.0 * u * u * t * control(c, i, 1) + 3.0 * u * t * t * control(c, i, 2) +
           t * t * t * control(c, i, 3);
}

Vector2d tangent_at(const Cubics& c, const Place& place) {
    const Index i = place.cubic;
    require_cubic(c, i);
    double size = 0.0;
    for (int k = 1; k < 4; ++k) size = std::max(size, (control(c, i, k) - control(c, i, 0)).norm());
    if (size == 0.0) return Vector2d::Zero();
    const Derivative derivative(c, i);
    Vector2d d = derivative(place.t);
    if (d.norm() <= 1e-9 * size) {
        const double inside = place.t < 0.5 ? 1e-4 : -1e-4;
        d = derivative(place.t + inside);
    }
    return d.norm() > 0.0 ? Vector2d(d.normalized()) : Vector2d::Zero();
}

double arc_length(const Cubics& c, Index i, double t0, double t1) {
    // Gauss-Legendre quadrature with 5 nodes on pieces of at most an eighth of the cubic. The error is 1e-9 of the
    // length, except at cusps.
    static constexpr double x[5] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                                    0.9061798459386640};
    static constexpr double w[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                                    0.2369268850561891};
    require_cubic(c, i);
    const Derivative derivative(c, i);
    const int n = int(std::clamp(std::ceil(std::abs(t1 - t0) * 8.0 - 1e-9), 1.0, 1000.0));
    double sum = 0.0;
    for (int k = 0; k < n; ++k) {
        const double a = t0 + (t1 - t0) * k / n, half = 0.5 * (t1 - t0) / n;
        Eigen::Array<double, 6, 1> t;  // all nodes at once by vector instructions; the sixth is not used
        for (int j = 0; j < 6; ++j) t[j] = a + half * (1.0 + x[std::min(j, 4)]);
        const Eigen::Array<double, 6, 1> speed = derivative.speeds(t);
        for (int j = 0; j < 5; ++j) sum += w[j] * half * speed[j];
    }
    return sum;
}

double parameter_at(const Cubics& c, Index i, double length_mm) {
    if (!(length_mm > 0.0)) return 0.0;
    const double whole = arc_length(c, i, 0.0, 1.0);
    if (!(length_mm < whole)) return 1.0;
    const auto is_before = [&](double t) { return arc_length(c, i, 0.0, t) < length_mm; };
    // Newton's method, with the length of each step, and a last step with the whole length. It fails at a cusp.
    const Derivative derivative(c, i);
    double t = length_mm / whole, missing = length_mm - arc_length(c, i, 0.0, t);
    for (int k = 0; k < 8; ++k) {
        const double before = t, step = missing / derivative(t).norm();
        t += step;
        if (!(t > 0.0 && t < 1.0)) break;
        const bool is_last = std::abs(step) < kNewtonTolerance;
        missing = is_last ? length_mm - arc_length(c, i, 0.0, t) : missing - arc_length(c, i, before, t);
        if (!is_last) continue;
        t += missing / derivative(t).norm();
        break;
    }
    // The result is never before the place, not even by a rounding error: a lever that is not extended at all is loose
    // for one move.
    double a = std::floor(t / kParameterStep) * kParameterStep, b = a + kParameterStep;
    bool is_found = false;
    for (int k = 0; !is_found && k < kNeighbourSteps && a >= 0.0 && b <= 1.0; ++k) {
        if (!is_before(a))
            b = a, a -= kParameterStep;
        else if (is_before(b))
            a = b, b += kParameterStep;
        else
            is_found = true;
    }
    if (!is_found) a = 0.0, b = 1.0;
    while (b - a > kParameterStep) {
        const double middle = 0.5 * (a + b);
        (is_before(middle) ? a : b) = middle;
    }
    return b;
}

double half_width_at(const Stroke& stroke, double fraction) {
    const auto& knots = stroke.half_width;
    if (knots.empty()) throw Error("stroke-empty", "the stroke has no width", stroke.id);
    const auto above = std::upper_bound(knots.begin(), knots.end(), fraction,
                                        [](double f, const WidthKnot& knot) { return f < knot.at; });
    if (above == knots.begin()) return knots.front().half_width_mm;
    if (above == knots.end()) return knots.back().half_width_mm;
    const WidthKnot& below = *(above - 1);
    return below.half_width_mm +
           (above->half_width_mm - below.half_width_mm) * (fraction - below.at) / (above->at - below.at);
}

void check(const Stroke& stroke) {
    if (stroke.middle_mm.rows() == 0) throw Error("stroke-empty", "the stroke has no middle line", stroke.id);
    if (!stroke.middle_mm.allFinite())
        throw Error("not-finite", "the middle line has a coordinate that is not finite", stroke.id);
    const double largest = stroke.middle_mm.cwiseAbs().maxCoeff();
    if (largest > 1e6)
        throw Error("geometry-out-of-range", "the middle line has a coordinate beyond 1e6 mm", stroke.id, largest,
                    std::array<double, 2>{-1e6, 1e6});
    const Eigen::Index last = stroke.middle_mm.rows() - 1;
    for (Eigen::Index i = stroke.closed ? 0 : 1; i <= last; ++i) {
        const Eigen::Index before = i > 0 ? i - 1 : last;
        const double gap_mm = (stroke.middle_mm.row(i).head<2>() - stroke.middle_mm.row(before).tail<2>()).norm();
        if (gap_mm <= kMaxGapMm) continue;
        throw Error("geometry-out-of-range",
                    "cubic " + std::to_string(i) +
                        format_text(" of the middle line begins %.3g mm from the end of cubic ", gap_mm) +
                        std::to_string(before) + ": join them, or make two strokes",
                    stroke.id, gap_mm, std::array<double, 2>{0.0, kMaxGapMm});
    }
    if (stroke.half_width.empty()) throw Error("stroke-empty", "the stroke has no width", stroke.id);
    double before = -1.0;
    for (const WidthKnot& knot : stroke.half_width) {
        if (!(std::abs(knot.at) <= 1e6))
            throw Error("out-of-range", "the place of a half width along the stroke is not finite or beyond 1e6",
                        stroke.id, knot.at);
        if (!(knot.half_width_mm >= 0.0 && knot.half_width_mm <= 1e6))
            throw Error("out-of-range", "the stroke has a half width that is negative, not finite or beyond 1e6 mm",
                        stroke.id, knot.half_width_mm);
        if (knot.at < before)
            throw Error("not-ascending", "the places of the half widths along the stroke are not in ascending order",
                        stroke.id, knot.at);
        before = knot.at;
    }
    for (const Ring& ring : stroke.target_mm)
        if (ring.rows() > 0 && !(ring.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 1e6))
            throw Error("geometry-out-of-range",
                        "the target outline has a coordinate that is not finite or beyond 1e6 mm", stroke.id);
}

namespace {

/// Adds points (x, y, arc length) where the width has a knot, because the width is linear between rows.
std::vector<std::array<double, 3>> insert_knot_places(const std::vector<std::array<double, 3>>& points,
                                                      const Stroke& stroke, double length) {
    std::vector<std::array<double, 3>> out{points.front()};
    auto knot = stroke.half_width.begin();
    for (std::size_t i = 1; i < points.size(); ++i) {
        const auto &a = points[i - 1], &b = points[i];
        for (; knot != stroke.half_width.end() && knot->at * length < b[2]; ++knot) {
            const double at = knot->at * length;
            if (at <= out.back()[2]) continue;
            const double t = (at - a[2]) / (b[2] - a[2]);
            out.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), at});
        }
        out.push_back(b);
    }
    return out;
}

}  // namespace

/// Limit of the points of a line. A longer line, such as kilometres of curves with fine details, becomes as fine as
/// this limit permits.
constexpr double kMaxPoints = 4e6;

MiddlePolyline flatten(const Stroke& stroke, double tolerance_mm) {
    check(stroke);
    require_tolerance(tolerance_mm, stroke.id);
    const Cubics& c = stroke.middle_mm;
    // The chord error of n equal steps is |B''| / (8 n^2).
    std::vector<double> steps;
    for (Index i = 0; i < c.rows(); ++i) {
        const Vector2d p0 = control(c, i, 0), p1 = control(c, i, 1), p2 = control(c, i, 2), p3 = control(c, i, 3);
        const double second = 6.0 * std::max((p0 - 2.0 * p1 + p2).norm(), (p1 - 2.0 * p2 + p3).norm());
        steps.push_back(std::max(1.0, std::ceil(std::sqrt(second / (8.0 * tolerance_mm)))));
    }
    const double coarsening = std::max(1.0, std::accumulate(steps.begin(), steps.end(), 0.0) / kMaxPoints);
    std::vector<std::array<double, 3>> points;
    double s = 0.0;
    for (Index i = 0; i < c.rows(); ++i) {
        const Vector2d p0 = control(c, i, 0), p3 = control(c, i, 3);
        const int n = int(std::ceil(steps[std::size_t(i)] / coarsening));
        if (i == 0) points.push_back({p0.x(), p0.y(), 0.0});
        for (int k = 1; k <= n; ++k) {
            const Vector2d p = k == n ? p3 : point_at(c, {i, double(k) / n});
            checkpoint();
            const double step = arc_length(c, i, double(k - 1) / n, double(k) / n);
            if (p.x() == points.back()[0] && p.y() == points.back()[1] && step == 0.0) continue;
            s += step;
            points.push_back({p.x(), p.y(), s});
        }
    }
    points = insert_knot_places(points, stroke, s);
    MiddlePolyline out(Index(points.size()), 4);
    for (Index i = 0; i < out.rows(); ++i) {
        const auto& p = points[i];
        out.row(i) << p[0], p[1], p[2], half_width_at(stroke, s > 0.0 ? p[2] / s : 0.0);
    }
    return out;
}

}  // namespace brushsvg
