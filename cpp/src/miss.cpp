#include "brushsvg/miss.hpp"

#include <algorithm>
#include <cmath>

#include "brushsvg/simulate.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Distance to a polyline, block by block; successive queries lie close to each other.
class Nearest {
 public:
    explicit Nearest(const MiddlePolyline& line) : line_(line) {
        for (Index i = 0; i < std::max<Index>(1, line.rows() - 1); i += kBlock) {
            const Index n = std::min<Index>(kBlock + 1, line.rows() - i);
            const Vector2d lo = line.block(i, 0, n, 2).colwise().minCoeff().transpose();
            const Vector2d hi = line.block(i, 0, n, 2).colwise().maxCoeff().transpose();
            blocks_.push_back({0.5 * (lo + hi), 0.5 * (hi - lo).norm()});
        }
    }
    double distance(const Vector2d& p) {
        double best = in_block(last_, p);
        for (std::size_t k = 0; k < blocks_.size(); ++k) {
            if ((p - blocks_[k].centre).norm() - blocks_[k].radius >= best) continue;
            const double d = in_block(k, p);
            if (d < best) {
                best = d;
                last_ = k;
            }
        }
        return best;
    }

 private:
    static constexpr Index kBlock = 16;
    struct Block {
        Vector2d centre;
        double radius;
    };
    double in_block(std::size_t k, const Vector2d& p) const {
        const Index first = Index(k) * kBlock, last = std::min<Index>(first + kBlock, line_.rows() - 1);
        double best = (p - line_.row(first).head<2>().transpose()).squaredNorm();
        for (Index i = first; i < last; ++i) {
            const Vector2d a = line_.row(i).head<2>().transpose(), d = line_.row(i + 1).head<2>().transpose() - a;
            const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
            best = std::min(best, (p - a - t * d).squaredNorm());
        }
        return std::sqrt(best);
    }
    const MiddlePolyline& line_;
    std::vector<Block> blocks_;
    std::size_t last_ = 0;
};

}  // namespace

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
