#include "outline_fit.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include "brushsvg/checkpoint.hpp"
#include "painted_edge.hpp"

namespace brushsvg::fit {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::VectorXd;

// Shares of the mark's width. Places along the wanted outline, and at most so many: at twice the distance corners slip
// through and the worst strokes lose 0.02 of overlap, at half of it nothing is won and it takes twice as long.
constexpr double kSpacing = 0.12;
constexpr double kMostPlaces = 1500.0;
// How far an outline of fewer corners may be off: at twice as much the worst strokes lose 0.02.
constexpr double kCornersOff = 0.01;
// Up to here a distance counts squared, beyond by itself: else what no footprint can reach, like a square corner,
// would outweigh what it can. Twice and half of it do as well.
constexpr double kSquared = 0.06;

// Weights that keep an unknown where the outline says nothing of it: of its bends along the way, of turns, of longer
// steps. At half of them some strokes end in a place they cannot leave, at twice as much nothing changes.
constexpr double kBends = 0.1, kTurns = 0.05, kLonger = 0.1;

/// Places along rings, evenly spaced.
struct Places {
    std::vector<Vector2d> at;
    double spacing_mm;
};

Places places_along(const Rings& rings, double spacing_mm) {
    const auto next = [](const Ring& ring, Index i) { return i + 1 == ring.rows() ? 0 : i + 1; };
    double around = 0.0;
    for (const Ring& ring : rings)
        for (Index i = 0; i < ring.rows(); ++i) around += (ring.row(next(ring, i)) - ring.row(i)).norm();
    Places out;
    out.spacing_mm = std::max(spacing_mm, around / kMostPlaces);
    double ahead = 0.5 * out.spacing_mm;
    for (const Ring& ring : rings)
        for (Index i = 0; i < ring.rows(); ++i) {
            const Vector2d a = ring.row(i).transpose(), by = ring.row(next(ring, i)).transpose() - a;
            const double length = by.norm();
            for (; ahead < length; ahead += out.spacing_mm) out.at.push_back(a + ahead / length * by);
            ahead -= length;
        }
    return out;
}

/// f(d) with f^2 near |d|, so that a sum of squares is a sum of distances; smooth: d / (d^2 + c^2)^(1/4).
struct Root {
    double value, slope;
};
Root root(double d, double c) {
    const double s = d * d + c * c, over = 1.0 / std::sqrt(std::sqrt(s));
    return {d * over, over * (1.0 - 0.5 * d * d / s)};
}

class Outlines : public ceres::CostFunction {
 public:
    Outlines(const PatchPath& path, const Brush& brush, const Rings& wanted, double width)
        : path_(path), edge_(brush, kCornersOff * width), wanted_(wanted), squared_(kSquared * width) {
        edge_.place(path.base());
        corners_ = edge_.footprint(0).size();
        places_ = places_along(wanted, kSpacing * width);
        near_.assign(places_.at.size(), 0);
        const int k = path.controls();
        set_num_residuals(int(places_.at.size()) + 2 * int(corners_) + 3 * (k - 2) + 2 * k);
        mutable_parameter_block_sizes()->push_back(path.unknowns());
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        checkpoint(500);
        const int n = path_.unknowns();
        const VectorXd x = Eigen::Map<const VectorXd>(parameters[0], n);
        const bool derive = jacobians && jacobians[0];
        Eigen::Map<Rows> out(derive ? jacobians[0] : nullptr, derive ? num_residuals() : 0, n);
        if (derive) out.setZero();
        PatchPath::Slopes slopes;
        const PatchSamples samples = derive ? path_.at(x, slopes) : path_.at(x);
        edge_.place(samples);
        const double weight = std::sqrt(places_.spacing_mm);
        int row = 0;
        for (std::size_t j = 0; j < places_.at.size(); ++j, ++row) {
            const EdgePoint found = edge_.nearest(places_.at[j], near_[j]);
            near_[j] = found.sample;
            const Root f = root(found.distance_mm, squared_);
            residuals[row] = weight * f.value;
            if (derive)
                out.row(row) = weight * f.slope * chained(edge_.slope(places_.at[j], found), found.sample, slopes);
        }
        // the wanted outline sees no tail that runs far out of it: the first and the last footprint must not
        for (const std::size_t i : {std::size_t(0), samples.size() - 1})
            for (Index k = 0; k < corners_; ++k, ++row) {
                EdgePoint corner;
                corner.sample = i;
                corner.edge = k;
                const Vector2d p = edge_.footprint(i).place(k, 0.0);
                const EdgePoint found = wanted_.nearest(p);
                const Root f = root(std::max(0.0, found.distance_mm), squared_);
                residuals[row] = weight * f.value;
                if (derive && found.distance_mm > 0.0)
                    out.row(row) =
                        weight * f.slope * chained(edge_.moves(corner, wanted_.outwards(p, found)), i, slopes);
            }
        const int k = path_.controls(), turns = 2, longer = 2 + k;
        for (int first : {turns, longer, 2 + 2 * k})
            for (int at = first + 1; at + 1 < first + k; ++at, ++row) {
                residuals[row] = kBends * (x[at - 1] - 2.0 * x[at] + x[at + 1]);
                if (derive) out.row(row).segment(at - 1, 3) << kBends, -2.0 * kBends, kBends;
            }
        for (const auto& [first, small] : {std::pair(turns, kTurns), std::pair(longer, kLonger)})
            for (int at = first; at < first + k; ++at, ++row) {
                residuals[row] = small * x[at];
                if (derive) out(row, at) = small;
            }
        return true;
    }

 private:
    /// By the unknowns, for one of the samples.
    static Eigen::RowVectorXd chained(const EdgeSlope& d, std::size_t sample, const PatchPath::Slopes& by) {
        const Index i = Index(sample);
        return d.x * by.x.row(i) + d.y * by.y.row(i) + d.heading * by.heading.row(i) + d.depth * by.depth.row(i);
    }

    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const PatchPath& path_;
    mutable PaintedEdge edge_;
    Edges wanted_;
    Index corners_;
    double squared_;
    Places places_;
    mutable std::vector<std::size_t> near_;  ///< whose footprint was nearest the last time
};

}  // namespace

VectorXd fit_outline(const PatchPath& path, const Brush& brush, const Rings& wanted, double width, int iterations,
                     VectorXd x) {
    ceres::Problem problem;
    problem.AddResidualBlock(new Outlines(path, brush, wanted, width), nullptr, x.data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = iterations;
    options.function_tolerance = 1e-4;  // a smaller gain cannot be seen
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;  // strokes run side by side, and sums keep their order
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return x;
}

}  // namespace brushsvg::fit
