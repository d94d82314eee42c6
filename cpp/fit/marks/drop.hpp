#pragma once

#include <algorithm>
#include <cmath>

// The drop that models a round brush's footprint. Its tip is at (0, 0) and its widest section, with half width `half`,
// at x = widest. In front of this section is half an ellipse that ends at widest + front. Behind it are straight
// flanks, or half an ellipse where the tail is round. Lengths are in mm.
namespace brushsvg::fit {

struct Drop {
    double widest, half, front;
    bool round_tail = false;
};

/// The place of a drop's edge nearest to a point, and the distance of the point from it.
struct NearestEdge {
    double distance;             ///< negative inside
    double x, y;                 ///< the place on the edge
    double nx, ny;               ///< outward normal there
    double by_widest, by_front;  ///< x = by_widest * widest + by_front * front
    double by_half;              ///< y = by_half * half
};

/// Finds the nearest place on the quarter of an ellipse x >= 0, y >= 0 as (cos, sin) of its parameter. It uses the
/// centres of curvature. Three steps are exact to a few 1e-6 of the axes where the axes differ by less than half.
inline void nearest_on_quarter(double a, double b, double px, double py, double& c, double& s) {
    c = s = M_SQRT1_2;
    for (int i = 0; i < 4; ++i) {
        const double ex = (a * a - b * b) * c * c * c / a, ey = (b * b - a * a) * s * s * s / b;
        const double rx = a * c - ex, ry = b * s - ey, qx = px - ex, qy = py - ey;
        const double q = std::sqrt(qx * qx + qy * qy);
        if (!(q > 1e-12)) return;
        const double stretch = std::sqrt(rx * rx + ry * ry) / q;
        c = std::clamp((qx * stretch + ex) / a, 0.0, 1.0);
        s = std::clamp((qy * stretch + ey) / b, 0.0, 1.0);
        const double norm = std::sqrt(c * c + s * s);
        if (!(norm > 0.0)) {
            c = 0.0;
            s = 1.0;
            return;
        }
        c /= norm;
        s /= norm;
    }
}

/// Returns a lower bound of the distance, which is almost exact close to the edge. It is the distance from a tangent of
/// the drop: the flank, or the tangent where the ray from the ellipse's centre to the point meets the edge. x, y: the
/// point in the drop's frame.
inline double least_distance(const Drop& drop, double x, double y) {
    const double up = std::abs(y), ahead = x - drop.widest;
    if (ahead <= 0.0 && !drop.round_tail) {
        const double length = std::sqrt(drop.widest * drop.widest + drop.half * drop.half);
        return std::max((up * drop.widest - x * drop.half) / length, up - drop.half);
    }
    // With (c, s) = (ahead / front, up / half) / rho the tangent is c X / front + s Y / half = 1.
    const double axis = ahead <= 0.0 ? drop.widest : drop.front;
    const double c = ahead / axis, s = up / drop.half, rho = std::sqrt(c * c + s * s);
    if (!(rho > 0.0)) return -std::min(std::min(drop.front, drop.widest), drop.half);
    const double nx = c / axis, ny = s / drop.half;
    return (rho - 1.0) * rho / std::sqrt(nx * nx + ny * ny);
}

/// Finds the place of a drop's edge nearest to a point. x, y: the point in the drop's frame.
inline NearestEdge nearest_edge(const Drop& drop, double x, double y) {
    const double side = y < 0.0 ? -1.0 : 1.0, up = std::abs(y), ahead = x - drop.widest;
    const bool behind = ahead <= 0.0;
    bool inside;
    if (behind && !drop.round_tail) {
        inside = x > 0.0 && up * drop.widest < x * drop.half;
    } else {
        const double ex = ahead / (behind ? drop.widest : drop.front), ey = up / drop.half;
        inside = ex * ex + ey * ey < 1.0;
    }
    NearestEdge out{INFINITY, 0, 0, 0, 0, 0, 0, 0};
    const auto offer = [&](double px, double py, double nx, double ny, double by_widest, double by_front,
                           double by_half) {
        const double distance = std::hypot(x - px, up - py);
        if (distance < out.distance)
            out = {distance, px, side * py, nx, side * ny, by_widest, by_front, side * by_half};
    };
    if (!behind || inside) {
        double c, s;
        nearest_on_quarter(drop.front, drop.half, ahead, up, c, s);
        const double nx = c / drop.front, ny = s / drop.half, length = std::hypot(nx, ny);
        offer(drop.widest + drop.front * c, drop.half * s, nx / length, ny / length, 1.0, c, s);
    }
    if (drop.round_tail) {
        if (behind || inside) {
            double c, s;
            nearest_on_quarter(drop.widest, drop.half, -ahead, up, c, s);
            const double nx = -c / drop.widest, ny = s / drop.half, length = std::hypot(nx, ny);
            offer(drop.widest * (1.0 - c), drop.half * s, nx / length, ny / length, 1.0 - c, 0.0, s);
        }
    } else if (behind || inside) {
        const double length = std::hypot(drop.widest, drop.half);
        const double t = std::clamp((x * drop.widest + up * drop.half) / (length * length), 0.0, 1.0);
        double nx = -drop.half / length, ny = drop.widest / length;
        const double px = t * drop.widest, py = t * drop.half, distance = std::hypot(x - px, up - py);
        if ((t == 0.0 || t == 1.0) && !inside && distance > 1e-9) {  // beyond the flank's ends
            nx = (x - px) / distance;
            ny = (up - py) / distance;
        }
        offer(px, py, nx, ny, t, 0.0, t);
    }
    if (inside) out.distance = -out.distance;
    return out;
}

/// Returns the flank on the side of a point behind the tip, extended beyond the tip to the point's foot.
inline NearestEdge flank_beyond_tip(const Drop& drop, double x, double y) {
    const double side = y < 0.0 ? -1.0 : 1.0, up = std::abs(y), length = std::hypot(drop.widest, drop.half);
    const double t = (x * drop.widest + up * drop.half) / (length * length);
    return {(up * drop.widest - x * drop.half) / length,
            t * drop.widest,
            side * t * drop.half,
            -drop.half / length,
            side * drop.widest / length,
            t,
            0.0,
            side * t};
}

/// Returns the place of a drop's edge that is farthest in direction (nx, ny), a unit vector in the drop's frame.
inline NearestEdge farthest_edge(const Drop& drop, double nx, double ny) {
    const double up = std::abs(ny), side = ny < 0.0 ? -1.0 : 1.0;
    NearestEdge out{0, 0, 0, nx, ny, 0, 0, 0};
    const bool ahead = nx > 0.0;
    if (ahead || drop.round_tail) {
        const double axis = ahead ? drop.front : drop.widest, ex = axis * nx, ey = drop.half * up;
        const double length = std::sqrt(ex * ex + ey * ey), c = length > 0.0 ? ex / length : 1.0;
        out.by_widest = ahead ? 1.0 : 1.0 + c;
        out.by_front = ahead ? c : 0.0;
        out.by_half = side * (length > 0.0 ? ey / length : 0.0);
    } else if (drop.widest * nx + drop.half * up > 0.0) {
        out.by_widest = 1.0;
        out.by_half = side;
    }
    out.x = out.by_widest * drop.widest + out.by_front * drop.front;
    out.y = out.by_half * drop.half;
    return out;
}

/// Returns the place at a share of the line that touches a drop at one place and the drop of the next instant at
/// another.
inline NearestEdge between(const Drop& drop, const NearestEdge& one, const NearestEdge& other, double share) {
    NearestEdge out = one;
    out.by_widest += share * (other.by_widest - one.by_widest);
    out.by_front += share * (other.by_front - one.by_front);
    out.by_half += share * (other.by_half - one.by_half);
    out.x = out.by_widest * drop.widest + out.by_front * drop.front;
    out.y = out.by_half * drop.half;
    return out;
}

/// The part of a line (x, y) + t (dx, dy) inside a drop: t in [from, to], empty where to < from. Coordinates are in the
/// drop's frame. The drop consists of a triangle behind its widest section and half an ellipse in front of it.
struct Span {
    double from, to;
};
inline Span span_inside(const Drop& drop, double x, double y, double dx, double dy) {
    const auto cut = [](Span span, double value, double rate) {  // to t with value + t rate >= 0
        if (rate > 0.0)
            span.from = std::max(span.from, -value / rate);
        else if (rate < 0.0)
            span.to = std::min(span.to, -value / rate);
        else if (value < 0.0)
            span.to = -INFINITY;
        return span;
    };
    const auto in_ellipse = [&](double axis) {
        const double px = (x - drop.widest) / axis, py = y / drop.half, vx = dx / axis, vy = dy / drop.half;
        const double a = vx * vx + vy * vy, b = px * vx + py * vy, square = b * b - a * (px * px + py * py - 1.0);
        if (!(square > 0.0)) return Span{0.0, -INFINITY};
        const double root = std::sqrt(square);
        return Span{(-b - root) / a, (-b + root) / a};
    };
    const Span front = cut(in_ellipse(drop.front), x - drop.widest, dx);
    Span flank{-1e9, 1e9};
    if (drop.round_tail) {
        flank = in_ellipse(drop.widest);
    } else {
        flank = cut(flank, drop.half * x - drop.widest * y, drop.half * dx - drop.widest * dy);
        flank = cut(flank, drop.half * x + drop.widest * y, drop.half * dx + drop.widest * dy);
    }
    flank = cut(flank, drop.widest - x, -dx);
    if (flank.to < flank.from) return front;
    if (front.to < front.from) return flank;
    return {std::min(flank.from, front.from), std::max(flank.to, front.to)};
}

}  // namespace brushsvg::fit
