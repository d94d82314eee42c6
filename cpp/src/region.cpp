#include "brushsvg/region.hpp"

#include <algorithm>
#include <boost/polygon/polygon.hpp>
#include <cmath>

#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

namespace bp = boost::polygon;
using Point = bp::point_data<int>;
using Polygon = bp::polygon_data<int>;
using PolygonWithHoles = bp::polygon_with_holes_data<int>;
using Set = bp::polygon_set_data<int>;

// 32-bit coordinates at 1e-5 mm reach 21 m; coarser and the area of fine hatching drifts, finer and a page overflows
constexpr double kUnitsPerMm = 1e5;
// slivers that rounding leaves between shapes that only touch
constexpr double kLeastArea = 1e-6;

Polygon to_polygon(const Ring& ring) {
    std::vector<Point> points;
    points.reserve(ring.rows());
    for (Eigen::Index i = 0; i < ring.rows(); ++i) {
        const double x = ring(i, 0) * kUnitsPerMm, y = ring(i, 1) * kUnitsPerMm;
        if (!(std::abs(x) < 2e9 && std::abs(y) < 2e9)) throw Error("a ring reaches beyond 20 m");
        points.emplace_back(int(std::lround(x)), int(std::lround(y)));
    }
    Polygon polygon;
    bp::set_points(polygon, points.begin(), points.end());
    return polygon;
}

template <class Iterator>
Ring to_ring(Iterator begin, Iterator end, bool counter_clockwise) {
    std::vector<Point> points(begin, end);
    if (points.size() > 1 && points.front() == points.back()) points.pop_back();
    Ring ring(Eigen::Index(points.size()), 2);
    for (Eigen::Index i = 0; i < ring.rows(); ++i)
        ring.row(i) << points[i].x() / kUnitsPerMm, points[i].y() / kUnitsPerMm;
    if ((signed_area(ring) > 0.0) != counter_clockwise) ring = ring.colwise().reverse().eval();
    return ring;
}

Rings to_rings(const Set& set) {
    std::vector<PolygonWithHoles> polygons;
    set.get(polygons);
    Rings rings;
    const auto keep = [&](Ring ring) {
        if (std::abs(signed_area(ring)) > kLeastArea) rings.push_back(std::move(ring));
    };
    for (const PolygonWithHoles& polygon : polygons) {
        keep(to_ring(polygon.begin(), polygon.end(), true));
        for (auto hole = polygon.begin_holes(); hole != polygon.end_holes(); ++hole)
            keep(to_ring(hole->begin(), hole->end(), false));
    }
    return rings;
}

/// Rings that are already disjoint, holes included.
Set to_set(const Rings& rings) {
    Set set;
    for (const Ring& ring : rings) {
        if (ring.rows() < 3) continue;
        set.insert(to_polygon(ring), signed_area(ring) < 0.0);
    }
    set.clean();
    return set;
}

double area_of(const Set& set) {
    std::vector<PolygonWithHoles> polygons;
    set.get(polygons);
    double sum = 0.0;
    for (const PolygonWithHoles& polygon : polygons) sum += double(bp::area(polygon));
    return sum / (kUnitsPerMm * kUnitsPerMm);
}

}  // namespace

Rings unite(const Rings& rings) {
    // a tree of small unions: neighbours overlap most, and a sweep over all of them at once meets every crossing twice
    std::vector<Set> level;
    level.reserve(rings.size());
    for (const Ring& ring : rings) {
        if (ring.rows() < 3) continue;
        const bool hole = signed_area(ring) < 0.0;
        if (!hole || level.empty()) level.emplace_back();
        level.back().insert(to_polygon(ring), hole);
    }
    if (level.empty()) return {};
    while (level.size() > 1) {
        std::vector<Set> next;
        for (std::size_t i = 0; i < level.size(); i += 4) {
            Set set;
            for (std::size_t j = i; j < std::min(level.size(), i + 4); ++j) set.insert(level[j]);
            set.clean();
            next.push_back(std::move(set));
        }
        level = std::move(next);
    }
    return to_rings(level.front());
}

namespace {

// a ring can run round a point any number of times; who winds more than this draws a spiral by mistake
constexpr int kMostTurns = 32;

/// Where the outlines run counter-clockwise `turns` times or more round a point; reversed: clockwise. The sweep keeps
/// what is counted once or more, so a frame about everything takes turns - 1 away.
Set wound(const Rings& outlines, int turns, bool reversed) {
    const auto insert = [reversed](Set& set, const Ring& ring, bool once) {
        const Polygon polygon = to_polygon(ring);
        const bool positive = once != reversed;
        set.insert_vertex_sequence(polygon.begin(), polygon.end(), positive ? bp::COUNTERCLOCKWISE : bp::CLOCKWISE,
                                   false);
    };
    Set set;
    for (const Ring& ring : outlines)
        if (ring.rows() >= 3) insert(set, ring, true);
    if (turns > 1) {
        bp::rectangle_data<int> box;
        if (!bp::extents(box, set)) return set;
        std::vector<Point> frame{{bp::xl(box) - 1, bp::yl(box) - 1},
                                 {bp::xh(box) + 1, bp::yl(box) - 1},
                                 {bp::xh(box) + 1, bp::yh(box) + 1},
                                 {bp::xl(box) - 1, bp::yh(box) + 1}};
        set.clear();
        for (const Ring& ring : outlines)
            if (ring.rows() >= 3) insert(set, ring, true);
        for (int k = 1; k < turns; ++k) set.insert_vertex_sequence(frame.begin(), frame.end(), bp::CLOCKWISE, false);
    }
    set.clean();
    return set;
}

}  // namespace

Rings fill(const Rings& outlines, FillRule rule) {
    Set filled;
    for (bool reversed : {false, true}) {
        for (int turns = 1; turns <= (rule == FillRule::nonzero ? 1 : kMostTurns); ++turns) {
            const Set level = wound(outlines, turns, reversed);
            if (level.empty()) break;
            filled.insert(level, turns % 2 == 0);  // each level lies in the one before
        }
    }
    filled.clean();
    return to_rings(filled);
}

double area(const Rings& rings) {
    double sum = 0.0;
    for (const Ring& ring : rings) sum += signed_area(ring);
    return sum;
}

double overlap(const Rings& a, const Rings& b) {
    using namespace bp::operators;
    const Set first = to_set(a), second = to_set(b);
    Set both;
    both = first & second;
    const double shared = area_of(both), all = area_of(first) + area_of(second) - shared;
    return all > 0.0 ? shared / all : 1.0;
}

Ring convex_hull(const Ring& points) {
    std::vector<Eigen::Vector2d> p(points.rows());
    for (Eigen::Index i = 0; i < points.rows(); ++i) p[i] = points.row(i).transpose();
    std::sort(p.begin(), p.end(),
              [](const auto& a, const auto& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
    std::vector<Eigen::Vector2d> hull;
    const auto turns_right = [&](const Eigen::Vector2d& c) {
        const Eigen::Vector2d &a = hull[hull.size() - 2], &b = hull.back();
        return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x()) <= 0.0;
    };
    for (int pass = 0; pass < 2; ++pass) {
        const std::size_t floor = hull.size() + 1;
        for (const auto& c : p) {
            while (hull.size() > floor && turns_right(c)) hull.pop_back();
            hull.push_back(c);
        }
        hull.pop_back();
        std::reverse(p.begin(), p.end());
    }
    Ring ring(Eigen::Index(hull.size()), 2);
    for (Eigen::Index i = 0; i < ring.rows(); ++i) ring.row(i) = hull[i].transpose();
    return ring;
}

}  // namespace brushsvg
