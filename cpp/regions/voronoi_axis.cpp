#include "regions/voronoi_axis.hpp"

#include <algorithm>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <utility>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg {
namespace {

namespace bp = boost::polygon;
using Eigen::Vector2d;
/// A Voronoi diagram that checks for cancellation while it is built.
class Diagram : public bp::voronoi_diagram<double> {
 public:
    template <class Event>
    std::pair<void*, void*> _insert_new_edge(const Event& a, const Event& b) {
        checkpoint(5);
        return bp::voronoi_diagram<double>::_insert_new_edge(a, b);
    }
    template <class Event, class Circle>
    std::pair<void*, void*> _insert_new_edge(const Event& a, const Event& b, const Circle& circle, void* edge12,
                                             void* edge23) {
        checkpoint(5);
        return bp::voronoi_diagram<double>::_insert_new_edge(a, b, circle, edge12, edge23);
    }
};

constexpr double kPi = 3.14159265358979323846;

void build_diagram(const Outline& outline, Diagram& diagram) {
    bp::default_voronoi_builder builder;
    for (std::size_t k = 0; k < outline.edges(); ++k) {
        const Vector2d a = outline.start(k), b = outline.end(k);
        builder.insert_segment(int(a.x()), int(a.y()), int(b.x()), int(b.y()));
    }
    builder.construct(&diagram);
}

Site find_site(const Diagram::cell_type& cell, const Outline& outline) {
    const std::size_t k = cell.source_index();
    const bool is_end = cell.source_category() == bp::SOURCE_CATEGORY_SEGMENT_END_POINT;
    return {is_end ? outline.after(k) : k, cell.contains_point()};
}

/// Return whether the edge between two sites, from p to q, is in the shape.
bool is_inside(const Site& a, const Site& b, const Vector2d& p, const Vector2d& q, const Outline& outline) {
    for (const Site& site : {a, b}) {
        if (site.is_corner) continue;
        const Vector2d start = outline.start(site.edge), d = outline.end(site.edge) - start;
        return cross(d, p - start) + cross(d, q - start) > 0.0;
    }
    // between two corners: check whether the edge is within the angle of one of them
    const Vector2d corner = outline.start(a.edge), in = corner - outline.start(outline.before(a.edge));
    const Vector2d go = outline.end(a.edge) - corner, off = 0.5 * (p + q) - corner;
    const bool left_of_in = cross(in, off) > 0.0, left_of_go = cross(go, off) > 0.0;
    return cross(in, go) < 0.0 ? left_of_in || left_of_go : left_of_in && left_of_go;
}

AxisPoint to_axis_point(const Vector2d& p, double r) {
    return {p.x() / kUnitsPerMm, p.y() / kUnitsPerMm, r / kUnitsPerMm};
}

/// Return a number of pieces so that none is much longer than a fifth of the radius.
int piece_count(double length, double radius) {
    return radius > 0.0 ? int(std::clamp(length / (0.2 * radius), 0.0, 200.0)) + 1 : 1;
}

}  // namespace

VoronoiAxis::VoronoiAxis(const Outline& outline) : outline_(outline) {
    Diagram diagram;
    build_diagram(outline, diagram);
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
    for (const Diagram::edge_type& edge : diagram.edges()) {
        if (!edge.is_primary() || !edge.is_finite() || &edge > edge.twin()) continue;
        const Vector2d p(edge.vertex0()->x(), edge.vertex0()->y()), q(edge.vertex1()->x(), edge.vertex1()->y());
        const Site a = find_site(*edge.cell(), outline), b = find_site(*edge.twin()->cell(), outline);
        if (!is_inside(a, b, p, q, outline)) continue;
        for (const Diagram::edge_type* half : {&edge, edge.twin()}) {
            half_of[std::size_t(half - diagram.edges().data())] = from.size();
            from.push_back(number(half->vertex0()));
            next.push_back(none);
        }
        left.push_back(a);
        left.push_back(b);
    }
    out.resize(points.size());
    for (const Diagram::vertex_type& v : diagram.vertices()) {
        if (vertex[std::size_t(&v - diagram.vertices().data())] == none) continue;
        const Diagram::edge_type* edge = v.incident_edge();
        do {
            const std::size_t h = half_of[std::size_t(edge - diagram.edges().data())];
            if (h != none) out[from[h]].push_back(h);
            edge = edge->rot_next();
        } while (edge != v.incident_edge());
    }
}

OutlinePlace VoronoiAxis::foot(const Site& site, const Vector2d& p) const {
    if (site.is_corner) return {site.edge, 0.0};
    const Vector2d a = outline_.start(site.edge), d = outline_.end(site.edge) - a;
    return {site.edge, std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0)};
}

double VoronoiAxis::share(std::size_t h) const {
    const Vector2d& centre = points[from[h]];
    const OutlinePlace right = foot_right(h), to_left = foot(h);
    const Vector2d a = outline_.at(right), b = outline_.at(to_left);
    const double r2 = (b - centre).squaredNorm();
    if (!(r2 > 0.0)) return 0.0;
    const double area = 0.5 * (cross(centre, a) + outline_.twice_area(right, to_left) + cross(b, centre));
    double angle = std::atan2(cross(a - centre, b - centre), (a - centre).dot(b - centre));
    if (angle < 0.0) angle += 2.0 * kPi;
    return area / r2 - 0.5 * angle;
}

OutlinePlace VoronoiAxis::begin(std::size_t h) const {
    const auto& leaving = out[from[h]];
    if (leaving.size() < 2) return foot_right(h);
    const auto found = std::find(leaving.begin(), leaving.end(), h);
    return foot(found == leaving.begin() ? leaving.back() : *(found - 1));
}

AxisPoint VoronoiAxis::at_start(std::size_t h) const { return to_axis_point(points[from[h]], radius(h)); }

void VoronoiAxis::sample(std::size_t h, std::vector<AxisPoint>& line) const {
    checkpoint();
    const Vector2d &p = points[from[h]], &q = points[to(h)];
    const Site &a = left[h], &b = left[h ^ 1];
    if (a.is_corner != b.is_corner) {  // a parabola
        const Site& focus = a.is_corner ? a : b;
        const Site& directrix = a.is_corner ? b : a;
        const Vector2d f = outline_.start(focus.edge), o = outline_.start(directrix.edge);
        const Vector2d along = (outline_.end(directrix.edge) - o).normalized();
        const Vector2d up(-along.y(), along.x());
        const double height = (f - o).dot(up), middle = (f - o).dot(along);
        const double x0 = (p - o).dot(along) - middle, x1 = (q - o).dot(along) - middle;
        const int n = height > 0.0 ? piece_count(std::abs(x1 - x0), height) : 1;
        for (int i = 1; i < n; ++i) {
            const double x = x0 + (x1 - x0) * i / n, y = (x * x + height * height) / (2.0 * height);
            line.push_back(to_axis_point(o + (x + middle) * along + y * up, y));
        }
    } else if (a.is_corner) {
        const Vector2d f = outline_.start(a.edge);
        const int n = piece_count((q - p).norm(), std::min((p - f).norm(), (q - f).norm()));
        for (int i = 1; i < n; ++i) {
            const Vector2d x = p + (q - p) * i / n;
            line.push_back(to_axis_point(x, (x - f).norm()));
        }
    } else {
        const double r0 = radius(h), r1 = radius(h ^ 1);
        const int n = piece_count((q - p).norm(), std::max(r0, r1));
        for (int i = 1; i < n; ++i) line.push_back(to_axis_point(p + (q - p) * i / n, r0 + (r1 - r0) * i / n));
    }
    line.push_back(to_axis_point(q, radius(h ^ 1)));
}

}  // namespace brushsvg
