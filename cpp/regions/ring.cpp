#include "brushsvg/ring.hpp"

namespace brushsvg {

double signed_area(const Ring& ring) {
    double twice = 0.0;
    for (Eigen::Index i = 0, n = ring.rows(); i < n; ++i) {
        const Eigen::Index j = i + 1 == n ? 0 : i + 1;
        // relative to the first vertex, to avoid cancellation far from the origin
        twice += (ring(i, 0) - ring(0, 0)) * (ring(j, 1) - ring(0, 1)) -
                 (ring(j, 0) - ring(0, 0)) * (ring(i, 1) - ring(0, 1));
    }
    return 0.5 * twice;
}

double length_around(const Ring& ring) {
    if (ring.rows() == 0) return 0.0;
    double length = (ring.row(0) - ring.row(ring.rows() - 1)).norm();
    for (Eigen::Index i = 1; i < ring.rows(); ++i) length += (ring.row(i) - ring.row(i - 1)).norm();
    return length;
}

}  // namespace brushsvg
