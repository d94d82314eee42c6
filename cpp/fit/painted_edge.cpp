#include "painted_edge.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace brushsvg::fit {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

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
    outlines_.resize(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double c = std::cos(samples[i].heading_rad), s = std::sin(samples[i].heading_rad);
        const Ring ring = outline_about_contact(few_, brush_, samples[i].depth_mm);
        Outline& o = outlines_[i];
        o.ax = samples[i].contact_mm.x() + c * ring.col(0).array() - s * ring.col(1).array();
        o.ay = samples[i].contact_mm.y() + s * ring.col(0).array() + c * ring.col(1).array();
        const Index n = ring.rows();
        o.bx.resize(n);
        o.by.resize(n);
        o.bx.head(n - 1) = o.ax.tail(n - 1) - o.ax.head(n - 1);
        o.by.head(n - 1) = o.ay.tail(n - 1) - o.ay.head(n - 1);
        o.bx[n - 1] = o.ax[0] - o.ax[n - 1];
        o.by[n - 1] = o.ay[0] - o.ay[n - 1];
        o.over_length2 = (o.bx.square() + o.by.square()).max(1e-18).inverse();
        o.x_per_y = (o.by.abs() > 1e-12).select(o.bx / o.by, 0.0);
        o.centre = {o.ax.mean(), o.ay.mean()};
        o.radius = std::sqrt(((o.ax - o.centre.x()).square() + (o.ay - o.centre.y()).square()).maxCoeff());
    }
}

double PaintedEdge::to_outline(const Outline& o, const Vector2d& p, EdgePoint& found) const {
    const Index n = o.ax.size();
    double best = 1e300, best_t = 0.0;
    Index edge = 0;
    int crossed = 0;
    for (Index k = 0; k < n; ++k) {
        const double px = p.x() - o.ax[k], py = p.y() - o.ay[k], bx = o.bx[k], by = o.by[k];
        const double t = std::min(1.0, std::max(0.0, (px * bx + py * by) * o.over_length2[k]));
        const double dx = px - t * bx, dy = py - t * by, d2 = dx * dx + dy * dy;
        const bool better = d2 < best;
        best = better ? d2 : best;
        best_t = better ? t : best_t;
        edge = better ? k : edge;
        crossed += int((py < 0.0) != (py < by)) & int(px < o.x_per_y[k] * py);
    }
    found.edge = edge;
    found.t = best_t;
    found.distance_mm = crossed % 2 ? -std::sqrt(best) : std::sqrt(best);
    return found.distance_mm;
}

EdgePoint PaintedEdge::nearest(const Vector2d& p, std::size_t near) const {
    EdgePoint best, other;
    best.sample = near;
    to_outline(outlines_[near], p, best);
    for (std::size_t i = 0; i < outlines_.size(); ++i) {
        // outside no nearer than its circle; inside no deeper than the point lies in the circle
        const double reach = best.distance_mm + outlines_[i].radius;
        if (reach <= 0.0 || (p - outlines_[i].centre).squaredNorm() >= reach * reach || i == near) continue;
        if (to_outline(outlines_[i], p, other) >= best.distance_mm) continue;
        best = other;
        best.sample = i;
    }
    return best;
}

EdgeSlope PaintedEdge::slope(const Vector2d& p, const EdgePoint& found) const {
    const PatchSample& s = samples_[found.sample];
    const Outline& o = outlines_[found.sample];
    const Index k = found.edge, next = k + 1 == o.ax.size() ? 0 : k + 1;
    const Vector2d along(o.bx[k], o.by[k]), on = Vector2d(o.ax[k], o.ay[k]) + found.t * along, arm = on - s.contact_mm;
    Vector2d outwards = found.distance_mm < 0.0 ? on - p : p - on;
    if (outwards.norm() > 1e-6)
        outwards.normalize();
    else
        outwards = Vector2d(along.y(), -along.x()).normalized();
    constexpr double kStepMm = 1e-4;
    const auto spot = [&](double depth) {
        const Ring r = outline_about_contact(few_, brush_, depth);
        return Vector2d((r.row(k) + found.t * (r.row(next) - r.row(k))).transpose());
    };
    const Vector2d by_depth =
        Eigen::Rotation2Dd(s.heading_rad) * Vector2d((spot(s.depth_mm + kStepMm) - spot(s.depth_mm)) / kStepMm);
    return {-outwards.x(), -outwards.y(), outwards.x() * arm.y() - outwards.y() * arm.x(), -outwards.dot(by_depth)};
}

}  // namespace brushsvg::fit
