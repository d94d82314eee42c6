#include "regions/star_union.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
/// Corners as seen from a point, counter-clockwise: by angle from the x axis.
using Star = std::vector<Vector2d>;

/// Most rings that are united at once: a brush leaves a place within that many pieces.
constexpr std::size_t kMaxRings = 64;
/// Edges nearer than this count as one [mm]: half the resolution of coordinates.
constexpr double kSameEdgeMm = 5e-6;
/// Least distance at which the line of an edge passes the point, as a share of the edge's distance. Seen along an edge,
/// an angle hardly determines a place on the edge.
constexpr double kMinSlant = 0.02;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }
bool is_below(const Vector2d& a) { return a.y() < 0.0 || (a.y() == 0.0 && a.x() < 0.0); }
bool comes_before(const Vector2d& a, const Vector2d& b) {
    return is_below(a) != is_below(b) ? is_below(b) : cross(a, b) > 0.0;
}

/// Fill `star` with the ring, from its corner of the least angle on. Return false if the point does not see all of it,
/// once around.
bool make_star(const Vector2d& point, const Ring& ring, Star& star) {
    const Index n = ring.rows();
    if (n < 3) return false;
    star.resize(std::size_t(n));
    for (Index i = 0; i < n; ++i) star[std::size_t(i)] = ring.row(i).transpose() - point;
    Index first = -1;
    for (Index i = 0; i < n; ++i) {
        const Vector2d &a = star[std::size_t(i)], &b = star[std::size_t(i + 1 == n ? 0 : i + 1)];
        const double twice = cross(a, b), far = std::max(a.squaredNorm(), b.squaredNorm());
        if (!(twice > 0.0 && twice * twice > kMinSlant * kMinSlant * far * (b - a).squaredNorm())) return false;
        if (!comes_before(a, b)) {
            if (first >= 0) return false;  // a second time around
            first = i + 1 == n ? 0 : i + 1;
        }
    }
    if (first < 0) return false;
    std::rotate(star.begin(), star.begin() + first, star.end());
    return true;
}

/// Return how far a place is beyond the line through an edge, as seen from the point.
double distance_beyond_edge(const Vector2d& from, const Vector2d& to, const Vector2d& place) {
    const Vector2d edge = to - from;
    return -cross(edge, place - from) / edge.norm();
}

/// Two edges that go round the point side by side, each from a corner to the next.
struct Edges {
    Vector2d a0, a1, b0, b1;

    /// Return which one reaches further in the direction of a corner of one of them: 1 a, -1 b, else `before`.
    int outer_at(const Vector2d& corner, bool is_of_a, int before) const {
        const double by = is_of_a ? distance_beyond_edge(b0, b1, corner) : -distance_beyond_edge(a0, a1, corner);
        return by > kSameEdgeMm ? 1 : by < -kSameEdgeMm ? -1 : before;
    }
    /// Return where they cross between two directions. If rounding puts the crossing elsewhere, return a place on the
    /// edge that is then the outer one, in the direction `from`. The edges are so near there that they count as one.
    Vector2d crossing(const Vector2d& from, const Vector2d& to, bool is_a_then) const {
        const Vector2d along = a1 - a0, other = b1 - b0;
        const double slant = cross(along, other);
        if (slant != 0.0) {
            const Vector2d at = a0 + cross(b0 - a0, other) / slant * along;
            const bool is_ahead = from.dot(at) > 0.0 || to.dot(at) > 0.0;
            if (is_ahead && cross(from, at) >= 0.0 && cross(at, to) >= 0.0) return at;
        }
        const Vector2d &begin = is_a_then ? a0 : b0, &way = is_a_then ? along : other;
        return begin - cross(from, begin) / cross(from, way) * way;
    }
};

/// Find the outer one of two stars at each angle.
void unite_two_stars(const Star& a, const Star& b, Star& out) {
    out.clear();
    const auto add = [&](const Vector2d& corner) {
        if (out.empty() || (corner - out.back()).squaredNorm() > kSameEdgeMm * kSameEdgeMm) out.push_back(corner);
    };
    Edges edges{a.back(), a.front(), b.back(), b.front()};
    Vector2d last = comes_before(a.back(), b.back()) ? b.back() : a.back();
    int outside = 0;
    const auto reach = [&](const Vector2d& corner, bool is_of_a) {
        const int before = outside;
        outside = edges.outer_at(corner, is_of_a, before);
        if (before != 0 && outside != before) add(edges.crossing(last, corner, outside > 0));
        last = corner;
    };
    std::size_t i = 0, j = 0;
    while (i < a.size() || j < b.size()) {
        const bool is_of_a = j == b.size() || (i < a.size() && !comes_before(b[j], a[i]));
        const Vector2d& corner = is_of_a ? a[i] : b[j];
        reach(corner, is_of_a);
        if (outside == (is_of_a ? 1 : -1) || outside == 0) add(corner);
        if (is_of_a) {
            edges.a0 = corner;
            edges.a1 = a[++i == a.size() ? 0 : i];
        } else {
            edges.b0 = corner;
            edges.b1 = b[++j == b.size() ? 0 : j];
        }
    }
    // the first one again: they may cross on the way there
    const bool is_of_a = !comes_before(b.front(), a.front());
    reach(is_of_a ? a.front() : b.front(), is_of_a);
    while (out.size() > 1 && (out.front() - out.back()).squaredNorm() <= kSameEdgeMm * kSameEdgeMm) out.pop_back();
    if (comes_before(out.back(), out.front())) std::rotate(out.begin(), out.end() - 1, out.end());
}

Ring ring_of(const Star& star, const Vector2d& point) {
    Ring ring(Index(star.size()), 2);
    for (Index i = 0; i < ring.rows(); ++i) ring.row(i) = (point + star[std::size_t(i)]).transpose();
    return ring;
}

/// Return the outer edge of all stars. Neighbours overlap most, so stars are united by halves.
Star outer_envelope(std::vector<Star> stars) {
    while (stars.size() > 1) {
        std::vector<Star> next((stars.size() + 1) / 2);
        for (std::size_t k = 0; k < stars.size(); k += 2) {
            if (k + 1 < stars.size())
                unite_two_stars(stars[k], stars[k + 1], next[k / 2]);
            else
                next[k / 2] = std::move(stars[k]);
        }
        stars = std::move(next);
    }
    return stars.front();
}

}  // namespace

StarUnion unite_stars(const Rings& rings) {
    std::vector<bool> is_outer;
    for (const Ring& ring : rings) is_outer.push_back(ring.rows() >= 3 && signed_area(ring) > 0.0);
    const auto is_alone = [&](std::size_t k) { return is_outer[k] && (k + 1 == rings.size() || is_outer[k + 1]); };
    Rings out;
    bool are_stars = true;
    std::vector<Star> stars;
    for (std::size_t first = 0; first < rings.size();) {
        std::size_t most = first;
        while (most < rings.size() && most - first < kMaxRings && is_alone(most)) ++most;
        std::size_t count = most - first;
        for (; count > 1; count = 3 * count / 4) {
            checkpoint(int(count));
            const Vector2d point = rings[first + count / 2].colwise().mean().transpose();
            stars.resize(count);
            std::size_t seen = 0;
            while (seen < count && make_star(point, rings[first + seen], stars[seen])) ++seen;
            if (seen < count) continue;
            out.push_back(ring_of(outer_envelope(std::move(stars)), point));
            stars.clear();
            break;
        }
        if (count < 2) {
            const Ring& ring = rings[first];
            stars.resize(1);
            are_stars = are_stars && is_alone(first) && make_star(ring.colwise().mean().transpose(), ring, stars[0]);
            out.push_back(ring);
            count = 1;
        }
        first += count;
    }
    return {std::move(out), are_stars};
}

}  // namespace brushsvg
