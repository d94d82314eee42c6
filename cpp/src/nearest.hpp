#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace brushsvg {

/// Visits the points of rows `begin` to `end` of a polyline and points between them, so that no two are farther apart
/// than the step: what curves away between two rows must not be missed.
template <class Points, class Visit>
void along(const Points& rows, Eigen::Index begin, Eigen::Index end, double step_mm, Visit&& visit) {
    for (Eigen::Index i = begin; i < end; ++i) {
        const Eigen::Vector2d here = rows.row(i).transpose();
        if (i > begin) {
            const Eigen::Vector2d before = rows.row(i - 1).transpose();
            const int n = int(std::min(1e4, std::ceil((here - before).norm() / step_mm)));
            for (int k = 1; k < n; ++k) visit(Eigen::Vector2d(before + double(k) / n * (here - before)));
        }
        visit(here);
    }
}

/// Distance to a polyline (columns x, y and any others), block by block; successive queries lie close to each other.
template <class Polyline>
class Nearest {
 public:
    explicit Nearest(const Polyline& line) : line_(line) {
        for (Eigen::Index i = 0; i < std::max<Eigen::Index>(1, line.rows() - 1); i += kBlock) {
            const Eigen::Index n = std::min<Eigen::Index>(kBlock + 1, line.rows() - i);
            const Eigen::Vector2d lo = line.block(i, 0, n, 2).colwise().minCoeff().transpose();
            const Eigen::Vector2d hi = line.block(i, 0, n, 2).colwise().maxCoeff().transpose();
            blocks_.push_back({0.5 * (lo + hi), 0.5 * (hi - lo).norm()});
        }
    }
    /// Or `at_most`, where that is less.
    double distance(const Eigen::Vector2d& p, double at_most = std::numeric_limits<double>::infinity()) {
        double best = at_most;
        const auto look = [&](std::size_t k) {
            if ((p - blocks_[k].centre).norm() - blocks_[k].radius >= best) return;
            const double d = in_block(k, p);
            if (d >= best) return;
            best = d;
            last_ = k;
        };
        look(last_);
        for (std::size_t k = 0; k < blocks_.size(); ++k) look(k);
        return best;
    }

 private:
    static constexpr Eigen::Index kBlock = 16;
    struct Block {
        Eigen::Vector2d centre;
        double radius;
    };
    Eigen::Vector2d point(Eigen::Index i) const { return {line_(i, 0), line_(i, 1)}; }
    double in_block(std::size_t k, const Eigen::Vector2d& p) const {
        const Eigen::Index first = Eigen::Index(k) * kBlock,
                           last = std::min<Eigen::Index>(first + kBlock, line_.rows() - 1);
        double best = (p - point(first)).squaredNorm();
        for (Eigen::Index i = first; i < last; ++i) {
            const Eigen::Vector2d a = point(i), d = point(i + 1) - a;
            const double squared = d.squaredNorm();
            const double t = squared > 0.0 ? std::clamp((p - a).dot(d) / squared, 0.0, 1.0) : 0.0;
            best = std::min(best, (p - a - t * d).squaredNorm());
        }
        return std::sqrt(best);
    }
    const Polyline& line_;
    std::vector<Block> blocks_;
    std::size_t last_ = 0;
};

}  // namespace brushsvg
