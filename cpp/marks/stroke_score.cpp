#include "brushsvg/stroke_score.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/format_text.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/excess_turning.hpp"
#include "brushsvg/target_mark.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr double kLineToleranceMm = 0.01;
constexpr double kRingToleranceMm = 0.01;
constexpr double kMinSquareMm = 0.5;     // least size of the square in which paint and drawing differ most
constexpr int kBlocksPerSquare = 5;      // the square is moved in steps of a fifth of its size
constexpr double kWidthSpacingMm = 0.5;  // spacing of the places where widths are measured
constexpr double kMaxWidths = 20000.0;   // most of these places, on a line of many metres
constexpr double kMaxReachPx = 1e5;      // longest reach in pixels; no picture has more across

/// Sums of values over all squares of a number of blocks, from sums over blocks.
class BlockSums {
 public:
    BlockSums(Index rows, Index columns) : sums_(Sums::Zero(rows + 1, columns + 1)) {}
    double& block(Index row, Index column) { return sums_(row + 1, column + 1); }
    void sum_up() {
        for (Index r = 1; r < sums_.rows(); ++r)
            for (Index c = 1; c < sums_.cols(); ++c)
                sums_(r, c) += sums_(r - 1, c) + sums_(r, c - 1) - sums_(r - 1, c - 1);
    }
    /// Return the largest sum, and where the first block of its square is.
    double largest(Index size, Index& row, Index& column) const {
        double most = -1.0;
        for (Index r = 0; r + size < sums_.rows(); ++r)
            for (Index c = 0; c + size < sums_.cols(); ++c) {
                const double here = sums_(r + size, c + size) - sums_(r, c + size) - sums_(r + size, c) + sums_(r, c);
                if (here <= most) continue;
                most = here;
                row = r;
                column = c;
            }
        return most;
    }

 private:
    // row by row, as it is read
    using Sums = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Sums sums_;
};

/// Interpolate the share at a place between the middles of pixels, linear in both directions; 0 outside.
double share_at(const Coverage& shares, const MarkOverlap& seen, const Vector2d& at_mm) {
    const double x = (at_mm.x() - seen.window.x_mm) * seen.px_per_mm - 0.5;
    const double y = (seen.window.y_mm + seen.window.height_mm - at_mm.y()) * seen.px_per_mm - 0.5;
    if (!(x >= 0.0 && x < double(shares.cols() - 1) && y >= 0.0 && y < double(shares.rows() - 1))) return 0.0;
    const Index c = Index(x), r = Index(y);
    const double fx = x - double(c), fy = y - double(r);
    return (1.0 - fy) * ((1.0 - fx) * shares(r, c) + fx * shares(r, c + 1)) +
           fy * ((1.0 - fx) * shares(r + 1, c) + fx * shares(r + 1, c + 1));
}

double median_half_width(const MiddlePolyline& line) {
    std::vector<double> halves(line.rows());
    for (Index i = 0; i < line.rows(); ++i) halves[std::size_t(i)] = line(i, 3);
    const auto middle = halves.begin() + std::ptrdiff_t(halves.size() / 2);
    std::nth_element(halves.begin(), middle, halves.end());
    return *middle;
}

}  // namespace

WorstPlace worst_place(const MarkOverlap& seen, double size_mm) {
    const Index height = seen.target.rows(), width = seen.target.cols();
    if (height == 0 || width == 0 || seen.painted.rows() != height || seen.painted.cols() != width)
        throw Error("sizes-differ", "the pictures of paint and drawing are empty or differ in size");
    if (!(size_mm * seen.px_per_mm >= 0.0 && size_mm * seen.px_per_mm <= 1e15))
        throw Error("out-of-range",
                    format_text("the size of the square is %.4g mm, but must be at least 0 and finite", size_mm), "",
                    size_mm);
    const Index block = std::clamp(Index(std::lround(size_mm * seen.px_per_mm / kBlocksPerSquare)), Index(1),
                                   std::min(height, width));  // the remainder at the edges is paper
    const Index rows = height / block, columns = width / block;
    const Index size =
        std::clamp(Index(std::lround(size_mm * seen.px_per_mm / double(block))), Index(1), std::min(rows, columns));
    BlockSums missing(rows, columns), spilt(rows, columns);
    for (Index y = 0; y < rows * block; ++y)
        for (Index c = 0; c < columns; ++c) {
            float less = 0.0f, more = 0.0f;
            for (Index x = c * block; x < (c + 1) * block; ++x) {
                const float difference = seen.target(y, x) - seen.painted(y, x);
                less += std::max(difference, 0.0f);
                more += std::max(-difference, 0.0f);
            }
            missing.block(y / block, c) += less;
            spilt.block(y / block, c) += more;
        }
    missing.sum_up();
    spilt.sum_up();
    Index row = 0, column = 0, spilt_row = 0, spilt_column = 0;
    double most = missing.largest(size, row, column);
    const double most_spilt = spilt.largest(size, spilt_row, spilt_column);
    const bool is_missing = most >= most_spilt;
    if (!is_missing) {
        most = most_spilt;
        row = spilt_row;
        column = spilt_column;
    }
    const auto middle_mm = [&](Index first) {
        return (double(first) + 0.5 * double(size)) * double(block) / seen.px_per_mm;
    };
    return {{seen.window.x_mm + middle_mm(column), seen.window.y_mm + seen.window.height_mm - middle_mm(row)},
            is_missing,
            most / (seen.px_per_mm * seen.px_per_mm)};
}

double width_across(const Coverage& shares, const MarkOverlap& seen, const Vector2d& at_mm, const Vector2d& direction,
                    double reach_mm) {
    if (!at_mm.allFinite() || !direction.allFinite() || std::isnan(reach_mm) || !(seen.px_per_mm > 0.0))
        throw Error("not-finite",
                    "the point, the direction, the reach or the scale of the picture is not a valid number");
    const double step_mm = 1.0 / seen.px_per_mm;
    const Vector2d across = step_mm * Vector2d(-direction.y(), direction.x());
    const auto share = [&](int k) { return share_at(shares, seen, at_mm + double(k) * across); };
    const int most = int(std::clamp(std::ceil(reach_mm * seen.px_per_mm), 0.0, kMaxReachPx));
    int inside = 0;  // the nearest place that is painted: 0, -1, 1, -2, 2 ...
    while (inside <= most && !(share(inside) > 0.5)) inside = inside < 0 ? -inside : -inside - 1;
    if (inside > most) return 0.0;
    const auto edge = [&](int towards) {  // how far from the point the share passes one half
        int last = inside;
        double within = share(last), beyond = within;
        while (std::abs(last) <= most && (beyond = share(last + towards)) > 0.5) {
            last += towards;
            within = beyond;
        }
        if (beyond > 0.5) return double(last);
        return last + towards * (within - 0.5) / std::max(within - beyond, 1e-9);
    };
    return step_mm * (edge(1) - edge(-1));
}

std::optional<double> width_error_mm(const MarkOverlap& seen, const MiddlePolyline& line) {
    if (line.rows() == 0) return {};
    const double length = line(line.rows() - 1, 2);
    if (!(length > 0.0)) return {};
    const double reach = 2.0 * line.col(3).maxCoeff() + 4.0 / seen.px_per_mm;
    double sum = 0.0;
    int count = 0;
    Index segment = 0;
    const double every_mm = std::max(kWidthSpacingMm, length / kMaxWidths);
    for (double at = 0.5 * every_mm; at < length; at += every_mm) {
        checkpoint(5);
        while (segment + 2 < line.rows() && line(segment + 1, 2) <= at) ++segment;
        const Vector2d from = line.row(segment).head<2>().transpose(), to = line.row(segment + 1).head<2>().transpose();
        const double t = (at - line(segment, 2)) / (line(segment + 1, 2) - line(segment, 2));
        const double half = line(segment, 3) + t * (line(segment + 1, 3) - line(segment, 3));
        if (!((to - from).norm() > 0.0) || !(half > 0.0)) continue;
        const Vector2d place = from + t * (to - from), direction = (to - from).normalized();
        const double target = width_across(seen.target, seen, place, direction, reach);
        if (!(std::abs(target - 2.0 * half) < 0.1 * half + 0.05)) continue;
        sum += std::abs(width_across(seen.painted, seen, place, direction, reach) - target);
        ++count;
    }
    if (count == 0) return {};
    return sum / count;
}

StrokeScore stroke_score(const PassMarks& painted, const Stroke& target, const Brush& brush) {
    const MarkOverlap seen = mark_overlap({painted}, {target}, brush);
    const MiddlePolyline line = flatten(target, kLineToleranceMm);
    return {common_area(seen).overlap(), width_error_mm(seen, line),
            excess_turning(outline(painted, brush), target_outline(target, kRingToleranceMm)),
            worst_place(seen, std::max(kMinSquareMm, median_half_width(line)))};
}

}  // namespace brushsvg
