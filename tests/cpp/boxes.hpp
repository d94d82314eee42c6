#pragma once

#include "brushsvg/ring.hpp"

/// Return a box from two of its corners, counter-clockwise.
inline brushsvg::Ring box(double x0, double y0, double x1, double y1) {
    brushsvg::Ring ring(4, 2);
    ring << x0, y0, x1, y0, x1, y1, x0, y1;
    return ring;
}
