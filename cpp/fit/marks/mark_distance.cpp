#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "brushsvg/checkpoint.hpp"
#include "mark_model.hpp"
#include "swept_footprints.hpp"

namespace brushsvg::fit {
namespace {

// Levers shorter than this have damped derivatives. When a leaning machine presses a brush on the spot, the brush
// points along a lever of micrometres. It turns around completely if the lean changes by micrometres. Derivatives that
// are valid only over micrometres would make the lean seem known to micrometres.
constexpr double kDampedLeverMm = 0.3;
// Size of a brush's hairs. If the way out is shorter, no other way is tried. If an edge is further away, its distance
// is not refined.
constexpr double kHairSizeMm = 0.5;
constexpr int kMaxPerpendicularRounds = 3;       // rounds in which a way out is made perpendicular to the edge
constexpr double kPerpendicularCosine = 0.9999;  // cosine above which a way out is perpendicular
constexpr double kMinEdgeCosine = 0.3;  // cosine below which an edge is met too obliquely to refine the distance

/// Counts the work spent on finding the edges of one mark.
struct EvaluationCounter {
    const Footprints& on;
    std::uint64_t& evaluations;
    ~EvaluationCounter() { evaluations += on.evaluations(); }
};

/// The predicted edge next to one point of a painted one.
struct PredictedEdge {
    NearestEdge edge;
    std::size_t row;
    double distance_mm;
    Eigen::Vector2d normal;  ///< of the edge of the swept area
    double edge_cosine;      ///< cosine between the painted edge's normal and the predicted one's
};

/// Returns the normal of the swept edge across the motion of the footprint's edge.
///
/// Instants keep the TCP's position while the laws change, so that the edge swept by a footprint shifts along itself.
/// Only movements across the direction of motion move the swept edge.
Eigen::Vector2d normal_across_motion(const Footprints& footprints, std::size_t row, const SweptEdge& swept) {
    const Eigen::Vector2d along = footprints.motion_direction(row, swept.edge);
    const Eigen::Vector2d across = swept.normal - swept.normal.dot(along) * along;
    return across.squaredNorm() > kMinEdgeCosine * kMinEdgeCosine ? across.normalized() : swept.normal;
}

/// Returns the edge through which the way from x along `out` leaves footprint `row`, at distance `far`, and its
/// neighbours.
PredictedEdge exit_edge(const Footprints& footprints, const Eigen::Vector2d& x, const Eigen::Vector2d& out, double far,
                        std::size_t row) {
    const Eigen::Vector2d end = x + far * out, at = footprints[row].in_frame(end);
    const NearestEdge own = nearest_edge(footprints[row].drop, at.x(), at.y());
    const SweptEdge swept = footprints.swept_edge(end, row, own);
    const Eigen::Vector2d across = normal_across_motion(footprints, row, swept);
    const double edge_cosine = std::max(kMinEdgeCosine, across.dot(out));
    return {swept.edge, row, -far + std::min(0.0, swept.distance) / edge_cosine, across, edge_cosine};
}

/// Returns the edge for x inside a footprint, along the normal of the painted edge, or along a shorter way where the
/// edge is far. Outside the footprints, too, the shortest way counts.
PredictedEdge find_edge_from_inside(const Footprints& footprints, const Eigen::Vector2d& x,
                                    const Eigen::Vector2d& normal, std::size_t row) {
    Eigen::Vector2d out = normal;
    double far = footprints.distance_to_outside(x, out, row);
    if (far > kHairSizeMm) {
        const Eigen::Vector2d across(-normal.y(), normal.x());
        for (const auto& way : {Eigen::Vector2d(-normal), Eigen::Vector2d(0.5 * normal + 0.866 * across),
                                Eigen::Vector2d(0.5 * normal - 0.866 * across)}) {
            std::size_t other = row;
            const double length = footprints.distance_to_outside(x, way.normalized(), other);
            if (length >= far) continue;
            far = length;
            out = way.normalized();
            row = other;
        }
    }
    PredictedEdge found = exit_edge(footprints, x, out, far, row);
    // The painted normal has the errors of the painted edge. Perpendicular to the edge that was reached, the way is
    // shorter.
    for (int round = 0;
         round < kMaxPerpendicularRounds && far < kHairSizeMm && found.edge_cosine < kPerpendicularCosine; ++round) {
        const Eigen::Vector2d square = found.normal;
        far = footprints.distance_to_outside(x, square, row);
        const PredictedEdge other = exit_edge(footprints, x, square, far, row);
        if (!(other.distance_mm > found.distance_mm) || !(other.normal.dot(square) > kMinEdgeCosine)) break;
        found = other;
    }
    return found;
}

/// Returns the edge for x outside all footprints.
PredictedEdge find_edge_from_outside(const Footprints& footprints, const Eigen::Vector2d& x,
                                     const Eigen::Vector2d& normal, std::size_t row, const NearestEdge& nearest) {
    const Instant& here = footprints[row];
    if (nearest.distance > kHairSizeMm) {
        const SweptEdge alone{nearest.distance, here.on_paper(nearest), nearest};
        return {nearest, row, nearest.distance, normal_across_motion(footprints, row, alone), 1.0};
    }
    const bool tip = nearest.by_widest == 0.0 && !here.drop.round_tail;
    const Eigen::Vector2d at = here.in_frame(x);
    // At a tip, the distance from its flanks counts, as on the inside. Otherwise edges with errors to both sides would
    // make the tip longer.
    SweptEdge swept = footprints.swept_edge(x, row, tip ? flank_beyond_tip(here.drop, at.x(), at.y()) : nearest);
    if (swept.normal.dot(normal) < -kMinEdgeCosine) {
        // An edge of a hairline with a larger inward error is on the hairline's other side.
        const SweptEdge across = footprints.swept_edge(x, row, here.farthest(-swept.normal));
        if (std::abs(across.distance) < kHairSizeMm) swept = across;
    }
    return {swept.edge, row, swept.distance, normal_across_motion(footprints, row, swept), 1.0};
}

/// Returns the predicted edge next to x. normal: outward normal of the painted edge. The search begins at `row`.
PredictedEdge find_predicted_edge(const Footprints& footprints, const Eigen::Vector2d& x, const Eigen::Vector2d& normal,
                                  std::size_t row) {
    const NearestEdge nearest = footprints.nearest(x, row);
    return nearest.distance < 0.0 ? find_edge_from_inside(footprints, x, normal, row)
                                  : find_edge_from_outside(footprints, x, normal, row, nearest);
}

}  // namespace

bool MarkModel::distances(Index mark, const double* shared_data, const double* displacement, VectorXd& distance_mm,
                          RowMajor* by_shared, RowMajor* by_displacement) const {
    const Painted& painted = painted_[std::size_t(mark)];
    const VectorXd shared = Eigen::Map<const VectorXd>(shared_data, layout_.size());
    thread_local Footprints footprints;
    thread_local std::vector<PredictedEdge> predicted;
    const EvaluationCounter counter{footprints, evaluations_[std::size_t(mark)]};
    const MarkLaws laws = this->laws(shared);
    const MachineState machine = machine_state(painted, shared);
    const PassSetup pass{painted.poses_mm,         painted.arcs, laws,
                         shared[layout_.height()], deepest_,     layout_.machine_numbers > 0 ? &machine : nullptr};
    if (!footprints.follow(pass, painted.at, coarse_)) return false;
    const Ring points = points_in_plan_frame(mark, shared_data, displacement);
    const double turn = shared[layout_.turn()], ct = std::cos(turn), st = std::sin(turn);
    Eigen::Matrix2d back, back_by_turn;
    back << ct, st, -st, ct;
    back_by_turn << -st, ct, -ct, -st;
    distance_mm.resize(points.rows());
    predicted.resize(std::size_t(points.rows()));
    std::vector<std::size_t> rows;
    std::size_t row = 0;
    for (Index k = 0; k < points.rows(); ++k) {
        checkpoint(footprints.search_cost());
        const Eigen::Vector2d x = points.row(k).transpose();
        PredictedEdge& here = predicted[std::size_t(k)];
        here = find_predicted_edge(footprints, x, back * painted.outward.row(k).transpose(), row);
        rows.push_back(row = here.row);
        distance_mm[k] = here.distance_mm;
    }
    if (!by_shared) return distance_mm.allFinite();
    footprints.derive(pass, lag_powers_, !is_machine_held_, std::move(rows));
    for (Index k = 0; k < points.rows(); ++k) {
        const PredictedEdge& here = predicted[std::size_t(k)];
        const Eigen::RowVector2d normal = here.normal.transpose();
        law_derivatives(footprints[here.row], footprints.derivatives(here.row), here.edge, here.normal,
                        by_shared->row(k));
        by_shared->row(k).segment<2>(layout_.shift()) = -normal * back;
        const Eigen::Vector2d seen = painted.point_mm.row(k).transpose() - shared.segment<2>(layout_.shift()) - centre_;
        (*by_shared)(k, layout_.turn()) = normal * back_by_turn * seen;
        by_shared->row(k) /= here.edge_cosine;
        if (by_displacement) by_displacement->row(k) = -normal / here.edge_cosine;
    }
    return distance_mm.allFinite();
}

VectorXd MarkModel::widths(Index mark, const double* shared_data, const double* displacement) const {
    constexpr double kInsideStepMm = 1e-3;
    const Painted& painted = painted_[std::size_t(mark)];
    const VectorXd shared = Eigen::Map<const VectorXd>(shared_data, layout_.size());
    VectorXd out = VectorXd::Zero(painted.point_mm.rows());
    thread_local Footprints footprints;
    const EvaluationCounter counter{footprints, evaluations_[std::size_t(mark)]};
    const MarkLaws laws = this->laws(shared);
    const MachineState machine = machine_state(painted, shared);
    const PassSetup pass{painted.poses_mm,         painted.arcs, laws,
                         shared[layout_.height()], deepest_,     layout_.machine_numbers > 0 ? &machine : nullptr};
    if (!footprints.follow(pass, painted.at, coarse_)) return out;
    const Ring points = points_in_plan_frame(mark, shared_data, displacement);
    const Eigen::Rotation2Dd back(-shared[layout_.turn()]);
    std::size_t row = 0;
    for (Index k = 0; k < points.rows(); ++k) {
        checkpoint(footprints.search_cost());
        const PredictedEdge predicted =
            find_predicted_edge(footprints, points.row(k).transpose(), back * painted.outward.row(k).transpose(), row);
        row = predicted.row;
        const Eigen::Vector2d edge = footprints[row].place_of(predicted.edge);
        std::size_t last = row;
        out[k] = footprints.distance_to_outside(edge - kInsideStepMm * predicted.normal, -predicted.normal, last);
    }
    return out;
}

void MarkModel::law_derivatives(const Instant& now, const InstantDerivatives& by, const NearestEdge& edge,
                                const Eigen::Vector2d& normal, Eigen::Ref<Eigen::RowVectorXd> out) const {
    const Eigen::Vector2d u = now.heading, left(-u.y(), u.x());
    const double nu = normal.dot(u), nl = normal.dot(left);
    PathDerivatives heading_by = by.heading, left_by;
    if (loose_headings_damped_ && std::isfinite(now.loose_lever_mm)) {
        const double lever2 = now.loose_lever_mm * now.loose_lever_mm;
        heading_by.rightCols<kMachineErrors>() *= lever2 / (lever2 + kDampedLeverMm * kDampedLeverMm);
    }
    left_by << -heading_by.row(1), heading_by.row(0);
    // If the edge moves outwards by normal . dy, the distance decreases by normal . dy.
    const Eigen::Matrix<double, 1, kPathUnknowns> moved =
        normal.transpose() * (by.contact + (edge.x - now.gap) * heading_by + edge.y * left_by);
    out.head(layout_.lag) = -moved.head(layout_.lag);
    // Derivatives of the edge's x and y by the half width, along the normal.
    const double along = edge.by_widest * now.widest_ratio + edge.by_front * now.front_ratio;
    const double per_half = along * nu + edge.by_half * nl;
    double power = 1.0;
    for (int j = 0; j < layout_.gap; ++j) {
        power *= now.depth / deepest_;
        out[layout_.gap_at() + j] = power * nu;
    }
    for (int j = 0; j < layout_.half; ++j) {
        double step = 0.0;
        for (Index i = half_powers_.rows(); i-- > 0;) step = step * now.depth + half_powers_(i, j);
        out[layout_.half_at() + j] = -step * per_half;
    }
    const double half_nu = now.drop.half * nu;
    ratio_derivatives(now.depth, now.widest_ratio, -edge.by_widest * half_nu,
                      out.segment(layout_.widest(), layout_.widest_terms));
    ratio_derivatives(now.depth, now.front_ratio, -edge.by_front * half_nu,
                      out.segment(layout_.front(), layout_.front_terms));
    const double longer = edge.by_widest * now.widest_slope + edge.by_front * now.front_slope;
    const double deeper = now.half_slope * per_half - now.gap_slope * nu + longer * half_nu;
    out[layout_.height()] = -moved[kMaxTerms] - by.depth[0] * deeper;
    for (int i = 0; i < layout_.machine_numbers; ++i)
        out[layout_.machine() + i] = -moved[kMaxTerms + 1 + i] - by.depth[1 + i] * deeper;
}

void MarkModel::ratio_derivatives(double depth, double ratio, double rate, Eigen::Ref<Eigen::RowVectorXd> out) const {
    out.setZero();
    if (out.size() > 1 && ratio <= kMinRatio) return;
    // The Legendre polynomials P_k over [0, deepest] at this depth, by their recurrence.
    const double t = 2.0 * depth / deepest_ - 1.0;
    double before = 0.0, now = 1.0;
    for (Index k = 0; k < out.size(); ++k) {
        out[k] = rate * now;
        const double next = ((2.0 * double(k) + 1.0) * t * now - double(k) * before) / (double(k) + 1.0);
        before = now;
        now = next;
    }
}

Ring MarkModel::points_in_plan_frame(Index mark, const double* shared, const double* displacement) const {
    const Eigen::Vector2d shift(shared[layout_.shift()], shared[layout_.shift() + 1]);
    const double turn = shared[layout_.turn()];
    Eigen::Matrix2d back;
    back << std::cos(turn), std::sin(turn), -std::sin(turn), std::cos(turn);
    Ring out = painted_[std::size_t(mark)].point_mm;
    for (Index k = 0; k < out.rows(); ++k) {
        const Eigen::Vector2d seen = out.row(k).transpose() - shift - centre_;
        out.row(k) = (centre_ + back * seen - Eigen::Vector2d(displacement[0], displacement[1])).transpose();
    }
    return out;
}

}  // namespace brushsvg::fit
