#pragma once

#include <algorithm>
#include <cmath>

// The drop that stands for a round brush's footprint: tip at (0, 0), straight flanks to the widest section at x =
// widest, half width `half`, in front of it half an ellipse that ends at widest + front. Lengths in mm.
namespace brushsvg::fit {

struct Drop {
    double widest, half, front;
};

/// The place of a drop's edge that is nearest to a point, and how far the point is from it.
struct NearestEdge {
    double distance;             ///< negative inside
    double x, y;                 ///< the place on the edge
    double nx, ny;               ///< outward normal there
    double by_widest, by_front;  ///< x = by_widest * widest + by_front * front
    double by_half;              ///< y = by_half * half
};

/// Nearest place on the quarter of an ellipse x >= 0, y >= 0 as (cos, sin) of its parameter, by its centres of
/// curvature: three steps are exact to a few 1e-6 of the axes where these differ by less than half.
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

/// x, y: the point in the drop's frame.
inline NearestEdge nearest_edge(const Drop& drop, double x, double y) {
    const double side = y < 0.0 ? -1.0 : 1.0, up = std::abs(y);
    const double length2 = drop.widest * drop.widest + drop.half * drop.half;
    const double t = std::clamp((x * drop.widest + up * drop.half) / length2, 0.0, 1.0);
    const double fx = t * drop.widest, fy = t * drop.half;
    const double flank2 = (x - fx) * (x - fx) + (up - fy) * (up - fy);
    NearestEdge out;
    bool inside;
    if (x <= drop.widest) {
        inside = x > 0.0 && up * drop.widest < x * drop.half;
    } else {
        const double ex = (x - drop.widest) / drop.front, ey = up / drop.half;
        inside = ex * ex + ey * ey < 1.0;
    }
    double c = 0.0, s = 1.0;
    if (x > drop.widest || inside) nearest_on_quarter(drop.front, drop.half, x - drop.widest, up, c, s);
    const double ax = drop.widest + drop.front * c, ay = drop.half * s;
    const double arc2 = (x - ax) * (x - ax) + (up - ay) * (up - ay);
    const bool on_flank = (x <= drop.widest && !inside) || flank2 < arc2;
    const double distance = std::sqrt(on_flank ? flank2 : arc2);
    double nx, ny;
    if (on_flank) {
        out.x = fx;
        out.y = side * fy;
        out.by_widest = t;
        out.by_front = 0.0;
        out.by_half = side * t;
        const double length = std::sqrt(length2);
        nx = -drop.half / length;
        ny = drop.widest / length;
        if ((t == 0.0 || t == 1.0) && !inside && distance > 1e-9) {
            nx = (x - fx) / distance;
            ny = (up - fy) / distance;
        }
    } else {
        out.x = ax;
        out.y = side * ay;
        out.by_widest = 1.0;
        out.by_front = c;
        out.by_half = side * s;
        nx = c / drop.front;
        ny = s / drop.half;
        const double length = std::sqrt(nx * nx + ny * ny);
        nx /= length;
        ny /= length;
    }
    out.distance = inside ? -distance : distance;
    out.nx = nx;
    out.ny = side * ny;
    return out;
}

}  // namespace brushsvg::fit
