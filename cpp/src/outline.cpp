#include "outline.hpp"

#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
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

bool is_behind(const Foot& from, const Foot& to) {
    return to.edge < from.edge || (to.edge == from.edge && to.at < from.at);
}

/// How far corners at one place are moved apart: beyond what counts as nothing, and far below what is seen. Less, this
/// share of the way, where another edge is near: edges that cross have no diagram.
constexpr double kApart = 40.0, kShareOfWay = 0.4;  // units

namespace bg = boost::geometry;
using Point = bg::model::d2::point_xy<double>;
using Segment = bg::model::segment<Point>;
using Box = bg::model::box<Point>;

Segment segment(const Vector2d& a, const Vector2d& b) { return {{a.x(), a.y()}, {b.x(), b.y()}}; }

/// Edges in a tree of boxes, to find what lies near one of them.
class NearbyEdges {
 public:
    explicit NearbyEdges(const std::vector<Segment>& edges) : edges_(edges) {
        std::vector<std::pair<Box, std::size_t>> boxes;
        for (std::size_t k = 0; k < edges.size(); ++k) boxes.push_back({bg::return_envelope<Box>(edges[k]), k});
        tree_ = {boxes.begin(), boxes.end()};
    }

    /// The distance of an edge to those that share no end with it, as far as one is nearer than `most`.
    double room_beside(std::size_t k, double most) const {
        const Segment& edge = edges_[k];
        Box around = bg::return_envelope<Box>(edge);
        bg::set<bg::min_corner, 0>(around, bg::get<bg::min_corner, 0>(around) - most);
        bg::set<bg::min_corner, 1>(around, bg::get<bg::min_corner, 1>(around) - most);
        bg::set<bg::max_corner, 0>(around, bg::get<bg::max_corner, 0>(around) + most);
        bg::set<bg::max_corner, 1>(around, bg::get<bg::max_corner, 1>(around) + most);
        double room = most;
        for (auto found = tree_.qbegin(bg::index::intersects(around)); found != tree_.qend(); ++found) {
            const Segment& other = edges_[found->second];
            const bool meets = bg::equals(edge.first, other.first) || bg::equals(edge.first, other.second) ||
                               bg::equals(edge.second, other.first) || bg::equals(edge.second, other.second);
            if (!meets) room = std::min(room, bg::distance(edge, other));
        }
        return room;
    }

 private:
    const std::vector<Segment>& edges_;
    bg::index::rtree<std::pair<Box, std::size_t>, bg::index::quadratic<16>> tree_;
};

/// Whether a direction lies in the smaller of the angles between two others.
bool is_between(const Vector2d& a, const Vector2d& b, const Vector2d& direction) {
    const double turn = cross(a, b);
    return cross(a, direction) * turn > 0.0 && cross(direction, b) * turn > 0.0;
}

/// Where a corner that touches another one goes: into the smaller of its two angles.
Vector2i apart(const Vector2d& before, const Vector2d& at, const Vector2d& after, double way) {
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
                throw Error("geometry-out-of-range", "a ring reaches beyond 20 m");
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
    move_apart();
    twice_area_.push_back(0.0);
    for (std::size_t k = 0; k < edges(); ++k) twice_area_.push_back(twice_area_.back() + cross(start(k), end(k)));
}

void Outline::move_apart() {
    std::vector<std::size_t> order(edges());
    std::iota(order.begin(), order.end(), std::size_t(0));
    const auto is_before = [this](std::size_t a, std::size_t b) {
        return std::make_pair(starts_[a].x(), starts_[a].y()) < std::make_pair(starts_[b].x(), starts_[b].y());
    };
    std::sort(order.begin(), order.end(), is_before);
    const std::vector<Vector2i> as_given = starts_;
    const auto place = [&](std::size_t k) -> Vector2d { return as_given[k].cast<double>(); };
    // A corner in whose smaller angle another one lies stays where it is: that one moves away from it.
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
    std::vector<Segment> as_edges;
    for (std::size_t k = 0; k < edges(); ++k) as_edges.push_back(segment(place(k), place(after(k))));
    const NearbyEdges nearby(as_edges);
    for (const std::size_t k : touching) {
        checkpoint();
        const double most = kApart / kShareOfWay;
        const double room = std::min(nearby.room_beside(before(k), most), nearby.room_beside(k, most));
        starts_[k] = apart(place(before(k)), place(k), place(after(k)), kShareOfWay * room);
    }
}

double Outline::twice_area(const Foot& from, const Foot& to) const {
    if (!same_ring(from, to)) return cross(at(from), at(to));
    const auto up_to = [this](const Foot& f) { return twice_area_[f.edge] + cross(start(f.edge), at(f)); };
    double sum = up_to(to) - up_to(from);
    if (is_behind(from, to)) {
        const Span& whole = rings_[ring_of_[from.edge]];
        sum += twice_area_[whole.last] - twice_area_[whole.first];
    }
    return sum;
}

void Outline::walk(const Foot& from, const Foot& to, bool round, std::vector<Vector2d>& out) const {
    out.push_back(at(from));
    // the two ends of nothing may come in the wrong order, by rounding
    const bool is_near = (at(from) - at(to)).norm() < kNothing;
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
