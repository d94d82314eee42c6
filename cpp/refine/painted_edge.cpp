#include "painted_edge.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace brushsvg::fit {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr double kPi = 3.14159265358979323846;
/// Rounding error allowed for when a box is compared with an edge [mm].
constexpr double kRoundingMm = 1e-9;

/// Mark the corners that a polyline needs. The others are no further from it than the tolerance (Douglas, Peucker).
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

/// Number of edges, and of footprints, that are skipped together where they are far away.
constexpr Index kEdgesPerBox = 16;
constexpr std::size_t kSamplesPerGroup = 8;

/// Return unit vectors in even steps over half a turn: heading and across first.
template <int n>
std::array<Vector2d, n> even_axes() {
    std::array<Vector2d, n> axes;
    for (int k = 0; k < n; ++k) {
        const int even = k % 2 * (n / 2) + k / 2;
        axes[std::size_t(k)] = {std::cos(kPi * even / n), std::sin(kPi * even / n)};
    }
    return axes;
}

}  // namespace

FilledRings::FilledRings(const Rings& rings) {
    Index n = 0;
    for (const Ring& ring : rings) n += ring.rows();
    resize(n);
    Index first = 0;
    for (const Ring& ring : rings) {
        store_ring(ring, first);
        first += ring.rows();
    }
    update_derived();
}

void FilledRings::set(const Ring& ring) {
    resize(ring.rows());
    store_ring(ring, 0);
    update_derived();
}

void FilledRings::resize(Index n) {
    for (auto* column : {&ax_, &ay_, &bx_, &by_, &over_length2_, &x_per_y_}) column->resize(n);
}

void FilledRings::store_ring(const Ring& ring, Index first) {
    const Index n = ring.rows();
    if (n == 0) return;
    ax_.segment(first, n) = ring.col(0);
    ay_.segment(first, n) = ring.col(1);
    bx_.segment(first, n - 1) = (ring.col(0).tail(n - 1) - ring.col(0).head(n - 1)).array();
    by_.segment(first, n - 1) = (ring.col(1).tail(n - 1) - ring.col(1).head(n - 1)).array();
    bx_[first + n - 1] = ring(0, 0) - ring(n - 1, 0);
    by_[first + n - 1] = ring(0, 1) - ring(n - 1, 1);
}

void FilledRings::update_derived() {
    const Index n = size();
    over_length2_ = (bx_.square() + by_.square()).max(1e-18).inverse();
    x_per_y_ = (by_.abs() > 1e-12).select(bx_ / by_, 0.0);
    parts_.clear();
    for (Index from = 0; from < n; from += kEdgesPerBox) {
        const Index count = std::min(kEdgesPerBox, n - from);
        const auto ax = ax_.segment(from, count), ay = ay_.segment(from, count);
        const auto to_x = ax + bx_.segment(from, count), to_y = ay + by_.segment(from, count);
        parts_.push_back({from, from + count, ax.min(to_x).minCoeff(), ay.min(to_y).minCoeff(), ax.max(to_x).maxCoeff(),
                          ay.max(to_y).maxCoeff()});
    }
}

EdgePoint FilledRings::nearest(const Vector2d& p) const {
    EdgePoint found;
    double best = 1e300;
    int crossed = 0;
    for (const EdgeBox& part : parts_) {
        const double beside_x = std::max({part.left - p.x(), p.x() - part.right, 0.0});
        const double beside_y = std::max({part.bottom - p.y(), p.y() - part.top, 0.0});
        // skip edges that are not nearer, unless a ray from the point to the right may meet them
        if (beside_x * beside_x + beside_y * beside_y > best && (beside_y > 0.0 || p.x() > part.right)) continue;
        for (Index k = part.first; k < part.last; ++k) {
            const double px = p.x() - ax_[k], py = p.y() - ay_[k], bx = bx_[k], by = by_[k];
            const double t = std::min(1.0, std::max(0.0, (px * bx + py * by) * over_length2_[k]));
            const double dx = px - t * bx, dy = py - t * by, d2 = dx * dx + dy * dy;
            const bool better = d2 < best;
            best = better ? d2 : best;
            found.t = better ? t : found.t;
            found.edge = better ? k : found.edge;
            crossed += int((py < 0.0) != (py < by)) & int(px < x_per_y_[k] * py);
        }
    }
    found.distance_mm = crossed % 2 ? -std::sqrt(best) : std::sqrt(best);
    return found;
}

Vector2d FilledRings::outwards(const Vector2d& p, const EdgePoint& found) const {
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
        simplified_.dragged.push_back(std::move(few));
    }
}

double PaintedEdge::Placed::distance_bound_mm(const Vector2d& seen) const {
    static const std::array<Vector2d, kAxisCount> axes = even_axes<kAxisCount>();
    double least = -1e300;
    for (std::size_t k = 0; k < kAxisCount; ++k) {
        const double along = seen.dot(axes[k]);
        least = std::max(least, std::max(along - ahead[k], behind[k] - along));
    }
    return least;
}

void PaintedEdge::place_footprints(const PatchSamples& samples) {
    static const std::array<Vector2d, kAxisCount> axes = even_axes<kAxisCount>();
    placed_.resize(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        Placed& placed = placed_[i];
        placed.contact = samples[i].contact_mm;
        placed.heading = {std::cos(samples[i].heading_rad), std::sin(samples[i].heading_rad)};
        placed.depth = samples[i].depth_mm;
        const Ring outline = outline_about_contact(simplified_, brush_, placed.depth);
        placed.outline.set(outline);
        placed.by_depth.resize(0, 2);
        placed.reach = outline.rowwise().norm().maxCoeff();
        for (std::size_t k = 0; k < kAxisCount; ++k) {
            const Eigen::VectorXd along = outline * axes[k];
            placed.ahead[k] = along.maxCoeff();
            placed.behind[k] = along.minCoeff();
        }
    }
    groups_.clear();
    for (std::size_t first = 0; first < placed_.size(); first += kSamplesPerGroup) {
        const std::size_t last = std::min(first + kSamplesPerGroup, placed_.size());
        SampleGroup group{first, last, placed_[(first + last) / 2].contact, 0.0};
        for (std::size_t i = first; i < last; ++i)
            group.radius = std::max(group.radius, (placed_[i].contact - group.middle).norm() + placed_[i].reach);
        groups_.push_back(group);
    }
}

EdgePoint PaintedEdge::nearest(const Vector2d& p, std::size_t near) const {
    EdgePoint best = placed_[near].outline.nearest(placed_[near].in_footprint_frame(p));
    best.sample = near;
    for (const SampleGroup& group : groups_) {
        if ((p - group.middle).norm() - group.radius >= best.distance_mm + kRoundingMm) continue;
        for (std::size_t i = group.first; i < group.last; ++i) {
            const Vector2d seen = placed_[i].in_footprint_frame(p);
            if (i == near || placed_[i].distance_bound_mm(seen) >= best.distance_mm + kRoundingMm) continue;
            EdgePoint other = placed_[i].outline.nearest(seen);
            if (other.distance_mm >= best.distance_mm) continue;
            best = other;
            best.sample = i;
        }
    }
    return best;
}

Vector2d PaintedEdge::place_of(const EdgePoint& place) const {
    const Placed& at = placed_[place.sample];
    return at.contact + at.on_paper(at.outline.place(place.edge, place.t));
}

SampleSlope PaintedEdge::slope(const Vector2d& p, const EdgePoint& found) const {
    const Placed& at = placed_[found.sample];
    return motion_slope(found, -at.on_paper(at.outline.outwards(at.in_footprint_frame(p), found)));
}

SampleSlope PaintedEdge::motion_slope(const EdgePoint& place, const Vector2d& direction) const {
    const Placed& at = placed_[place.sample];
    const Vector2d arm = at.on_paper(at.outline.place(place.edge, place.t));
    constexpr double kDepthStepMm = 1e-4;
    if (at.by_depth.rows() == 0)
        at.by_depth = (outline_about_contact(simplified_, brush_, at.depth + kDepthStepMm) -
                       outline_about_contact(simplified_, brush_, at.depth)) /
                      kDepthStepMm;
    const Index k = place.edge, next = k + 1 == at.by_depth.rows() ? 0 : k + 1;
    const Vector2d by_depth =
        at.on_paper((at.by_depth.row(k) + place.t * (at.by_depth.row(next) - at.by_depth.row(k))).transpose());
    return {direction.x(), direction.y(), direction.y() * arm.x() - direction.x() * arm.y(), direction.dot(by_depth)};
}

}  // namespace brushsvg::fit
