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
constexpr double kSpacing = 0.12;
constexpr double kMostPlaces = 1500.0;
// How far a simplified outline may be off. At twice the value the worst strokes lose 0.02.
constexpr double kCornersOff = 0.01;
// Distances below this count squared, larger ones linearly. Otherwise parts that no footprint can reach, like a square
// corner, would outweigh the reachable parts. Half and twice the value do as well.
constexpr double kSquared = 0.06;

// Weights that keep an unknown where the outline does not determine it: of bends along the path, of turns, of longer
// steps. At half the values some strokes get stuck in a bad place; at twice the values nothing changes.
constexpr double kBends = 0.1, kTurns = 0.05, kLonger = 0.1;

// Levenberg-Marquardt steps, damped as in Ceres (Madsen, Nielsen, Tingleff, Methods for non-linear least squares
// problems, 2004, 3.2). kLeastKept: share of the predicted gain that a step must reach. kSeen: share of the value below
// which a change is too small to see. Ceres itself cannot use that a control shifts the whole path behind it.
constexpr double kLeastKept = 1e-3, kSeen = 1e-4;

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
struct Near {
    VectorXd slope;
    MatrixXd curvature;  ///< J^T J (Gauss-Newton)
};

/// Half the sum of squares that is minimised.
class Outlines {
 public:
    Outlines(const PatchPath& path, const Brush& brush, const Rings& wanted, double width)
        : path_(path),
          edge_(brush, kCornersOff * width),
          wanted_(wanted),
          squared_(kSquared * width),
          places_(places_along(wanted, kSpacing * width)),
          near_(places_.at.size()),
          keeping_(MatrixXd::Zero(path.unknowns(), path.unknowns())) {
        const Index controls = path.controls(), turns = 2, longer = turns + controls, deeper = longer + controls;
        const Eigen::Vector3d bend(kBends, -2.0 * kBends, kBends);
        for (const Index first : {turns, longer, deeper})
            for (Index at = first; at + 2 < first + controls; ++at)
                keeping_.block<3, 3>(at, at) += bend * bend.transpose();
        keeping_.diagonal().segment(turns, controls).array() += kTurns * kTurns;
        keeping_.diagonal().segment(longer, controls).array() += kLonger * kLonger;
    }

    double value(const VectorXd& x) {
        checkpoint(500);
        samples_ = path_.at(x);
        edge_.place(samples_);
        pulls_.clear();
        double sum = 0.0;
        const double weight = std::sqrt(places_.spacing_mm);
        const auto add = [&](const EdgePoint& where, double distance_mm, const Vector2d& from) {
            const Root f = root(distance_mm, squared_);
            sum += weight * weight * f.value * f.value;
            pulls_.push_back({where, from, weight * f.value, weight * f.slope});
        };
        for (std::size_t j = 0; j < places_.at.size(); ++j) {
            near_[j] = edge_.nearest(places_.at[j], near_[j].sample);
            add(near_[j], near_[j].distance_mm, places_.at[j]);
        }
        of_places_ = pulls_.size();
        // no place of the target outline is near a tail that runs far out of it: the first and the last footprint are
        // pulled in as well
        for (const std::size_t i : {std::size_t(0), samples_.size() - 1})
            for (Index k = 0; k < edge_.corners(); ++k) {
                EdgePoint corner;
                corner.sample = i;
                corner.edge = k;
                const Vector2d p = edge_.place_of(corner);
                const EdgePoint found = wanted_.nearest(p);
                if (found.distance_mm > 0.0) add(corner, found.distance_mm, wanted_.outwards(p, found));
            }
        return 0.5 * (sum + x.dot(keeping_ * x));
    }

    /// Return the model about the unknowns for which value() was called last.
    Near near(const VectorXd& x) const {
        std::vector<SampleSlope> slopes(samples_.size(), SampleSlope::Zero());
        std::vector<Eigen::Matrix4d> squares(samples_.size(), Eigen::Matrix4d::Zero());
        for (std::size_t j = 0; j < pulls_.size(); ++j) {
            const Pull& pull = pulls_[j];
            const SampleSlope by =
                pull.slope * (j < of_places_ ? edge_.slope(pull.from, pull.where) : edge_.moves(pull.where, pull.from));
            slopes[pull.where.sample] += pull.value * by;
            squares[pull.where.sample] += by * by.transpose();
        }
        Near out;
        out.slope = path_.slope(samples_, slopes);
        out.curvature = path_.curvature(samples_, squares);
        out.slope += keeping_ * x;
        out.curvature += keeping_;
        return out;
    }

 private:
    /// One of the squares, and its slope by the distance.
    struct Pull {
        EdgePoint where;
        Vector2d from;  ///< the place whose distance it is; for a corner, the outward direction
        double value, slope;
    };

    const PatchPath& path_;
    PaintedEdge edge_;
    Edges wanted_;
    double squared_;
    Places places_;
    std::vector<EdgePoint> near_;  ///< the nearest point of the last evaluation
    MatrixXd keeping_;             ///< the squares that keep unknowns where the outline does not determine them
    PatchSamples samples_;
    std::vector<Pull> pulls_;
    std::size_t of_places_ = 0;
};

}  // namespace

VectorXd fit_outline(const PatchPath& path, const Brush& brush, const Rings& wanted, double width, int iterations,
                     VectorXd x, double trust) {
    Outlines outlines(path, brush, wanted, width);
    double value = outlines.value(x);
    Near near = outlines.near(x);
    double distrust = 2.0;
    const VectorXd scale = (1.0 + near.curvature.diagonal().array().sqrt()).inverse();  // for each unknown
    for (int iteration = 0; iteration < iterations; ++iteration) {
        const VectorXd diagonal =
            (near.curvature.diagonal().array() * scale.array().square()).max(1e-6) / (trust * scale.array().square());
        MatrixXd damped = near.curvature;
        damped.diagonal() += diagonal;
        const VectorXd step = -damped.llt().solve(near.slope);
        const double promised = -step.dot(near.slope + 0.5 * near.curvature * step);
        const VectorXd moved = x + step;
        const double now = outlines.value(moved), won = value - now;
        const bool is_small = std::abs(won) <= kSeen * value;
        if (won > kLeastKept * promised) {
            x = moved;
            value = now;
            if (is_small) break;
            near = outlines.near(x);
            trust /= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * won / promised - 1.0, 3));
            distrust = 2.0;
        } else {
            if (is_small) break;
            trust /= distrust;
            distrust *= 2.0;
        }
    }
    return x;
}

}  // namespace brushsvg::fit
