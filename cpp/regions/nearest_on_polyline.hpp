#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg {

/// Most points that are visited between the rows of one polyline: kilometres of it are visited less densely.
constexpr double kMaxVisitedPoints = 2e5;

/// Call `visit` with the points of rows `begin` to `end` of a polyline, and with points between them. No two points are
/// further apart than the step, so that a curve between two rows is not missed.
template <class Points, class Visit>
void visit_along(const Points& rows, Eigen::Index begin, Eigen::Index end, double step_mm, Visit&& visit) {
    double length = 0.0;
    for (Eigen::Index i = begin + 1; i < end; ++i) length += (rows.row(i) - rows.row(i - 1)).norm();
    step_mm = std::max(step_mm, length / kMaxVisitedPoints);
    for (Eigen::Index i = begin; i < end; ++i) {
        const Eigen::Vector2d here = rows.row(i).transpose();
        if (i > begin) {
            const Eigen::Vector2d before = rows.row(i - 1).transpose();
            const int n = int(std::min(1e4, std::ceil((here - before).norm() / step_mm)));
            checkpoint(1 + n);
            for (int k = 1; k < n; ++k) visit(Eigen::Vector2d(before + double(k) / n * (here - before)));
        }
        visit(here);
    }
}

/// Distance to a polyline (columns x, y and any others), found in a tree of boxes about its pieces. Fast if successive
/// queries are close to each other.
template <class Polyline>
class NearestOnPolyline {
 public:
    explicit NearestOnPolyline(const Polyline& line) : line_(line) {
        levels_.emplace_back();
        for (Eigen::Index i = 0; i < std::max<Eigen::Index>(1, line.rows() - 1); i += kFanOut) {
            const Eigen::Index n = std::min<Eigen::Index>(kFanOut + 1, line.rows() - i);
            if (n <= 0) break;
            pieces_.push_back(make_pieces(i, n));
            const Eigen::Vector2d lo = line.block(i, 0, n, 2).colwise().minCoeff().transpose();
            const Eigen::Vector2d hi = line.block(i, 0, n, 2).colwise().maxCoeff().transpose();
            levels_[0].push_back({lo, hi});
        }
        while (levels_.back().size() > std::size_t(kFanOut)) {
            const std::vector<Block>& below = levels_.back();
            std::vector<Block> next;
            for (std::size_t k = 0; k < below.size(); ++k) {
                if (k % kFanOut == 0) next.push_back(below[k]);
                next.back().lo = next.back().lo.cwiseMin(below[k].lo);
                next.back().hi = next.back().hi.cwiseMax(below[k].hi);
            }
            levels_.push_back(std::move(next));
        }
    }
    /// Return the distance of a point, or `at_most` if that is less. Infinite for a line without points.
    double distance(const Eigen::Vector2d& p, double at_most = std::numeric_limits<double>::infinity()) {
        double best = at_most;
        if (!levels_[0].empty()) search_block(0, last_, p, best);
        for (std::size_t k = 0; k < levels_.back().size(); ++k) search_block(levels_.size() - 1, k, p, best);
        return best;
    }

 private:
    static constexpr Eigen::Index kFanOut = 16;
    struct Block {
        Eigen::Vector2d lo, hi;

        double distance(const Eigen::Vector2d& p) const { return (lo - p).cwiseMax(p - hi).cwiseMax(0.0).norm(); }
    };
    /// Numbers of one block, side by side: vector instructions process several at once.
    using Numbers = Eigen::Array<double, kFanOut, 1>;
    struct Pieces {
        Numbers x, y, dx, dy, squared;
    };
    void search_block(std::size_t level, std::size_t k, const Eigen::Vector2d& p, double& best) {
        if (levels_[level][k].distance(p) >= best) return;
        if (level > 0) {
            const std::size_t end = std::min(levels_[level - 1].size(), (k + 1) * kFanOut);
            for (std::size_t below = k * kFanOut; below < end; ++below) search_block(level - 1, below, p, best);
            return;
        }
        const double d = distance_in_block(k, p);
        if (d >= best) return;
        best = d;
        last_ = k;
    }
    Eigen::Vector2d point(Eigen::Index i) const { return {line_(i, 0), line_(i, 1)}; }
    double distance_in_block(std::size_t k, const Eigen::Vector2d& p) const {
        const Pieces& all = pieces_[k];
        const Numbers x = p.x() - all.x, y = p.y() - all.y;
        const Numbers t = ((x * all.dx + y * all.dy) / all.squared).max(0.0).min(1.0);
        return std::sqrt(
            std::min(x[0] * x[0] + y[0] * y[0], ((x - t * all.dx).square() + (y - t * all.dy).square()).minCoeff()));
    }
    /// Return the pieces between `n` points from `first` on. Pieces without a length, and those after the last one, are
    /// points.
    Pieces make_pieces(Eigen::Index first, Eigen::Index n) const {
        Pieces out;
        for (Eigen::Index k = 0; k < kFanOut; ++k) {
            const Eigen::Vector2d a = point(first + std::min(k, n - 1)), d = point(first + std::min(k + 1, n - 1)) - a;
            const double squared = d.squaredNorm();
            const bool is_point = !(squared > 0.0);
            out.x[k] = a.x();
            out.y[k] = a.y();
            out.dx[k] = is_point ? 0.0 : d.x();
            out.dy[k] = is_point ? 0.0 : d.y();
            out.squared[k] = is_point ? 1.0 : squared;
        }
        return out;
    }
    const Polyline& line_;
    std::vector<Pieces> pieces_;
    /// Boxes of kFanOut segments, then of kFanOut boxes of the level before.
    std::vector<std::vector<Block>> levels_;
    std::size_t last_ = 0;
};

}  // namespace brushsvg
