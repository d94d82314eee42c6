#include "marks/coverage_contours.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::RowVector2d;

/// Marching squares between the middles of four pixels, with blank pixels round the picture. A crossing is between two
/// pixels, to the right of one (even index) or below it (odd). Lines keep the painted side to their left.
class Squares {
 public:
    explicit Squares(const Coverage& picture)
        : picture_(picture),
          columns_(picture.cols() + 2),
          next_(std::size_t(2 * columns_ * (picture.rows() + 2)), Index(-1)) {
        for (Index row = 0; row <= picture.rows(); ++row)
            for (Index column = 0; column <= picture.cols(); ++column) cross(row, column);
    }
    /// Return rings of places (x, y) in pixels, y down, from the middle of the upper left pixel of the picture.
    Rings rings() {
        Rings out;
        for (Index first = 0; first < Index(next_.size()); ++first) {
            if (next_[std::size_t(first)] < 0) continue;
            std::vector<RowVector2d> places;
            for (Index at = first; next_[std::size_t(at)] >= 0;) {
                places.push_back(place(at));
                const Index to = next_[std::size_t(at)];
                next_[std::size_t(at)] = -1;
                at = to;
            }
            Ring ring(Index(places.size()), 2);
            for (Index i = 0; i < ring.rows(); ++i) ring.row(i) = places[std::size_t(i)];
            out.push_back(std::move(ring));
        }
        return out;
    }

 private:
    float share(Index row, Index column) const {
        if (row < 1 || column < 1 || row > picture_.rows() || column > picture_.cols()) return 0.0f;
        return picture_(row - 1, column - 1);
    }
    Index right_of(Index row, Index column) const { return 2 * (row * columns_ + column); }
    Index below(Index row, Index column) const { return right_of(row, column) + 1; }

    /// Add the lines through a square, given its upper left corner.
    void cross(Index row, Index column) {
        const std::array<float, 4> corners{share(row + 1, column), share(row + 1, column + 1), share(row, column + 1),
                                           share(row, column)};  // counter-clockwise from the lower left
        const std::array<Index, 4> sides{right_of(row + 1, column), below(row, column + 1), right_of(row, column),
                                         below(row, column)};  // each after its corner
        const auto inside = [&](std::size_t k) { return corners[k % 4] > kHalfCoverage; };
        const bool middle = corners[0] + corners[1] + corners[2] + corners[3] > 4.0f * kHalfCoverage;
        for (std::size_t k = 0; k < 4; ++k) {
            if (!inside(k) || inside(k + 1)) continue;
            // go round the blank corners where the middle is painted, else round the painted corners
            std::size_t to = k + (middle ? 1 : 3);
            while (inside(to) || !inside(to + 1)) to += middle ? 1 : 3;
            next_[std::size_t(sides[k])] = sides[to % 4];
        }
    }
    RowVector2d place(Index crossing) const {
        const Index row = crossing / 2 / columns_, column = crossing / 2 % columns_;
        const bool across = crossing % 2 == 0;
        const float a = share(row, column), b = across ? share(row, column + 1) : share(row + 1, column);
        const double t = double((kHalfCoverage - a) / (b - a));
        return {double(column - 1) + (across ? t : 0.0), double(row - 1) + (across ? 0.0 : t)};
    }

    const Coverage& picture_;
    Index columns_;
    std::vector<Index> next_;
};

}  // namespace

Rings trace_half_coverage(const Coverage& picture, const Window& window, double px_per_mm) {
    Rings rings = Squares(picture).rings();
    for (Ring& ring : rings) {
        ring.col(0) = window.x_mm + (ring.col(0).array() + 0.5) / px_per_mm;
        ring.col(1) = window.y_mm + window.height_mm - (ring.col(1).array() + 0.5) / px_per_mm;
    }
    return rings;
}

}  // namespace brushsvg
