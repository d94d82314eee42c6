#include "brushsvg/region.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/polygon/polygon.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/run_cancellable.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "regions/chain_union.hpp"
#include "regions/nearest_on_polyline.hpp"
#include "regions/star_union.hpp"

namespace brushsvg {
namespace {

namespace bp = boost::polygon;
using Point = bp::point_data<int>;
using Polygon = bp::polygon_data<int>;
using PolygonWithHoles = bp::polygon_with_holes_data<int>;
using Set = bp::polygon_set_data<int>;

// 32-bit coordinates at 1e-5 mm reach 21 m. With coarser units the area of fine hatching drifts, with finer ones a page
// overflows.
constexpr double kUnitsPerMm = 1e5;
// Boost rounds crossings to a unit. Where many edges are as near to each other as that, it loses areas: in 1 of 100
// unions of outlines whose corners differ by rounding along one diagonal. With corners on multiples of two units 1 of
// 3,000 was lost, on multiples of four none.
constexpr int kCoarseStepUnits = 4;
// Largest area [mm^2] of slivers that rounding leaves between touching shapes. Slivers narrower than two units are
// removed as well.
constexpr double kMinAreaMm2 = 1e-6;
// Boost works in one piece and cannot be cancelled. A thousand corners take it a hundredth of a second, or a second if
// each edge crosses all others. A thread costs less than the work on a hundred corners.
constexpr Eigen::Index kMinCornersForThread = 300;
// Half the width [mm] below which a piece of a hull is not worth its corners: a hundred times the rounding error.
constexpr double kMinPieceHalfWidthMm = 2e-3;

Polygon to_polygon(const Ring& ring) {
    std::vector<Point> points;
    points.reserve(ring.rows());
    for (Eigen::Index i = 0; i < ring.rows(); ++i) {
        const double x = ring(i, 0) * kUnitsPerMm, y = ring(i, 1) * kUnitsPerMm;
        if (!(std::abs(x) < 2e9 && std::abs(y) < 2e9))
            throw Error("geometry-out-of-range", "a ring has a coordinate beyond 20 m or not finite: check its unit");
        points.emplace_back(int(std::lround(x)), int(std::lround(y)));
    }
    Polygon polygon;
    bp::set_points(polygon, points.begin(), points.end());
    return polygon;
}

/// Thrown where Boost could not combine outlines.
struct NotCombined : Error {
    NotCombined()
        : Error("outline-too-complex",
                "some outlines nearly coincide and cannot be combined: unite them in the drawing") {}
};

/// Return the polygons of a set. Throws NotCombined if its edges do not close, or if its polygons do not have the area
/// within its edges.
std::vector<PolygonWithHoles> polygons_of(const Set& set) {
    set.clean();
    std::int64_t gap_x = 0, gap_y = 0;
    double twice_area = 0.0, size = 0.0;
    for (auto edge = set.begin(); edge != set.end(); ++edge) {
        const Point &from = edge->first.first, &to = edge->first.second;
        const int way = from.x() == to.x() ? -edge->second : edge->second;  // vertical edges have the other sign
        gap_x += way * (std::int64_t(to.x()) - from.x());
        gap_y += way * (std::int64_t(to.y()) - from.y());
        const double product = double(from.x()) * to.y() - double(to.x()) * from.y();
        twice_area += way * product;
        size += std::abs(product);
    }
    if (gap_x != 0 || gap_y != 0) throw NotCombined();  // Boost may end the process if it forms polygons from these
    std::vector<PolygonWithHoles> polygons;
    set.get(polygons);
    for (const PolygonWithHoles& polygon : polygons) twice_area -= 2.0 * double(bp::area(polygon));
    if (std::abs(twice_area) > 1e-12 * size + kMinAreaMm2 * kUnitsPerMm * kUnitsPerMm) throw NotCombined();
    return polygons;
}

/// Return rings with their corners on multiples of kCoarseStepUnits.
Rings on_coarse_grid(const Rings& rings) {
    constexpr double kStepsPerMm = kUnitsPerMm / kCoarseStepUnits;
    Rings out;
    for (const Ring& ring : rings) out.push_back(((ring.array() * kStepsPerMm).round() / kStepsPerMm).matrix());
    return out;
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
    Rings rings;
    const auto keep = [&](Ring ring) {
        if (std::abs(signed_area(ring)) > std::max(kMinAreaMm2, length_around(ring) / kUnitsPerMm))
            rings.push_back(std::move(ring));
    };
    for (const PolygonWithHoles& polygon : polygons_of(set)) {
        keep(to_ring(polygon.begin(), polygon.end(), true));
        for (auto hole = polygon.begin_holes(); hole != polygon.end_holes(); ++hole)
            keep(to_ring(hole->begin(), hole->end(), false));
    }
    return rings;
}

/// Refuse rings that are clockwise in total. They are holes in nothing: a shape that is read with y down would vanish
/// silently.
void require_outer_rings(const Rings& rings) {
    const double sum = area(rings);
    if (sum < -kMinAreaMm2)
        throw Error("outline-clockwise",
                    "the rings are clockwise: list outer rings counter-clockwise and holes clockwise", "", sum);
}

/// Return the set of rings that are already disjoint, including holes.
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
    double sum = 0.0;
    for (const PolygonWithHoles& polygon : polygons_of(set)) sum += double(bp::area(polygon));
    return sum / (kUnitsPerMm * kUnitsPerMm);
}

void require_finite(const Ring& ring) {
    if (!ring.allFinite()) throw Error("not-finite", "a ring has a coordinate that is not finite");
}

/// Return the indices of the points from left to right, and from below where one is above the other. Most points are
/// corners of convex rings, which run there and back: such runs are merged.
std::vector<Eigen::Index> order_left_to_right(const Ring& points) {
    const Eigen::Index n = points.rows();
    const auto is_before = [&](Eigen::Index a, Eigen::Index b) {
        return points(a, 0) < points(b, 0) || (points(a, 0) == points(b, 0) && points(a, 1) < points(b, 1));
    };
    std::vector<Eigen::Index> order(n), other(n);
    std::iota(order.begin(), order.end(), Eigen::Index(0));
    std::vector<Eigen::Index> begins;
    for (Eigen::Index i = 0; i < n;) {
        begins.push_back(i);
        const Eigen::Index first = i;
        ++i;
        const bool rises = i < n && !is_before(i, i - 1);
        while (i < n && is_before(i, i - 1) != rises) ++i;
        if (!rises) std::reverse(order.begin() + first, order.begin() + i);
    }
    begins.push_back(n);
    while (begins.size() > 2) {
        checkpoint(int(n / 50));
        std::vector<Eigen::Index> fewer;
        for (std::size_t k = 0; k + 1 < begins.size(); k += 2) {
            const Eigen::Index middle = begins[k + 1], end = k + 2 < begins.size() ? begins[k + 2] : middle;
            std::merge(order.begin() + begins[k], order.begin() + middle, order.begin() + middle, order.begin() + end,
                       other.begin() + begins[k], is_before);
            fewer.push_back(begins[k]);
        }
        fewer.push_back(n);
        begins = std::move(fewer);
        order.swap(other);
    }
    return order;
}

/// Return the indices of the points that are corners of their convex hull, counter-clockwise.
std::vector<Eigen::Index> hull_order(const Ring& points) {
    std::vector<Eigen::Index> order = order_left_to_right(points);
    std::vector<Eigen::Index> hull;
    if (order.empty()) return hull;
    const auto turns_right = [&](Eigen::Index c) {
        const Eigen::Index a = hull[hull.size() - 2], b = hull.back();
        return (points(b, 0) - points(a, 0)) * (points(c, 1) - points(b, 1)) -
                   (points(b, 1) - points(a, 1)) * (points(c, 0) - points(b, 0)) <=
               0.0;
    };
    for (int pass = 0; pass < 2; ++pass) {
        const std::size_t floor = hull.size() + 1;
        for (const Eigen::Index c : order) {
            while (hull.size() > floor && turns_right(c)) hull.pop_back();
            hull.push_back(c);
        }
        hull.pop_back();
        std::reverse(order.begin(), order.end());
    }
    return hull;
}

Ring select_rows(const Ring& points, const std::vector<Eigen::Index>& numbers) {
    Ring ring(Eigen::Index(numbers.size()), 2);
    for (Eigen::Index i = 0; i < ring.rows(); ++i) ring.row(i) = points.row(numbers[i]);
    return ring;
}

Ring concatenate(const Ring& a, const Ring& b) {
    Ring points(a.rows() + b.rows(), 2);
    points << a, b;
    return points;
}

/// Run work(rings ...). Where Boost fails, run it again with corners on a coarser grid.
template <class Work, class... Shapes>
auto combine(const Work& work, const Shapes&... shapes) {
    try {
        return work(shapes...);
    } catch (const NotCombined&) {
        return work(on_coarse_grid(shapes)...);
    }
}

/// Combine shapes so that it can be cancelled at any step of Boost.
template <class Work, class... Shapes>
auto run_in_thread_if_large(const Work& work, const Shapes&... shapes) {
    Eigen::Index corners = 0;
    for (const Rings* rings : {&shapes...})
        for (const Ring& ring : *rings) corners += ring.rows();
    if (corners < kMinCornersForThread) return combine(work, shapes...);
    return run_cancellable([=] { return combine(work, shapes...); });
}

Rings unite_in_tree(const Rings& rings) {
    require_outer_rings(rings);
    // unite in a tree: neighbours overlap most, and one sweep over all rings would meet every crossing twice
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
            checkpoint(100);
            set.clean();
            next.push_back(std::move(set));
        }
        level = std::move(next);
    }
    return to_rings(level.front());
}

// Each turn costs a sweep over everything. Letters turn twice. Nested contours are cheaper one by one. A single ring
// that winds more than kMaxTurns is a star or a spiral of a hundred points, not lettering.
constexpr int kMaxTurnsTogether = 3, kMaxTurns = 32;

/// Return where the outlines run counter-clockwise `turns` times or more round a point; reversed: clockwise. The sweep
/// keeps areas that count once or more, so a frame about everything subtracts turns - 1.
Set fill_by_winding(const Rings& outlines, int turns, bool reversed) {
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
    checkpoint(1000);
    set.clean();
    return set;
}

/// Return where the outlines run round a point an odd number of times. None if they do so more than `most` times
/// anywhere.
std::optional<Set> fill_odd_windings(const Rings& outlines, int most) {
    Set filled;
    for (bool reversed : {false, true}) {
        for (int turns = 1;; ++turns) {
            const Set level = fill_by_winding(outlines, turns, reversed);
            if (level.empty()) break;
            if (turns > most) return std::nullopt;
            filled.insert(level, turns % 2 == 0);  // each level is in the one before
        }
    }
    filled.clean();
    return filled;
}

/// Return where the outlines run round a point an odd number of times, however often they are nested. Each outline is
/// filled by itself. Then the fills are combined in a tree.
Set fill_odd_nesting(const Rings& outlines) {
    using namespace bp::operators;
    std::vector<Set> level;
    for (const Ring& ring : outlines) {
        std::optional<Set> alone = fill_odd_windings({ring}, kMaxTurns);
        if (!alone)
            throw Error("outline-too-complex", "an outline winds more than " + std::to_string(kMaxTurns) +
                                                   " times around a point: simplify it in the drawing");
        level.push_back(std::move(*alone));
    }
    while (level.size() > 1) {
        std::vector<Set> next;
        for (std::size_t i = 0; i < level.size(); i += 2) {
            checkpoint(1000);
            if (i + 1 < level.size()) level[i] ^= level[i + 1];
            next.push_back(std::move(level[i]));
        }
        level = std::move(next);
    }
    return level.empty() ? Set() : level.front();
}

Rings fill_outlines(const Rings& outlines, FillRule rule) {
    if (rule == FillRule::evenodd) {
        const std::optional<Set> filled = fill_odd_windings(outlines, kMaxTurnsTogether);
        return to_rings(filled ? *filled : fill_odd_nesting(outlines));
    }
    Set filled;
    for (bool reversed : {false, true}) filled.insert(fill_by_winding(outlines, 1, reversed));
    filled.clean();
    return to_rings(filled);
}

/// Return the sides of a window that a corner is beyond, one bit for each of the four sides.
int outcode(const Eigen::RowVector2d& corner, const Eigen::AlignedBox2d& window) {
    return (corner.x() < window.min().x()) | (corner.x() > window.max().x()) << 1 |
           (corner.y() < window.min().y()) << 2 | (corner.y() > window.max().y()) << 3;
}

/// Return the ring without corners between two others beyond the same side of a window. Nothing changes inside the
/// window.
Ring clip_to_window(const Ring& ring, const Eigen::AlignedBox2d& window) {
    std::vector<Eigen::Index> kept;
    int last = 0;
    for (Eigen::Index i = 0; i < ring.rows(); ++i) {
        const int side = outcode(ring.row(i), window);
        const int next = i + 1 < ring.rows() ? outcode(ring.row(i + 1), window) : 0;
        if (last & side & next) continue;
        kept.push_back(i);
        last = side;
    }
    if (kept.size() == std::size_t(ring.rows())) return ring;
    Ring out(Eigen::Index(kept.size()), 2);
    for (Eigen::Index k = 0; k < out.rows(); ++k) out.row(k) = ring.row(kept[std::size_t(k)]);
    // far outside of the window the ring may cross itself, so that its total orientation is reversed
    return (signed_area(out) < 0.0) == (signed_area(ring) < 0.0) ? out : ring;
}

/// Return the parts of some rings that can meet others. A box is often compared with a whole letter.
Rings clip_to_others(const Rings& rings, const Rings& others) {
    Eigen::AlignedBox2d window;
    for (const Ring& ring : others)
        for (Eigen::Index i = 0; i < ring.rows(); ++i) window.extend(ring.row(i).transpose());
    Rings out;
    if (window.isEmpty()) return out;
    for (const Ring& ring : rings) {
        Eigen::AlignedBox2d box;
        for (Eigen::Index i = 0; i < ring.rows(); ++i) box.extend(ring.row(i).transpose());
        if (box.intersects(window)) out.push_back(clip_to_window(ring, window));
    }
    return out;
}

Rings intersect_sets(const Rings& a, const Rings& b) {
    using namespace bp::operators;
    const Set first = to_set(a), second = to_set(b);
    Set both;
    both = first & second;
    return to_rings(both);
}

double overlap_share(const Rings& a, const Rings& b) {
    using namespace bp::operators;
    require_outer_rings(a);
    require_outer_rings(b);
    const Set first = to_set(a), second = to_set(b);
    Set both;
    both = first & second;
    const double shared = area_of(both), all = area_of(first) + area_of(second) - shared;
    return all > 0.0 ? shared / all : 1.0;
}

}  // namespace

Rings unite(const Rings& rings) {
    require_outer_rings(rings);
    const StarUnion fewer = unite_stars(rings);
    const std::optional<Rings> chains = fewer.are_stars ? unite_chain(fewer.rings, kUnitsPerMm) : std::nullopt;
    if (chains && chains->size() == 1) return *chains;
    return run_in_thread_if_large(unite_in_tree, chains ? *chains : fewer.rings);
}

Rings fill(const Rings& outlines, FillRule rule) {
    return run_in_thread_if_large([rule](const Rings& rings) { return fill_outlines(rings, rule); }, outlines);
}

Rings intersect(const Rings& a, const Rings& b) {
    require_outer_rings(a);
    require_outer_rings(b);
    return run_in_thread_if_large(intersect_sets, clip_to_others(a, b), clip_to_others(b, a));
}

double area(const Rings& rings) {
    double sum = 0.0;
    for (const Ring& ring : rings) sum += signed_area(ring);
    if (!std::isfinite(sum)) throw Error("geometry-out-of-range", "a ring has a coordinate that is not finite");
    return sum;
}

double overlap(const Rings& a, const Rings& b) { return run_in_thread_if_large(overlap_share, a, b); }

Ring convex_hull(const Ring& points) {
    require_finite(points);
    return select_rows(points, hull_order(points));
}

std::vector<double> clearance(const Rings& rings, const Ring& points) {
    require_finite(points);
    for (const Ring& ring : rings) require_finite(ring);
    Rings closed;
    for (const Ring& ring : rings)
        if (ring.rows() > 0) closed.push_back(concatenate(ring, ring.row(0)));
    std::vector<NearestOnPolyline<Ring>> outlines(closed.begin(), closed.end());
    std::vector<double> distances;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        double least = std::numeric_limits<double>::infinity();
        checkpoint(int(outlines.size()));
        for (auto& outline : outlines) least = std::min(least, outline.distance(points.row(i).transpose(), least));
        distances.push_back(least);
    }
    return distances;
}

std::vector<double> first_crossings(const Rings& rings, const Ring& places, const Ring& directions) {
    if (directions.rows() != places.rows())
        throw Error("sizes-differ", "there are " + std::to_string(directions.rows()) + " directions for " +
                                        std::to_string(places.rows()) + " places: give one direction for each place");
    require_finite(places);
    require_finite(directions);
    for (const Ring& ring : rings) require_finite(ring);
    std::vector<double> nearest(std::size_t(places.rows()), std::numeric_limits<double>::infinity());
    for (Eigen::Index k = 0; k < places.rows(); ++k) {
        const Eigen::Vector2d direction = directions.row(k).transpose();
        for (const Ring& ring : rings) {
            checkpoint(1 + int(ring.rows() / 100));
            const auto ahead = [&](Eigen::Index i) { return (ring.row(i) - places.row(k)).dot(direction); };
            const auto left = [&](Eigen::Index i) {
                return direction.x() * (ring(i, 1) - places(k, 1)) - direction.y() * (ring(i, 0) - places(k, 0));
            };
            const Eigen::Index n = ring.rows();
            double left_before = n > 0 ? left(n - 1) : 0.0;
            for (Eigen::Index i = 0, before = n - 1; i < n; before = i++) {
                const double left_here = left(i);
                if ((left_here > 0.0) != (left_before > 0.0)) {
                    const double from = ahead(before);
                    const double crossed = from + (ahead(i) - from) * left_before / (left_before - left_here);
                    if (crossed > 0.0) nearest[std::size_t(k)] = std::min(nearest[std::size_t(k)], crossed);
                }
                left_before = left_here;
            }
        }
    }
    return nearest;
}

Rings pieces_between(const Rings& chain) {
    for (const Ring& ring : chain) require_finite(ring);
    if (chain.size() < 2) return chain;
    using Numbers = std::vector<Eigen::Index>;
    Rings pairs;                 // F_i and F_i+1
    std::vector<Numbers> hulls;  // hulls of the pairs; corners of F_i+1 are numbered after the corners of F_i
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        checkpoint(10);
        pairs.push_back(concatenate(chain[i], chain[i + 1]));
        hulls.push_back(hull_order(pairs.back()));
    }
    // Between two corners of F_i that stay, others of F_i can go: the area that they enclose is in F_i, so in the hull
    // before. Corners of F_i+1 that are not in the next hull can go as well. The area that they enclose is in the next
    // hull, and the next hull does not lose it.
    Rings pieces;
    std::vector<bool> in_next;
    for (std::size_t i = 0; i < hulls.size(); ++i) {
        checkpoint(10);
        const Numbers& hull = hulls[i];
        const Eigen::Index n = chain[i].rows();
        const bool is_first = i == 0, is_last = i + 1 == hulls.size();
        in_next.assign(std::size_t(chain[i + 1].rows()), is_last);
        if (!is_last)
            for (const Eigen::Index k : hulls[i + 1])
                if (k < chain[i + 1].rows()) in_next[std::size_t(k)] = true;
        const bool is_one = std::all_of(hull.begin(), hull.end(), [&](auto k) { return k < n; }) ||
                            std::all_of(hull.begin(), hull.end(), [&](auto k) { return k >= n; });
        Numbers kept;
        const std::size_t m = hull.size();
        // number of neighbours of the same shape before and behind each corner; go round twice because the ends meet
        std::vector<std::size_t> before(m, 0), behind(m, 0);
        for (std::size_t k = 1, b = 0, d = m - 1; !is_one && k < 2 * m; ++k) {
            const std::size_t a = b, c = d;
            b = b + 1 == m ? 0 : b + 1;
            d = d == 0 ? m - 1 : d - 1;
            before[b] = (hull[a] >= n) == (hull[b] >= n) ? before[a] + 1 : 0;
            behind[d] = (hull[c] >= n) == (hull[d] >= n) ? behind[c] + 1 : 0;
        }
        for (std::size_t k = 0; k < m; ++k) {
            const bool front = hull[k] >= n;
            // keep the middle corner as well: pieces must overlap, because rounding would leave cracks where they only
            // meet
            const bool rear_stays = is_first || before[k] == behind[k] || before[k] == behind[k] + 1;
            if (is_one || before[k] == 0 || behind[k] == 0 || (front ? in_next[std::size_t(hull[k] - n)] : rear_stays))
                kept.push_back(hull[k]);
        }
        // a shape that grows or turns in place leaves strips that are so thin that rounding would fray the outline
        Ring piece = select_rows(pairs[i], kept);
        if (kept.size() < 3 || signed_area(piece) < kMinPieceHalfWidthMm * length_around(piece))
            piece = select_rows(pairs[i], hull);
        pieces.push_back(std::move(piece));
    }
    return pieces;
}

}  // namespace brushsvg
