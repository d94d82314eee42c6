#include "outline_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "brushsvg/checkpoint.hpp"
#include "painted_edge.hpp"

namespace brushsvg::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

// Lengths are shares of the mark's width. Spacing of places along the target outline, and the most places. At twice the
// spacing corners slip through and the worst strokes lose 0.02 of overlap. At half of it nothing is won in twice the
// time.
constexpr double kPlaceSpacingShare = 0.12;
constexpr double kMaxPlaces = 1500.0;
// How far a simplified outline may be off. At twice the value the worst strokes lose 0.02.
constexpr double kCornerToleranceShare = 0.01;
// Distances below this count squared, larger ones linearly. Otherwise parts that no footprint can reach, like a square
// corner, would outweigh the reachable parts. Half and twice the value do as well.
constexpr double kSquaredDistanceShare = 0.06;

// Weights that keep an unknown where the outline does not determine it: of bends along the path, of turns, of longer
// steps. At half the values some strokes get stuck in a bad place; at twice the values nothing changes.
constexpr double kBendWeight = 0.1, kTurnWeight = 0.05, kLengthWeight = 0.1;

// Levenberg-Marquardt steps, damped as in Ceres (Madsen, Nielsen, Tingleff, Methods for non-linear least squares
// problems, 2004, 3.2). kMinGainShare: share of the predicted gain that a step must reach. kMinVisibleChange: share of
// the value below which a change is too small to see. Ceres itself cannot use that a control shifts the whole path
// behind it.
constexpr double kMinGainShare = 1e-3, kMinVisibleChange = 1e-4;

/// Evenly spaced places along rings.
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
    out.spacing_mm = std::max(spacing_mm, around / kMaxPlaces);
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

/// Value and slope of f(d) = d / (d^2 + c^2)^(1/4). f is smooth and f^2 is near |d|, so a sum of squares is a sum of
/// distances.
struct Root {
    double value, slope;
};
Root root(double d, double c) {
    const double s = d * d + c * c, over = 1.0 / std::sqrt(std::sqrt(s));
    return {d * over, over * (1.0 - 0.5 * d * d / s)};
}

/// Quadratic model of a sum of squares near some unknowns: f + g^T d + d^T H d / 2.
struct QuadraticModel {
    VectorXd slope;
    MatrixXd curvature;  ///< J^T J (Gauss-Newton)
};

/// Half the sum of squares that is minimised.
class OutlineObjective {
 public:
    OutlineObjective(const PatchPath& path, const Brush& brush, const Rings& target, double width)
        : path_(path),
          edge_(brush, kCornerToleranceShare * width),
          target_(target),
          squared_(kSquaredDistanceShare * width),
          places_(places_along(target, kPlaceSpacingShare * width)),
          nearest_(places_.at.size()),
          regularisation_(MatrixXd::Zero(path.unknowns(), path.unknowns())) {
        const Index controls = path.controls(), turns = 2, longer = turns + controls, deeper = longer + controls;
        const Eigen::Vector3d bend(kBendWeight, -2.0 * kBendWeight, kBendWeight);
        for (const Index first : {turns, longer, deeper})
            for (Index at = first; at + 2 < first + controls; ++at)
                regularisation_.block<3, 3>(at, at) += bend * bend.transpose();
        regularisation_.diagonal().segment(turns, controls).array() += kTurnWeight * kTurnWeight;
        regularisation_.diagonal().segment(longer, controls).array() += kLengthWeight * kLengthWeight;
    }

    double value(const VectorXd& x) {
        checkpoint(500);
        samples_ = path_.at(x);
        edge_.place_footprints(samples_);
        residuals_.clear();
        double sum = 0.0;
        const double weight = std::sqrt(places_.spacing_mm);
        const auto add = [&](const EdgePoint& where, double distance_mm, const Vector2d& from) {
            const Root f = root(distance_mm, squared_);
            sum += weight * weight * f.value * f.value;
            residuals_.push_back({where, from, weight * f.value, weight * f.slope});
        };
        for (std::size_t j = 0; j < places_.at.size(); ++j) {
            nearest_[j] = edge_.nearest(places_.at[j], nearest_[j].sample);
            add(nearest_[j], nearest_[j].distance_mm, places_.at[j]);
        }
        place_residuals_ = residuals_.size();
        // no place of the target outline is near a tail that runs far out of it: the first and the last footprint are
        // pulled in as well
        for (const std::size_t i : {std::size_t(0), samples_.size() - 1})
            for (Index k = 0; k < edge_.corners(); ++k) {
                EdgePoint corner;
                corner.sample = i;
                corner.edge = k;
                const Vector2d p = edge_.place_of(corner);
                const EdgePoint found = target_.nearest(p);
                if (found.distance_mm > 0.0) add(corner, found.distance_mm, target_.outwards(p, found));
            }
        return 0.5 * (sum + x.dot(regularisation_ * x));
    }

    /// Return the model about the unknowns for which value() was called last.
    QuadraticModel model_at(const VectorXd& x) const {
        std::vector<SampleSlope> slopes(samples_.size(), SampleSlope::Zero());
        std::vector<Eigen::Matrix4d> squares(samples_.size(), Eigen::Matrix4d::Zero());
        for (std::size_t j = 0; j < residuals_.size(); ++j) {
            const Residual& residual = residuals_[j];
            const SampleSlope by =
                residual.slope * (j < place_residuals_ ? edge_.slope(residual.from, residual.where)
                                                       : edge_.motion_slope(residual.where, residual.from));
            slopes[residual.where.sample] += residual.value * by;
            squares[residual.where.sample] += by * by.transpose();
        }
        QuadraticModel out;
        out.slope = path_.slope(samples_, slopes);
        out.curvature = path_.curvature(samples_, squares);
        out.slope += regularisation_ * x;
        out.curvature += regularisation_;
        return out;
    }

 private:
    /// One of the squares, and its slope by the distance.
    struct Residual {
        EdgePoint where;
        Vector2d from;  ///< the place whose distance it is; for a corner, the outward direction
        double value, slope;
    };

    const PatchPath& path_;
    PaintedEdge edge_;
    FilledRings target_;
    double squared_;
    Places places_;
    std::vector<EdgePoint> nearest_;  ///< the nearest point of the last evaluation
    MatrixXd regularisation_;         ///< the squares that keep unknowns where the outline does not determine them
    PatchSamples samples_;
    std::vector<Residual> residuals_;
    std::size_t place_residuals_ = 0;
};

}  // namespace

VectorXd fit_outline(const PatchPath& path, const Brush& brush, const Rings& target, double width, int iterations,
                     VectorXd x, double trust) {
    OutlineObjective outlines(path, brush, target, width);
    double value = outlines.value(x);
    QuadraticModel model = outlines.model_at(x);
    double damping_growth = 2.0;
    const VectorXd scale = (1.0 + model.curvature.diagonal().array().sqrt()).inverse();  // for each unknown
    for (int iteration = 0; iteration < iterations; ++iteration) {
        const VectorXd diagonal =
            (model.curvature.diagonal().array() * scale.array().square()).max(1e-6) / (trust * scale.array().square());
        MatrixXd damped = model.curvature;
        damped.diagonal() += diagonal;
        const VectorXd step = -damped.llt().solve(model.slope);
        const double predicted_gain = -step.dot(model.slope + 0.5 * model.curvature * step);
        const VectorXd moved = x + step;
        const double now = outlines.value(moved), gain = value - now;
        const bool is_small = std::abs(gain) <= kMinVisibleChange * value;
        if (gain > kMinGainShare * predicted_gain) {
            x = moved;
            value = now;
            if (is_small) break;
            model = outlines.model_at(x);
            trust /= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain / predicted_gain - 1.0, 3));
            damping_growth = 2.0;
        } else {
            if (is_small) break;
            trust /= damping_growth;
            damping_growth *= 2.0;
        }
    }
    return x;
}

}  // namespace brushsvg::fit
