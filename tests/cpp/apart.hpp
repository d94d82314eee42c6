#pragma once

#include "brushsvg/region.hpp"

inline double length_around(const brushsvg::Rings& rings) {
    double length = 0.0;
    for (const brushsvg::Ring& ring : rings)
        for (Eigen::Index i = 0, n = ring.rows(); i < n; ++i) length += (ring.row((i + 1) % n) - ring.row(i)).norm();
    return length;
}

/// Return the mean distance between the outlines of two shapes [mm]. The unions used here do not depend on the code for
/// stars and chains.
inline double apart(const brushsvg::Rings& a, const brushsvg::Rings& b) {
    const brushsvg::Rings one = fill(a, brushsvg::FillRule::nonzero), other = fill(b, brushsvg::FillRule::nonzero);
    using brushsvg::area;
    return (area(one) + area(other) - 2.0 * area(brushsvg::intersect(one, other))) / length_around(one);
}

/// Return the points of both rings.
inline brushsvg::Ring both(const brushsvg::Ring& a, const brushsvg::Ring& b) {
    brushsvg::Ring points(a.rows() + b.rows(), 2);
    points << a, b;
    return points;
}
