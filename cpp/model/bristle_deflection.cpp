#include "brushsvg/bristle_deflection.hpp"

#include <Eigen/LU>
#include <cmath>

namespace brushsvg {

Eigen::Vector4d bristle_coefficients(SlidingEnd end) {
    const double e = std::exp(1.0);
    Eigen::Matrix4d a;
    Eigen::Vector4d b;
    a.row(0) << 1.0, 0.0, 1.0, 0.0;    // w(0) = 0
    a.row(1) << 0.0, 1.0, 1.0, 1.0;    // w'(0) = 0
    a.row(2) << 0.0, 1.0, e, 2.0 * e;  // w'(1) = 0
    b << 0.0, 0.0, -1.0, 0.0;
    if (end == SlidingEnd::third_derivative) {
        a.row(3) << 0.0, 0.0, e, 4.0 * e;  // w'''(1) = 0
    } else {
        // (e^(1-z) w'')' = e^(1-z) (w''' - w''), with w'' = (c3 + 2 c4 + c4 z) e^z + 1
        a.row(3) << 0.0, 0.0, 0.0, e;
        b(3) = 1.0;
    }
    return a.partialPivLu().solve(b);
}

double bristle_deflection(const Eigen::Vector4d& c, double z) {
    return c(0) + c(1) * z + (c(2) + c(3) * z) * std::exp(z) + 0.5 * z * z;
}

}  // namespace brushsvg
