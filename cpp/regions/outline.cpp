#include "regions/outline.hpp"

#include <cmath>
#include <numeric>
#include <utility>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector2i;

bool is_behind(const OutlinePlace& from, const OutlinePlace& to) {
    return to.edge < from.edge || (to.edge == from.edge && to.at < from.at);
}

/// How far corners at one place are moved apart: more than kSamePlaceUnits, and far less than is visible. If another
/// edge is near, they are moved by kMaxGapShare of the distance to it. Edges that cross have no diagram.
constexpr double kSeparationUnits = 40.0, kMaxGapShare = 0.4;  // units
/// A corner with less room stays, because rounding could move it across the nearest edge. That edge may move as well,
/// so the least room is 2 (kMaxGapShare room + sqrt(1/2)).
constexpr double kMinRoomUnits = 1.4142135623730951 / (1.0 - 2.0 * kMaxGapShare);

double distance(const Vector2d& point, const Vector2d& a, const Vector2d& b) {
    const Vector2d along = b - a;
    const double at = std::clamp((point - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (point - a - at * along).norm();
}

/// Return whether a direction is in the smaller of the angles between two others.
bool is_between(const Vector2d& a, const Vector2d& b, const Vector2d& direction) {
    const double turn = cross(a, b);
    return cross(a, direction) * turn > 0.0 && cross(direction, b) * turn > 0.0;
}

/// Return where a corner that touches another one is moved: into the smaller of its two angles.
Vector2i separated_corner(const Vector2d& before, const Vector2d& at, const Vector2d& after, double way) {
    const Vector2d in = (before - at).normalized(), out = (after - at).normalized();
    Vector2d into = in + out;
    if (into.norm() < 1e-6) into = Vector2d(-out.y(), out.x());
    return (at + way * into.normalized()).array().round().matrix().cast<int>();
}

}  // namespace

Outline::Outline(const Rings& rings) {
    for (const Ring& ring : rings) {
        std::vector<Vector2i> points;
        for (Index i = 0; i < ring.rows(); ++i) {
            const Vector2d p = kUnitsPerMm * ring.row(i).transpose();
            if (!(p.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() < 2e9))
                throw Error("geometry-out-of-range",
                            "a ring has a coordinate beyond 20 m or not finite: check its unit");
            const Vector2i point(int(std::lround(p.x())), int(std::lround(p.y())));
            if (points.empty() || points.back() != point) points.push_back(point);
        }
        while (points.size() > 1 && points.front() == points.back()) points.pop_back();
        if (points.size() < 3) continue;
        const std::size_t first = starts_.size();
        starts_.insert(starts_.end(), points.begin(), points.end());
        ring_of_.resize(starts_.size(), rings_.size());
        rings_.push_back({first, starts_.size()});
    }
    separate_touching_rings();
    twice_area_.push_back(0.0);
    for (std::size_t k = 0; k < edges(); ++k) twice_area_.push_back(twice_area_.back() + cross(start(k), end(k)));
}

void Outline::separate_touching_rings() {
    std::vector<std::size_t> order(edges());
    std::iota(order.begin(), order.end(), std::size_t(0));
    const auto is_before = [this](std::size_t a, std::size_t b) {
        return std::make_pair(starts_[a].x(), starts_[a].y()) < std::make_pair(starts_[b].x(), starts_[b].y());
    };
    std::sort(order.begin(), order.end(), is_before);
    const std::vector<Vector2i> as_given = starts_;
    const auto place = [&](std::size_t k) -> Vector2d { return as_given[k].cast<double>(); };
    // A corner with another corner inside its smaller angle stays where it is. The other corner moves away from it.
    const auto has_another_inside = [&](std::size_t k, std::size_t first, std::size_t last) {
        const Vector2d in = place(before(k)) - place(k), out = place(after(k)) - place(k);
        return std::any_of(order.begin() + Index(first), order.begin() + Index(last), [&](std::size_t j) {
            return j != k && (is_between(in, out, place(before(j)) - place(j)) ||
                              is_between(in, out, place(after(j)) - place(j)));
        });
    };
    std::vector<std::size_t> touching;
    for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
        while (last < order.size() && as_given[order[last]] == as_given[order[first]]) ++last;
        if (last == first + 1) continue;
        for (std::size_t i = first; i < last; ++i)
            if (!has_another_inside(order[i], first, last)) touching.push_back(order[i]);
    }
    if (touching.empty()) return;
    // return the distance of an edge from edges that share no end with it, or `room` if none is nearer
    const auto free_distance = [&](std::size_t k, double room) {
        const Vector2d a = place(k), b = place(after(k));
        const Eigen::Array2d low = a.cwiseMin(b).array() - room, high = a.cwiseMax(b).array() + room;
        for (std::size_t j = 0; j < edges(); ++j) {
            const Vector2d c = place(j), d = place(after(j));
            const bool is_far = (c.cwiseMax(d).array() < low).any() || (c.cwiseMin(d).array() > high).any();
            if (is_far || c == a || c == b || d == a || d == b) continue;
            room = std::min({room, distance(c, a, b), distance(d, a, b), distance(a, c, d), distance(b, c, d)});
        }
        return room;
    };
    for (const std::size_t k : touching) {
        checkpoint(1 + int(edges() / 100));
        const double room = free_distance(k, free_distance(before(k), kSeparationUnits / kMaxGapShare));
        if (room < kMinRoomUnits) continue;
        starts_[k] = separated_corner(place(before(k)), place(k), place(after(k)), kMaxGapShare * room);
    }
}

double Outline::twice_area(const OutlinePlace& from, const OutlinePlace& to) const {
    if (!same_ring(from, to)) return cross(at(from), at(to));
    const auto up_to = [this](const OutlinePlace& f) { return twice_area_[f.edge] + cross(start(f.edge), at(f)); };
    double sum = up_to(to) - up_to(from);
    if (is_behind(from, to)) {
        const Span& whole = rings_[ring_of_[from.edge]];
        sum += twice_area_[whole.last] - twice_area_[whole.first];
    }
    return sum;
}

void Outline::walk(const OutlinePlace& from, const OutlinePlace& to, bool round, std::vector<Vector2d>& out) const {
    out.push_back(at(from));
    // the ends of an empty walk may be in the wrong order because of rounding
    const bool is_near = (at(from) - at(to)).norm() < kSamePlaceUnits;
    const bool is_far = is_near ? round : from.edge != to.edge || is_behind(from, to);
    if (same_ring(from, to) && is_far) {
        std::size_t k = from.edge;
        do {
            checkpoint();
            out.push_back(end(k));
            k = after(k);
        } while (k != to.edge);
    }
    out.push_back(at(to));
}

Ring Outline::ring(std::size_t k) const {
    const auto& [first, last] = rings_[ring_of_[k]];
    Ring whole(Index(last - first), 2);
    for (std::size_t i = first; i < last; ++i) whole.row(Index(i - first)) = start(i).transpose() / kUnitsPerMm;
    return whole;
}

}  // namespace brushsvg
