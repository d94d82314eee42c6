#include "brushsvg/cubic_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/format_text.hpp"
#include "base/tolerance.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "regions/nearest_on_polyline.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Points = std::vector<Vector2d>;
using Cubic = std::array<Vector2d, 4>;

constexpr int kMaxParameterMoves = 6;  // more moves improve the fit less than a split
// Distance between points, in tolerances. A larger distance cuts bends short, a smaller one only costs time.
constexpr double kPointSpacingTolerances = 8.0;
constexpr double kMinPieces = 8.0, kMaxPieces = 2000.0;
// Distance of the points that determine a direction, in tolerances. Nearer points would show the noise.
constexpr double kTangentReachTolerances = 12.0;

Vector2d at(const Cubic& c, double t) {
    const double u = 1.0 - t;
    return u * u * u * c[0] + 3.0 * u * u * t * c[1] + 3.0 * u * t * t * c[2] + t * t * t * c[3];
}

/// Smallest speed in the middle of a cubic, relative to its mean speed along the chord. Slower cubics turn around
/// there, in a cusp or a loop.
constexpr double kMinSpeedRatio = 0.25;

/// Returns whether a cubic almost stops along its chord, or goes back, before it continues. The derivative along the
/// chord is a quadratic polynomial, here in Bernstein form.
bool turns_back(const Cubic& c) {
    const Vector2d chord = c[3] - c[0];
    const double first = chord.dot(c[1] - c[0]), amid = chord.dot(c[2] - c[1]), last = chord.dot(c[3] - c[2]);
    const double slowest = kMinSpeedRatio * chord.squaredNorm() / 3.0;
    return std::min(first, last) > 0.0 && amid < 0.0 &&
           first * last - amid * amid < slowest * (first - 2.0 * amid + last);
}

class CubicFitter {
 public:
    CubicFitter(Points points, double tolerance, bool closed) : p_(std::move(points)), tolerance_(tolerance) {
        const std::size_t last = p_.size() - 1;
        Vector2d start = direction_from(0, 1), end = direction_from(last, -1);
        if (closed) {
            start = (start - end).normalized();
            end = -start;
        }
        fit_stretch(0, last, start, end);
    }
    std::vector<Cubic> cubics;
    std::vector<std::vector<double>> parameters;  // of each cubic's points, including its first one

 private:
    void append_cubic(const Cubic& cubic, const std::vector<double>& t) {
        cubics.push_back(cubic);
        parameters.push_back(t);
    }
    /// Returns the direction from a point to the points after it (step 1) or before it (step -1).
    Vector2d direction_from(std::size_t i, int step) const {
        const double reach = kTangentReachTolerances * tolerance_;
        Vector2d sum = Vector2d::Zero();
        for (std::ptrdiff_t k = std::ptrdiff_t(i) + step; k >= 0 && k < std::ptrdiff_t(p_.size()); k += step) {
            const Vector2d d = p_[std::size_t(k)] - p_[i];
            sum += d;
            if (d.norm() > reach) break;
        }
        return sum.norm() > 0.0 ? Vector2d(sum.normalized()) : Vector2d(1.0, 0.0);
    }
    void fit_stretch(std::size_t first, std::size_t last, const Vector2d& start, const Vector2d& end) {
        std::vector<double> t(last - first + 1, 0.0);
        for (std::size_t i = first + 1; i <= last; ++i) t[i - first] = t[i - first - 1] + (p_[i] - p_[i - 1]).norm();
        for (double& each : t) each /= t.back();
        Cubic cubic{};
        std::size_t worst = first;
        for (int k = 0; k <= kMaxParameterMoves; ++k) {
            cubic = least_squares(first, last, t, start, end);
            double most = 0.0;
            worst = (first + last) / 2;
            for (std::size_t i = first + 1; i < last; ++i) {
                const double d = (at(cubic, t[i - first]) - p_[i]).norm();
                if (d > most) {
                    most = d;
                    worst = i;
                }
            }
            if (most <= tolerance_) {
                append_cubic(cubic, t);
                return;
            }
            if (most > 8.0 * tolerance_) break;
            checkpoint(int(t.size()));
            improve_parameters(cubic, first, t);
        }
        if (last - first < 2) {
            append_cubic(cubic, t);
            return;
        }
        worst = std::clamp(worst, first + 1, last - 1);
        Vector2d through = direction_from(worst, 1) - direction_from(worst, -1);
        through = through.norm() > 1e-9 ? Vector2d(through.normalized()) : direction_from(worst, 1);
        fit_stretch(first, worst, start, -through);
        fit_stretch(worst, last, through, end);
    }
    Cubic least_squares(std::size_t first, std::size_t last, const std::vector<double>& t, const Vector2d& start,
                        const Vector2d& end) const {
        const Vector2d &a = p_[first], &b = p_[last];
        Eigen::Matrix2d c = Eigen::Matrix2d::Zero();
        Eigen::Vector2d x = Eigen::Vector2d::Zero();
        for (std::size_t i = first; i <= last; ++i) {
            const double v = t[i - first], u = 1.0 - v;
            const double b0 = u * u * u, b1 = 3.0 * u * u * v, b2 = 3.0 * u * v * v, b3 = v * v * v;
            const Vector2d a1 = b1 * start, a2 = b2 * end, off = p_[i] - (b0 + b1) * a - (b2 + b3) * b;
            c(0, 0) += a1.dot(a1);
            c(0, 1) += a1.dot(a2);
            c(1, 1) += a2.dot(a2);
            x(0) += a1.dot(off);
            x(1) += a2.dot(off);
        }
        c(1, 0) = c(0, 1);
        const double chord = (b - a).norm(), determinant = c.determinant();
        Eigen::Vector2d alpha = Eigen::Vector2d::Constant(chord / 3.0);
        if (determinant > 1e-12 * c(0, 0) * c(1, 1)) {
            const Eigen::Vector2d found = c.inverse() * x;
            // Handles that turn back or make a loop show that the stretch is too long.
            if (found.minCoeff() > 1e-3 * chord && found.maxCoeff() < 3.0 * chord + 1e-9 &&
                !turns_back({a, a + found(0) * start, b + found(1) * end, b}))
                alpha = found;
        }
        return {a, a + alpha(0) * start, b + alpha(1) * end, b};
    }
    /// Makes one Newton step towards the parameters of the nearest points, which stay in order and inside.
    void improve_parameters(const Cubic& c, std::size_t first, std::vector<double>& t) const {
        for (std::size_t i = 1; i + 1 < t.size(); ++i) {
            const double v = t[i], u = 1.0 - v;
            const Vector2d off = at(c, v) - p_[first + i];
            const Vector2d d1 = 3.0 * (u * u * (c[1] - c[0]) + 2.0 * u * v * (c[2] - c[1]) + v * v * (c[3] - c[2]));
            const Vector2d d2 = 6.0 * (u * (c[2] - 2.0 * c[1] + c[0]) + v * (c[3] - 2.0 * c[2] + c[1]));
            const double slope = d1.squaredNorm() + off.dot(d2);
            if (slope > 0.0) t[i] = std::clamp(v - off.dot(d1) / slope, t[i - 1], 1.0);
        }
    }
    Points p_;
    double tolerance_;
};

/// Resamples the line at even steps, because the fit weights points and not lengths. Half widths are not negative.
void resample_evenly(const WideLine& line, double step, Points& points, std::vector<double>& half) {
    std::vector<double> at{0.0};
    for (Index i = 1; i < line.rows(); ++i) at.push_back(at.back() + (line.row(i) - line.row(i - 1)).head<2>().norm());
    if (line.rows() == 0) return;
    const double length = at.back();
    const int n = length > 1e-9 ? int(std::clamp(length / step, kMinPieces, kMaxPieces)) : 0;
    Index i = 0;
    for (int k = 0; k <= n; ++k) {
        const double s = n > 0 ? length * k / n : 0.0;
        while (i + 2 < line.rows() && at[std::size_t(i + 1)] < s) ++i;
        const Index j = std::min(i + 1, line.rows() - 1);
        const double span = at[std::size_t(j)] - at[std::size_t(i)];
        const double c = span > 0.0 ? std::clamp((s - at[std::size_t(i)]) / span, 0.0, 1.0) : 0.0;
        const Eigen::RowVector3d row = line.row(i) + c * (line.row(j) - line.row(i));
        points.push_back(row.head<2>().transpose());
        half.push_back(std::max(0.0, row(2)));
    }
}

/// Selects as few places (fraction, half width) as keep the others within the tolerance, by splitting at the worst
/// place.
void select_knots(const std::vector<WidthKnot>& all, std::size_t first, std::size_t last, double tolerance,
                  std::vector<WidthKnot>& out) {
    double most = tolerance;
    std::size_t worst = first;
    for (std::size_t i = first + 1; i < last; ++i) {
        const double span = all[last].at - all[first].at;
        const double c = span > 0.0 ? (all[i].at - all[first].at) / span : 0.0;
        const double off = std::abs(all[first].half_width_mm +
                                    c * (all[last].half_width_mm - all[first].half_width_mm) - all[i].half_width_mm);
        if (off > most) {
            most = off;
            worst = i;
        }
    }
    if (worst == first) {
        out.push_back(all[last]);
        return;
    }
    select_knots(all, first, worst, tolerance, out);
    select_knots(all, worst, last, tolerance, out);
}

}  // namespace

FittedLine fit_cubics(const WideLine& line, double tolerance_mm, bool closed) {
    if (line.rows() > 0 && !(line.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 1e6))
        throw Error("geometry-out-of-range", "the line has a number that is not finite or beyond 1e6 mm");
    require_tolerance(tolerance_mm);
    FittedLine result;
    Points points;
    std::vector<double> half;
    resample_evenly(line, kPointSpacingTolerances * tolerance_mm, points, half);
    if (points.empty()) return result;
    if (points.size() == 1) {
        const Vector2d& p = points[0];
        result.middle_mm.resize(1, 8);
        result.middle_mm << p.x(), p.y(), p.x(), p.y(), p.x(), p.y(), p.x(), p.y();
        result.half_width = {{0.0, half[0]}};
        return result;
    }
    const CubicFitter fit(std::move(points), tolerance_mm, closed);
    result.middle_mm.resize(Index(fit.cubics.size()), 8);
    for (Index i = 0; i < result.middle_mm.rows(); ++i)
        for (int k = 0; k < 4; ++k)
            result.middle_mm.row(i).segment<2>(2 * k) = fit.cubics[std::size_t(i)][std::size_t(k)].transpose();
    std::vector<WidthKnot> all{{0.0, half[0]}};
    double s = 0.0;
    for (std::size_t i = 0; i < fit.cubics.size(); ++i)
        for (std::size_t k = 1; k < fit.parameters[i].size(); ++k) {
            s += arc_length(result.middle_mm, Index(i), fit.parameters[i][k - 1], fit.parameters[i][k]);
            all.push_back({s, half[all.size()]});
        }
    for (WidthKnot& knot : all) knot.at /= s;
    all.back().at = 1.0;
    result.half_width.push_back(all.front());
    select_knots(all, 0, all.size() - 1, 0.5 * tolerance_mm, result.half_width);
    return result;
}

namespace {

constexpr int kMaxFits = 2000;  // of one line: the rest then becomes straight lines

/// Returns the points that differ from the one before. Throws Error for points that are not a stroke.
WideLine require_line(const StrokeId& id, const WideLine& points) {
    WideLine line(points.rows(), 3);
    Index n = 0;
    for (Index i = 0; i < points.rows(); ++i) {
        const std::string which = "point " + std::to_string(i);
        if (!(points.row(i).head<2>().cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 1e6))
            throw Error("geometry-out-of-range", which + " has a coordinate that is not finite or beyond 1e6 mm", id);
        const double width = 2.0 * points(i, 2);
        if (!(width > 0.0 && width <= 1e6))
            throw Error("out-of-range",
                        which + format_text(" has a width of %.4g mm, outside the range (0, 1e6] mm", width), id, width,
                        std::array<double, 2>{0.0, 1e6});
        if (n == 0 || points.row(i).head<2>() != line.row(n - 1).head<2>()) line.row(n++) = points.row(i);
    }
    if (n < 2) throw Error("stroke-empty", "a stroke needs at least 2 different points, not " + std::to_string(n), id);
    return line.topRows(n);
}

/// Appends cubics along rows first to last, split at the point with the largest distance from the curve. at: arc
/// length of each row [mm].
void append_smooth_cubics(const WideLine& line, const std::vector<double>& at, Index first, Index last,
                          double tolerance, bool closed, int& fits, std::vector<Eigen::Matrix<double, 1, 8>>& out) {
    const auto append_line = [&](Index i) {
        const Eigen::RowVector2d a = line.row(i).head<2>(), b = line.row(i + 1).head<2>(), d = (b - a) / 3.0;
        out.emplace_back();
        out.back() << a, a + d, b - d, b;
    };
    std::vector<std::array<Index, 2>> pending{{first, last}};
    while (!pending.empty()) {
        const auto [from, to] = pending.back();
        pending.pop_back();
        checkpoint();
        if (to == from + 1 || fits >= kMaxFits) {
            for (Index i = from; i < to; ++i) append_line(i);
            continue;
        }
        if (at[std::size_t(to)] - at[std::size_t(from)] > kMaxPieces * kPointSpacingTolerances * 0.5 * tolerance) {
            // too long for one fit: its points would be further apart than the tolerance needs
            pending.push_back({(from + to) / 2, to});
            pending.push_back({from, (from + to) / 2});
            closed = false;
            continue;
        }
        ++fits;
        Stroke part;
        part.middle_mm = fit_cubics(line.middleRows(from, to - from + 1), 0.5 * tolerance, closed).middle_mm;
        part.half_width = {{0.0, 1.0}};
        const MiddlePolyline way = flatten(part, 0.1 * tolerance);
        NearestOnPolyline<MiddlePolyline> nearest(way);
        double most = 0.9 * tolerance;  // a margin, because distances are from a polyline and not from the curve itself
        Index worst = -1;
        for (Index i = from + 1; i < to; ++i) {
            const double off = nearest.distance(line.row(i).head<2>().transpose());
            if (off <= most) continue;
            most = off;
            worst = i;
        }
        if (worst < 0) {
            if (part.middle_mm.rows() > to - from)  // more cubics than points: the fit follows the chords
                for (Index i = from; i < to; ++i) append_line(i);
            else
                for (Index i = 0; i < part.middle_mm.rows(); ++i) out.emplace_back(part.middle_mm.row(i));
            continue;
        }
        closed = false;
        pending.push_back({worst, to});
        pending.push_back({from, worst});
    }
}

}  // namespace

Stroke stroke_along(const StrokeId& id, const WideLine& points, std::optional<double> tolerance_mm) {
    if (tolerance_mm) require_tolerance(*tolerance_mm, id);
    const WideLine line = require_line(id, points);
    const Index last = line.rows() - 1;
    Stroke stroke;
    stroke.id = id;
    stroke.closed = last > 1 && line.row(0).head<2>() == line.row(last).head<2>();
    std::vector<double> at{0.0};
    for (Index i = 1; i <= last; ++i) at.push_back(at.back() + (line.row(i) - line.row(i - 1)).head<2>().norm());
    std::vector<Eigen::Matrix<double, 1, 8>> cubics;
    int fits = tolerance_mm ? 0 : kMaxFits;
    append_smooth_cubics(line, at, 0, last, tolerance_mm.value_or(1.0), stroke.closed, fits, cubics);
    stroke.middle_mm.resize(Index(cubics.size()), 8);
    for (Index i = 0; i < stroke.middle_mm.rows(); ++i) stroke.middle_mm.row(i) = cubics[std::size_t(i)];
    for (Index i = 0; i <= last; ++i) {
        const double half = line(i, 2);
        if (i > 0 && i < last && half == line(i - 1, 2) && half == line(i + 1, 2)) continue;
        stroke.half_width.push_back({i == last ? 1.0 : at[std::size_t(i)] / at.back(), half});
    }
    return stroke;
}

}  // namespace brushsvg
