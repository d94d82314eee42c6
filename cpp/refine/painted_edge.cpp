#include "painted_edge.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace brushsvg::fit {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// What is rounded where a box is held against an edge [mm].
constexpr double kRounding = 1e-9;

/// Corners that a polyline cannot do without: the others are no farther from it than the tolerance (Douglas, Peucker).
void keep_corners(const Ring& ring, Index first, Index last, double tolerance, std::vector<bool>& keep) {
    double most = tolerance;
    Index worst = -1;
    const Vector2d a = ring.row(first).transpose(), along = ring.row(last % ring.rows()).transpose() - a;
    const double length2 = along.squaredNorm();
    for (Index i = first + 1; i < last; ++i) {
        const Vector2d p = ring.row(i).transpose() - a;
        const double t = length2 > 0.0 ? std::clamp(p.dot(along) / length2, 0.0, 1.0) : 0.0;
        const double off = (p - t * along).norm();
        if (off > most) {
            most = off;
            worst = i;
        }
    }
    if (worst < 0) return;
    keep[std::size_t(worst)] = true;
    keep_corners(ring, first, worst, tolerance, keep);
    keep_corners(ring, worst, last, tolerance, keep);
}

Ring outline_about_contact(const FootprintTable& table, const Brush& brush, double depth) {
    Ring ring = footprint_at(table, depth, 1.0);
    ring.col(0).array() -= brush.tip_gap(depth);
    return ring;
}

}  // namespace

Edges::Edges(const Rings& rings) {
    Index n = 0;
    for (const Ring& ring : rings) n += ring.rows();
    for (auto* column : {&ax_, &ay_, &bx_, &by_}) column->resize(n);
    Index first = 0;
    for (const Ring& ring : rings) {
        const Index rows = ring.rows();
        for (Index k = 0; k < rows; ++k) {
            const Index next = k + 1 == rows ? 0 : k + 1;
            ax_[first + k] = ring(k, 0);
            ay_[first + k] = ring(k, 1);
            bx_[first + k] = ring(next, 0) - ring(k, 0);
            by_[first + k] = ring(next, 1) - ring(k, 1);
        }
        first += rows;
    }
    over_length2_ = (bx_.square() + by_.square()).max(1e-18).inverse();
    x_per_y_ = (by_.abs() > 1e-12).select(bx_ / by_, 0.0);
}

EdgePoint Edges::nearest(const Vector2d& p) const {
    EdgePoint found;
    double best = 1e300;
    int crossed = 0;
    for (Index k = 0; k < ax_.size(); ++k) {
        const double px = p.x() - ax_[k], py = p.y() - ay_[k], bx = bx_[k], by = by_[k];
        const double t = std::min(1.0, std::max(0.0, (px * bx + py * by) * over_length2_[k]));
        const double dx = px - t * bx, dy = py - t * by, d2 = dx * dx + dy * dy;
        const bool better = d2 < best;
        best = better ? d2 : best;
        found.t = better ? t : found.t;
        found.edge = better ? k : found.edge;
        crossed += int((py < 0.0) != (py < by)) & int(px < x_per_y_[k] * py);
    }
    found.distance_mm = crossed % 2 ? -std::sqrt(best) : std::sqrt(best);
    return found;
}

Vector2d Edges::outwards(const Vector2d& p, const EdgePoint& found) const {
    const Vector2d away = found.distance_mm < 0.0 ? place(found.edge, found.t) - p : p - place(found.edge, found.t);
    if (away.norm() > 1e-6) return away.normalized();
    return Vector2d(by_[found.edge], -bx_[found.edge]).normalized();
}

PaintedEdge::PaintedEdge(const Brush& brush, double tolerance_mm) : brush_(brush) {
    const Index n = brush.footprints.vertex_count();
    std::vector<bool> keep(std::size_t(n), false);
    keep[0] = true;
    for (const Footprint& shape : brush.footprints.dragged) {
        Index far = 0;
        shape.outline_mm.rowwise().squaredNorm().maxCoeff(&far);
        keep[std::size_t(far)] = true;
        keep_corners(shape.outline_mm, 0, far, tolerance_mm, keep);
        keep_corners(shape.outline_mm, far, n, tolerance_mm, keep);
    }
    std::vector<Index> kept;
    for (Index i = 0; i < n; ++i)
        if (keep[std::size_t(i)]) kept.push_back(i);
    for (const Footprint& shape : brush.footprints.dragged) {
        Footprint few{shape.depth_mm, Ring(Index(kept.size()), 2)};
        for (Index i = 0; i < few.outline_mm.rows(); ++i) few.outline_mm.row(i) = shape.outline_mm.row(kept[i]);
        few_.dragged.push_back(std::move(few));
    }
}

void PaintedEdge::place(const PatchSamples& samples) {
    samples_ = samples;
    footprints_.resize(samples.size());
    boxes_.resize(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double c = std::cos(samples[i].heading_rad), s = std::sin(samples[i].heading_rad);
        Eigen::Matrix2d turn;  // of rows
        turn << c, s, -s, c;
        const Ring outline = outline_about_contact(few_, brush_, samples[i].depth_mm);
        const Eigen::RowVector2d least = outline.colwise().minCoeff(), most = outline.colwise().maxCoeff();
        boxes_[i] = {samples[i].contact_mm, {c, s}, least.x(), most.x(), least.y(), most.y()};
        Ring ring = outline * turn;
        ring.rowwise() += samples[i].contact_mm.transpose();
        footprints_[i] = Edges({ring});
    }
}

EdgePoint PaintedEdge::nearest(const Vector2d& p, std::size_t near) const {
    EdgePoint best = footprints_[near].nearest(p);
    best.sample = near;
    for (std::size_t i = 0; i < footprints_.size(); ++i) {
        if (i == near || boxes_[i].at_least_mm(p) >= best.distance_mm + kRounding) continue;
        EdgePoint other = footprints_[i].nearest(p);
        if (other.distance_mm >= best.distance_mm) continue;
        best = other;
        best.sample = i;
    }
    return best;
}

EdgeSlope PaintedEdge::slope(const Vector2d& p, const EdgePoint& found) const {
    return moves(found, -footprints_[found.sample].outwards(p, found));
}

EdgeSlope PaintedEdge::moves(const EdgePoint& place, const Vector2d& direction) const {
    const PatchSample& s = samples_[place.sample];
    const Edges& edges = footprints_[place.sample];
    const Index k = place.edge, next = k + 1 == edges.size() ? 0 : k + 1;
    const Vector2d arm = edges.place(k, place.t) - s.contact_mm;
    constexpr double kStepMm = 1e-4;
    const auto spot = [&](double depth) {
        const Ring r = outline_about_contact(few_, brush_, depth);
        return Vector2d((r.row(k) + place.t * (r.row(next) - r.row(k))).transpose());
    };
    const Vector2d by_depth =
        Eigen::Rotation2Dd(s.heading_rad) * Vector2d((spot(s.depth_mm + kStepMm) - spot(s.depth_mm)) / kStepMm);
    return {direction.x(), direction.y(), direction.y() * arm.x() - direction.x() * arm.y(), direction.dot(by_depth)};
}

}  // namespace brushsvg::fit
