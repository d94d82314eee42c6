#include "brushsvg/miss.hpp"

#include <algorithm>
#include <cmath>

#include "brushsvg/simulate.hpp"
#include "nearest.hpp"

namespace brushsvg {

using Eigen::Index;

Miss miss_of(const Pass& pass, const Stroke& stroke, const Brush& brush, double tolerance_mm) {
    const PassMarks marks = simulate(pass, brush, std::min(0.02, 0.1 * tolerance_mm), false);
    const Ring widest = widest_points(marks, brush);
    const MiddlePolyline line = flatten(stroke, std::min(0.005, 0.05 * tolerance_mm));
    Nearest nearest(line);
    // from the first taut row to the last: the landing and a slack lift do not count, a turn in place does
    std::size_t begin = 0, end = marks.taut.size();
    while (begin < end && !marks.taut[begin]) ++begin;
    while (end > begin && !marks.taut[end - 1]) --end;
    Miss miss;
    double before = 0.0, travelled = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
        const double d = nearest.distance(widest.row(i).transpose());
        if (d > miss.largest_mm) {
            miss.largest_mm = d;
            miss.at_mm = {widest(Index(i), 0), widest(Index(i), 1)};
        }
        if (i > begin) {  // by length and not by rows, which lie closer where a tolerance asks for it
            const double step = (widest.row(i) - widest.row(i - 1)).norm();
            miss.mean_mm += 0.5 * (before + d) * step;
            travelled += step;
        }
        before = d;
    }
    miss.mean_mm = travelled > 0.0 ? miss.mean_mm / travelled : miss.largest_mm;
    miss.within_tolerance = miss.largest_mm <= tolerance_mm;
    return miss;
}

}  // namespace brushsvg
