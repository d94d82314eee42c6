#include "brushsvg/medial_axis.hpp"

#include <algorithm>
#include <array>
#include <boost/polygon/polygon.hpp>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <tuple>
#include <utility>

#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

namespace bp = boost::polygon;
using Eigen::Index;
using Eigen::Vector2d;
using Diagram = bp::voronoi_diagram<double>;
using Edge = Diagram::edge_type;
using Cell = Diagram::cell_type;

constexpr double kUnitsPerMm = 1e5;  // as region's: its rings are whole numbers of it
// area over r^2 that an outer corner leaves of a disc in it: tan(a/2) - a/2 for a turn by a, here 45 degrees
constexpr double kLeastCorner = 0.02;
// A corner that adds as much to the disc at a line's end is where the line ends, if no other adds half of it: the even
// corners of a square end add 0.21 each.
constexpr double kLeastEnd = 0.3, kEndStandsOut = 1.4;
constexpr double kNothing = 10.0;  // units
constexpr double kPi = 3.14159265358979323846;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A place on the outline: edge number and fraction of it.
struct Foot {
    std::size_t edge = 0;
    double at = 0.0;
};

/// The outline's edges, ring after ring, the shape to the left of each.
class Outline {
 public:
    explicit Outline(const Rings& rings) {
        for (const Ring& ring : rings) {
            std::vector<bp::point_data<int>> points;
            for (Index i = 0; i < ring.rows(); ++i) {
                const double x = ring(i, 0) * kUnitsPerMm, y = ring(i, 1) * kUnitsPerMm;
                if (!(std::abs(x) < 2e9 && std::abs(y) < 2e9)) throw Error("a ring reaches beyond 20 m");
                const bp::point_data<int> point(int(std::lround(x)), int(std::lround(y)));
                if (points.empty() || points.back() != point) points.push_back(point);
            }
            while (points.size() > 1 && points.front() == points.back()) points.pop_back();
            if (points.size() < 3) continue;
            const std::size_t first = edges.size(), n = points.size();
            for (std::size_t i = 0; i < n; ++i) {
                edges.emplace_back(points[i], points[(i + 1) % n]);
                ring_of.push_back(rings_.size());
            }
            rings_.push_back({first, first + n});
        }
        twice_area_.push_back(0.0);
        for (std::size_t k = 0; k < edges.size(); ++k)
            twice_area_.push_back(twice_area_.back() + cross(start(k), end(k)));
    }
    Vector2d start(std::size_t k) const { return {double(edges[k].low().x()), double(edges[k].low().y())}; }
    Vector2d end(std::size_t k) const { return {double(edges[k].high().x()), double(edges[k].high().y())}; }
    std::size_t before(std::size_t k) const {
        const auto& [first, last] = rings_[ring_of[k]];
        return k == first ? last - 1 : k - 1;
    }
    std::size_t after(std::size_t k) const {
        const auto& [first, last] = rings_[ring_of[k]];
        return k + 1 == last ? first : k + 1;
    }
    Vector2d at(const Foot& f) const { return start(f.edge) + f.at * (end(f.edge) - start(f.edge)); }

    /// Twice the area that the origin sees of the outline from one place forward to another; of no walk: 0.
    double twice_area(const Foot& from, const Foot& to) const {
        if (ring_of[from.edge] != ring_of[to.edge]) return cross(at(from), at(to));
        const auto up_to = [this](const Foot& f) { return twice_area_[f.edge] + cross(start(f.edge), at(f)); };
        double sum = up_to(to) - up_to(from);
        if (is_behind(from, to)) {
            const auto& [first, last] = rings_[ring_of[from.edge]];
            sum += twice_area_[last] - twice_area_[first];
        }
        return sum;
    }
    /// Points of the outline from one place forward to another; round: from a place to itself is the whole ring.
    void walk(const Foot& from, const Foot& to, bool round, std::vector<Vector2d>& out) const {
        out.push_back(at(from));
        // the two ends of nothing may come in the wrong order, by rounding
        const bool is_near = (at(from) - at(to)).norm() < kNothing;
        const bool is_far = is_near ? round : from.edge != to.edge || is_behind(from, to);
        if (ring_of[from.edge] == ring_of[to.edge] && is_far) {
            std::size_t k = from.edge;
            do {
                out.push_back(end(k));
                k = after(k);
            } while (k != to.edge);
        }
        out.push_back(at(to));
    }
    /// The whole ring of an edge [mm].
    Ring ring(std::size_t k) const {
        const auto& [first, last] = rings_[ring_of[k]];
        Ring whole(Index(last - first), 2);
        for (std::size_t i = first; i < last; ++i) whole.row(Index(i - first)) = start(i).transpose() / kUnitsPerMm;
        return whole;
    }

    std::vector<bp::segment_data<int>> edges;
    std::vector<std::size_t> ring_of;

 private:
    static bool is_behind(const Foot& from, const Foot& to) {
        return to.edge < from.edge || (to.edge == from.edge && to.at < from.at);
    }
    std::vector<std::array<std::size_t, 2>> rings_;
    std::vector<double> twice_area_;  // before each edge
};

/// The part of the Voronoi diagram inside the shape, as half edges; those of one undirected edge are h and h ^ 1.
class Axis {
 public:
    Axis(const Outline& outline, const Diagram& diagram) : outline_(outline) {
        std::vector<std::size_t> vertex(diagram.vertices().size(), none);
        const auto number = [&](const Diagram::vertex_type* v) {
            std::size_t& k = vertex[std::size_t(v - diagram.vertices().data())];
            if (k == none) {
                k = points.size();
                points.emplace_back(v->x(), v->y());
            }
            return k;
        };
        std::vector<std::size_t> half_of(diagram.edges().size(), none);
        for (const Edge& edge : diagram.edges()) {
            if (!edge.is_primary() || !edge.is_finite() || &edge > edge.twin() || !is_inside(edge)) continue;
            for (const Edge* half : {&edge, static_cast<const Edge*>(edge.twin())}) {
                half_of[std::size_t(half - diagram.edges().data())] = from.size();
                from.push_back(number(half->vertex0()));
                left.push_back(half->cell());
                next.push_back(none);
            }
        }
        out.resize(points.size());
        for (const Diagram::vertex_type& v : diagram.vertices()) {
            if (vertex[std::size_t(&v - diagram.vertices().data())] == none) continue;
            const Edge* edge = v.incident_edge();
            do {
                const std::size_t h = half_of[std::size_t(edge - diagram.edges().data())];
                if (h != none) out[from[h]].push_back(h);
                edge = edge->rot_next();
            } while (edge != v.incident_edge());
        }
    }
    static constexpr std::size_t none = std::size_t(-1);

    std::size_t to(std::size_t h) const { return from[h ^ 1]; }
    Vector2d point_of(const Cell& cell) const {
        const std::size_t k = cell.source_index();
        return cell.source_category() == bp::SOURCE_CATEGORY_SEGMENT_START_POINT ? outline_.start(k) : outline_.end(k);
    }
    /// Where the outline is touched, on the left of a half edge, by the disc about its start.
    Foot foot(std::size_t h) const { return foot(*left[h], points[from[h]]); }
    Foot foot(const Cell& cell, const Vector2d& p) const {
        const std::size_t k = cell.source_index();
        if (cell.contains_point())
            return cell.source_category() == bp::SOURCE_CATEGORY_SEGMENT_START_POINT ? Foot{k, 0.0}
                                                                                     : Foot{outline_.after(k), 0.0};
        const Vector2d a = outline_.start(k), d = outline_.end(k) - a;
        return {k, std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0)};
    }
    double radius(std::size_t h) const { return (points[from[h]] - outline_.at(foot(h))).norm(); }

    /// Area that what begins with this half edge, up to its free end, adds to the disc about its start, over the
    /// disc's radius squared.
    double share(std::size_t h) const {
        const Vector2d& centre = points[from[h]];
        const Foot right = foot_right(h), to_left = foot(h);
        const Vector2d a = outline_.at(right), b = outline_.at(to_left);
        const double r2 = (b - centre).squaredNorm();
        if (!(r2 > 0.0)) return 0.0;
        const double area = 0.5 * (cross(centre, a) + outline_.twice_area(right, to_left) + cross(b, centre));
        double angle = std::atan2(cross(a - centre, b - centre), (a - centre).dot(b - centre));
        if (angle < 0.0) angle += 2.0 * kPi;
        return area / r2 - 0.5 * angle;
    }
    Foot foot_right(std::size_t h) const { return foot(*left[h ^ 1], points[from[h]]); }
    /// Where the outline begins that belongs to the branch which leaves by h, what was dropped before it included.
    Foot begin(std::size_t h) const {
        const auto& leaving = out[from[h]];
        if (leaving.size() < 2) return foot_right(h);
        const auto found = std::find(leaving.begin(), leaving.end(), h);
        return foot(found == leaving.begin() ? leaving.back() : *(found - 1));
    }

    /// Points along a half edge without its first one, with their distances.
    void sample(std::size_t h, std::vector<std::array<double, 3>>& line) const {
        const Vector2d &p = points[from[h]], &q = points[to(h)];
        const Cell *a = left[h], *b = left[h ^ 1];
        if (a->contains_point() != b->contains_point()) {  // a parabola
            const Cell& focus = a->contains_point() ? *a : *b;
            const Cell& directrix = a->contains_point() ? *b : *a;
            const Vector2d f = point_of(focus), o = outline_.start(directrix.source_index());
            const Vector2d along = (outline_.end(directrix.source_index()) - o).normalized();
            const Vector2d up(-along.y(), along.x());
            const double height = (f - o).dot(up), middle = (f - o).dot(along);
            const double x0 = (p - o).dot(along) - middle, x1 = (q - o).dot(along) - middle;
            const int n = height > 0.0 ? pieces(std::abs(x1 - x0), height) : 1;
            for (int i = 1; i < n; ++i) {
                const double x = x0 + (x1 - x0) * i / n, y = (x * x + height * height) / (2.0 * height);
                push(o + (x + middle) * along + y * up, y, line);
            }
        } else if (a->contains_point()) {
            const Vector2d f = point_of(*a);
            const int n = pieces((q - p).norm(), std::min((p - f).norm(), (q - f).norm()));
            for (int i = 1; i < n; ++i) {
                const Vector2d x = p + (q - p) * i / n;
                push(x, (x - f).norm(), line);
            }
        } else {
            const double r0 = radius(h), r1 = radius(h ^ 1);
            const int n = pieces((q - p).norm(), std::max(r0, r1));
            for (int i = 1; i < n; ++i) push(p + (q - p) * i / n, r0 + (r1 - r0) * i / n, line);
        }
        push(q, radius(h ^ 1), line);
    }
    /// So many that none is much longer than a fifth of the radius.
    static int pieces(double length, double radius) {
        return radius > 0.0 ? int(std::clamp(length / (0.2 * radius), 0.0, 200.0)) + 1 : 1;
    }
    static void push(const Vector2d& p, double r, std::vector<std::array<double, 3>>& line) {
        line.push_back({p.x() / kUnitsPerMm, p.y() / kUnitsPerMm, r / kUnitsPerMm});
    }

    std::vector<Vector2d> points;
    std::vector<std::size_t> from;              // of each half edge
    std::vector<const Cell*> left;              // the cell on its left
    std::vector<std::size_t> next;              // the half edge that goes on in the same branch
    std::vector<std::vector<std::size_t>> out;  // half edges that leave each point, counter-clockwise, none dropped

 private:
    bool is_inside(const Edge& edge) const {
        const Vector2d p(edge.vertex0()->x(), edge.vertex0()->y()), q(edge.vertex1()->x(), edge.vertex1()->y());
        for (const Cell* cell : {edge.cell(), edge.twin()->cell()}) {
            if (!cell->contains_segment()) continue;
            const std::size_t k = cell->source_index();
            const Vector2d d = outline_.end(k) - outline_.start(k);
            return cross(d, p - outline_.start(k)) + cross(d, q - outline_.start(k)) > 0.0;
        }
        // between two corners: within the angle of one of them
        const Cell& cell = *edge.cell();
        std::size_t k = cell.source_index();
        if (cell.source_category() == bp::SOURCE_CATEGORY_SEGMENT_END_POINT) k = outline_.after(k);
        const std::size_t j = outline_.before(k);
        const Vector2d in = outline_.end(j) - outline_.start(j), go = outline_.end(k) - outline_.start(k);
        const Vector2d off = 0.5 * (p + q) - outline_.start(k);
        const bool left_of_in = cross(in, off) > 0.0, left_of_go = cross(go, off) > 0.0;
        return cross(in, go) < 0.0 ? left_of_in || left_of_go : left_of_in && left_of_go;
    }
    const Outline& outline_;
};

/// What is dropped, and what then lies between nodes.
class Branches {
 public:
    explicit Branches(Axis& axis)
        : axis_(axis),
          mate_(axis.from.size()),
          corner_(axis.points.size(), 0.0),
          radius_(corner_),
          closes_(axis.points.size(), false),
          is_end_(closes_) {
        for (std::size_t h = 0; h < mate_.size(); ++h) mate_[h] = h ^ 1;
        for (std::size_t p = 0; p < axis_.points.size(); ++p)
            if (axis_.out[p].size() == 2) join(p);
    }
    void drop(double least_share) {
        std::vector<std::size_t> looked_at(axis_.points.size());
        for (std::size_t p = 0; p < looked_at.size(); ++p) looked_at[p] = p;
        while (!looked_at.empty()) {
            std::vector<Drop> drops;  // all judged before any goes
            for (std::size_t p : looked_at) {
                if (axis_.out[p].size() != 1) continue;
                const std::size_t h = mate_[axis_.out[p][0]], junction = axis_.from[h];
                if (axis_.out[junction].size() < 3) continue;
                const double share = axis_.share(h);
                if (share < least_share) drops.push_back({junction, share, h});
            }
            std::sort(drops.begin(), drops.end());
            drops.erase(std::unique(drops.begin(), drops.end()), drops.end());
            keep_ends(drops);
            std::vector<std::size_t> junctions;
            for (const auto& [junction, share, h] : drops) {
                corner_[junction] = std::max(corner_[junction], share);
                radius_[junction] = axis_.radius(h);
                auto& leaving = axis_.out[junction];
                leaving.erase(std::find(leaving.begin(), leaving.end(), h));
                for (std::size_t k = h; k != Axis::none; k = axis_.next[k]) axis_.out[axis_.to(k)].clear();
                junctions.push_back(junction);
            }
            std::sort(junctions.begin(), junctions.end());
            junctions.erase(std::unique(junctions.begin(), junctions.end()), junctions.end());
            looked_at.clear();
            for (std::size_t p : junctions) {
                looked_at.push_back(p);
                if (axis_.out[p].empty()) dabs_.emplace_back(p, radius_[p]);
                if (axis_.out[p].size() != 2) continue;
                join(p);
                for (std::size_t h : axis_.out[p]) looked_at.push_back(axis_.from[mate_[h]]);
            }
        }
    }
    bool is_node(std::size_t p) const {
        const std::size_t n = axis_.out[p].size();
        return n > 2 || n == 1 || closes_[p] || (n == 2 && corner_[p] >= kLeastCorner && !is_end_[p]);
    }
    double corner(std::size_t p) const { return corner_[p]; }
    /// Points of which everything was dropped, and the radius there.
    const std::vector<std::pair<std::size_t, double>>& dabs() const { return dabs_; }

 private:
    using Drop = std::tuple<std::size_t, double, std::size_t>;  // junction, share, the half edge that leaves it

    /// Where a line would end, its way out to the one corner that stands out stays.
    void keep_ends(std::vector<Drop>& drops) {
        std::vector<Drop> kept;
        for (std::size_t i = 0; i < drops.size();) {
            std::size_t j = i;
            while (j < drops.size() && std::get<0>(drops[j]) == std::get<0>(drops[i])) ++j;
            const std::size_t p = std::get<0>(drops[i]);
            const double most = std::get<1>(drops[j - 1]), next = j - i > 1 ? std::get<1>(drops[j - 2]) : 0.0;
            const bool stands_out = axis_.out[p].size() == j - i + 1 && most > kLeastEnd && most > kEndStandsOut * next;
            if (stands_out) is_end_[p] = true;
            kept.insert(kept.end(), drops.begin() + std::ptrdiff_t(i),
                        drops.begin() + std::ptrdiff_t(stands_out ? j - 1 : j));
            i = j;
        }
        drops = std::move(kept);
    }
    /// The two branches that leave p become one.
    void join(std::size_t p) {
        const std::size_t a = axis_.out[p][0], b = axis_.out[p][1], far_a = mate_[a], far_b = mate_[b];
        if (far_a == b) {
            closes_[p] = true;
            return;
        }
        axis_.next[a ^ 1] = b;
        axis_.next[b ^ 1] = a;
        mate_[far_a] = far_b;
        mate_[far_b] = far_a;
    }
    Axis& axis_;
    std::vector<std::size_t> mate_;  // of a half edge that leaves a branch's end: the one that leaves its other end
    std::vector<double> corner_;
    std::vector<double> radius_;  // known of junctions from which something was dropped
    std::vector<bool> closes_;    // where a ring that meets nothing begins
    std::vector<bool> is_end_;    // where a line goes on into a corner
    std::vector<std::pair<std::size_t, double>> dabs_;
};

Ring ring_of(const std::vector<Vector2d>& points) {
    Ring ring(Index(points.size()), 2);
    for (Index i = 0; i < ring.rows(); ++i) ring.row(i) = points[i].transpose() / kUnitsPerMm;
    return ring;
}

/// What lies nearest to the branch whose first and last half edges are given: the outline along its right side forward,
/// along its left side back, round its free ends.
Rings part_of(const Axis& axis, const Outline& outline, std::size_t first, std::size_t last) {
    const auto is_free = [&](std::size_t p) { return axis.out[p].size() == 1; };
    const std::size_t a = axis.from[first], b = axis.to(last);
    if (is_free(a) && !is_free(b)) return part_of(axis, outline, last ^ 1, first ^ 1);
    const Foot right = axis.begin(first), left = axis.foot(first);
    if ((is_free(a) && is_free(b)) || (a == b && axis.out[a].size() == 2)) {  // all there is: whole rings
        Rings rings{outline.ring(right.edge)};
        if (outline.ring_of[left.edge] != outline.ring_of[right.edge]) rings.push_back(outline.ring(left.edge));
        if (signed_area(rings[0]) < 0.0) std::reverse(rings.begin(), rings.end());
        return rings;
    }
    // a side that ends where it began has gone round a hole, unless it never left the place
    const auto moves = [&](std::size_t h, std::size_t end) {
        for (const Vector2d start = outline.at(axis.foot(h));; h = axis.next[h]) {
            if ((outline.at(axis.foot(h)) - start).norm() > kNothing) return true;
            if (h == end) return false;
        }
    };
    std::vector<Vector2d> points{axis.points[a]};
    if (is_free(b)) {
        outline.walk(right, left, false, points);
    } else {
        outline.walk(right, axis.foot(last ^ 1), moves(last ^ 1, first ^ 1), points);
        points.push_back(axis.points[b]);
        outline.walk(axis.begin(last ^ 1), left, moves(first, last), points);
    }
    return {ring_of(points)};
}

MedialAxis collected(const Axis& axis, const Outline& outline, const Branches& branches) {
    MedialAxis result;
    std::vector<int> number(axis.points.size(), -1);
    const auto node = [&](std::size_t p, double radius) {
        if (number[p] < 0) {
            number[p] = int(result.nodes.size());
            result.nodes.push_back({axis.points[p].x() / kUnitsPerMm, axis.points[p].y() / kUnitsPerMm,
                                    radius / kUnitsPerMm, branches.corner(p)});
        }
        return number[p];
    };
    std::vector<bool> seen(axis.from.size(), false);
    for (std::size_t p = 0; p < axis.points.size(); ++p) {
        if (!branches.is_node(p)) continue;
        for (std::size_t first : axis.out[p]) {
            if (seen[first]) continue;
            AxisBranch branch;
            branch.from = node(p, axis.radius(first));
            std::vector<std::array<double, 3>> line;
            Axis::push(axis.points[p], axis.radius(first), line);
            std::size_t h = first;
            for (;; h = axis.next[h]) {
                axis.sample(h, line);
                if (branches.is_node(axis.to(h))) break;
            }
            seen[first] = seen[h ^ 1] = true;
            branch.to = node(axis.to(h), axis.radius(h ^ 1));
            branch.line = Eigen::Map<const AxisLine>(line[0].data(), Index(line.size()), 3);
            branch.part = part_of(axis, outline, first, h);
            result.branches.push_back(std::move(branch));
        }
    }
    for (const auto& [p, radius] : branches.dabs()) node(p, radius);
    return result;
}

}  // namespace

MedialAxis medial_axis(const Rings& rings, double least_share) {
    const Outline outline(rings);
    if (outline.edges.empty()) return {};
    Diagram diagram;
    bp::construct_voronoi(outline.edges.begin(), outline.edges.end(), &diagram);
    Axis axis(outline, diagram);
    Branches branches(axis);
    branches.drop(least_share);
    return collected(axis, outline, branches);
}

}  // namespace brushsvg
