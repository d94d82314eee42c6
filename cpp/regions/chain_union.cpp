#include "regions/chain_union.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg {
namespace {

using Unit = std::int64_t;
struct Corner {
    Unit x, y;
    bool operator==(const Corner& other) const { return x == other.x && y == other.y; }
    Corner operator-(const Corner& other) const { return {x - other.x, y - other.y}; }
};
using Corners = std::vector<Corner>;

constexpr double kMaxUnits = 5e8;  // units: up to here, products of two lengths are exact
constexpr double kMinAreaMm2 = 1e-6;
constexpr std::size_t kMaxEdgePairs = 1 << 22;  // most pairs of edges: with more, a sweep is quicker

Unit cross(const Corner& a, const Corner& b) { return a.x * b.y - a.y * b.x; }
int sign(Unit value) { return (value > 0) - (value < 0); }

bool is_left_of(const Corner& a, const Corner& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; }

Corners to_corners(const Ring& ring, double units_per_mm) {
    Corners corners;
    for (Eigen::Index i = 0; i < ring.rows(); ++i) {
        const Corner corner{std::lround(ring(i, 0) * units_per_mm), std::lround(ring(i, 1) * units_per_mm)};
        if (corners.empty() || !(corner == corners.back())) corners.push_back(corner);
    }
    while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
    return corners;
}

/// Return on which side of the edge from `from` to `to` a corner of the second shape is: 1 left, -1 right. No corner
/// counts as on an edge of the other shape. The second shape counts as shifted by (e, e^2), for an e that is less than
/// any length.
int side_of_second(const Corner& from, const Corner& to, const Corner& corner) {
    const Corner edge = to - from;
    const Unit twice = cross(edge, corner - from);
    return twice != 0 ? sign(twice) : edge.y != 0 ? -sign(edge.y) : sign(edge.x);
}
/// Return on which side of an edge of the second shape a corner of the first shape is, with the shift of the second.
int side_of_first(const Corner& from, const Corner& to, const Corner& corner) {
    const Corner edge = to - from;
    const Unit twice = cross(edge, corner - from);
    return twice != 0 ? sign(twice) : edge.y != 0 ? sign(edge.y) : -sign(edge.x);
}

/// A crossing of an edge of the first shape and an edge of the second. It has the numbers of both edges. The positions
/// along them are exact fractions with the common denominator `slant`. `ways`: vectors of both edges.
struct Crossing {
    std::size_t edge[2];
    Corner edge_vectors[2];
    Unit along[2], slant;
    bool first_enters;
    Corner place;

    /// Return whether it comes before another crossing on the same edge of a shape. If both are at one place, the shift
    /// decides.
    bool comes_before(const Crossing& other, int of) const {
        __extension__ using Exact = __int128;
        const Exact mine = Exact(along[of]) * other.slant, others = Exact(other.along[of]) * slant;
        const int order = sign(slant) * sign(other.slant);
        if (mine != others) return (mine < others) == (order > 0);
        // the shift moves a crossing along by e y - e^2 x of the other edge, over the slant
        const Corner &other_edge = edge_vectors[1 - of], &other_edge_there = other.edge_vectors[1 - of];
        const auto compare_shifts = [&](Unit here, Unit there) {
            return order * sign(Unit((Exact(there) * slant > Exact(here) * other.slant) -
                                     (Exact(there) * slant < Exact(here) * other.slant)));
        };
        const int first = compare_shifts(other_edge.y, other_edge_there.y);
        return first != 0 ? first > 0 : compare_shifts(-other_edge.x, -other_edge_there.x) > 0;
    }
};

struct Box {
    Unit left, bottom, right, top;
    bool meets(const Box& other) const {
        return left <= other.right && right >= other.left && bottom <= other.top && top >= other.bottom;
    }
};
Box box_of(const Corner& a, const Corner& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
}
Box box_of(const Corners& corners) {
    Box box = box_of(corners[0], corners[0]);
    for (const Corner& c : corners)
        box = {std::min(box.left, c.x), std::min(box.bottom, c.y), std::max(box.right, c.x), std::max(box.top, c.y)};
    return box;
}

struct Edge {
    std::size_t number;
    Box box;
};
std::vector<Edge> edges_in(const Corners& corners, const Box& window) {
    std::vector<Edge> edges;
    for (std::size_t i = 0, n = corners.size(); i < n; ++i) {
        const Box box = box_of(corners[i], corners[i + 1 == n ? 0 : i + 1]);
        if (box.meets(window)) edges.push_back({i, box});
    }
    return edges;
}

/// Find all crossings. None if too many pairs of edges would have to be compared.
std::optional<std::vector<Crossing>> find_crossings(const Corners& first, const Corners& second) {
    const Box of_second = box_of(second), of_first = box_of(first);
    const Box window{std::max(of_first.left, of_second.left), std::max(of_first.bottom, of_second.bottom),
                     std::min(of_first.right, of_second.right), std::min(of_first.top, of_second.top)};
    const std::vector<Edge> near = edges_in(first, window);
    std::vector<Edge> others = edges_in(second, window);
    if (near.size() * others.size() > kMaxEdgePairs) return std::nullopt;
    const auto is_lower = [](const Edge& a, const Edge& b) { return a.box.bottom < b.box.bottom; };
    std::sort(others.begin(), others.end(), is_lower);
    Unit tallest = 0;
    for (const Edge& edge : others) tallest = std::max(tallest, edge.box.top - edge.box.bottom);
    std::vector<Crossing> found;
    for (const Edge& edge : near) {
        checkpoint();
        const Corner &a = first[edge.number], &b = first[edge.number + 1 == first.size() ? 0 : edge.number + 1];
        auto other = std::lower_bound(others.begin(), others.end(), edge.box.bottom - tallest,
                                      [](const Edge& e, Unit bottom) { return e.box.bottom < bottom; });
        for (; other != others.end() && other->box.bottom <= edge.box.top; ++other) {
            if (!other->box.meets(edge.box)) continue;
            const Corner &c = second[other->number],
                         &d = second[other->number + 1 == second.size() ? 0 : other->number + 1];
            if (side_of_second(a, b, c) == side_of_second(a, b, d)) continue;
            const int before = side_of_first(c, d, a);
            if (before == side_of_first(c, d, b)) continue;
            const Corner along = b - a, across = d - c, between = c - a;
            Crossing crossing{
                {edge.number, other->number}, {along, across}, {cross(between, across), cross(between, along)},
                cross(along, across),         before < 0,      {}};
            const double share = double(crossing.along[0]) / double(crossing.slant);
            crossing.place = {a.x + Unit(std::floor(share * double(along.x))),  // rounded down, as in `region`
                              a.y + Unit(std::floor(share * double(along.y)))};
            found.push_back(crossing);
        }
    }
    return found;
}

/// Sort the crossings into the order in which an outline meets them. Return false if the outline does not enter and
/// leave alternately. Only shapes that cross themselves do that.
bool sort_along_outline(const std::vector<Crossing>& all, int of, std::vector<std::size_t>& order) {
    order.resize(all.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const Crossing &one = all[a], &other = all[b];
        return one.edge[of] != other.edge[of] ? one.edge[of] < other.edge[of] : one.comes_before(other, of);
    });
    for (std::size_t k = 1; k < order.size(); ++k)
        if (all[order[k]].first_enters == all[order[k - 1]].first_enters) return false;
    return order.size() % 2 == 0;
}

/// Return 1 if a place is inside of an outline, -1 if it is outside, 0 if it is on it.
int side_of_outline(const Corners& corners, const Corner& place) {
    bool inside = false;
    for (std::size_t i = 0, n = corners.size(); i < n; ++i) {
        const Corner &a = corners[i], &b = corners[i + 1 == n ? 0 : i + 1];
        if ((a.y > place.y && b.y > place.y) || (a.y < place.y && b.y < place.y)) continue;
        const Unit twice = cross(b - a, place - a);
        if (twice == 0 && box_of(a, b).meets(box_of(place, place))) return 0;
        if ((a.y > place.y) != (b.y > place.y) && (twice > 0) == (b.y > a.y)) inside = !inside;
    }
    return inside ? 1 : -1;
}

/// Return whether a part of an outline is on the side of the other outline that its crossings imply. The first corner
/// of the part that is not exactly on the other outline decides. Crossings are wrong where rounding has made a shape
/// cross itself.
bool is_on_expected_side(const Corners& corners, std::size_t after, std::size_t last, int depth, const Corners& other) {
    for (std::size_t i = after, n = corners.size(); i != last;) {
        i = i + 1 == n ? 0 : i + 1;
        if (const int found = side_of_outline(other, corners[i]); found != 0) return found == depth;
    }
    return true;
}

double area_of(const Corners& corners) {
    double twice = 0.0;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        twice += double(cross(corners[i] - corners[0], corners[i + 1] - corners[0]));
    return 0.5 * twice;
}
double length_around(const Corners& corners) {
    double length = 0.0;
    for (std::size_t i = 0, n = corners.size(); i < n; ++i) {
        const Corner edge = corners[i + 1 == n ? 0 : i + 1] - corners[i];
        length += std::hypot(double(edge.x), double(edge.y));
    }
    return length;
}

bool is_straight(const Corner& a, const Corner& b, const Corner& c) { return cross(b - a, c - b) == 0; }

/// Remove corners where nothing turns, and ways there and back.
void straighten(Corners& corners) {
    Corners kept;
    for (const Corner& corner : corners) {
        while (kept.size() > 1 && is_straight(kept[kept.size() - 2], kept.back(), corner)) kept.pop_back();
        if (kept.empty() || !(corner == kept.back())) kept.push_back(corner);
    }
    std::size_t first = 0;
    while (kept.size() - first > 2) {
        if (is_straight(kept[kept.size() - 2], kept.back(), kept[first]))
            kept.pop_back();
        else if (is_straight(kept.back(), kept[first], kept[first + 1]))
            ++first;
        else
            break;
    }
    corners.assign(kept.begin() + std::ptrdiff_t(first), kept.end());
}

bool touches_itself(Corners corners) {
    std::sort(corners.begin(), corners.end(), is_left_of);
    return std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

/// Unite two shapes if the outline of both is one ring, which replaces `first`. Return whether it is one ring.
bool unite_into(Corners& first, const Corners& second, double least_area) {
    const std::optional<std::vector<Crossing>> found = find_crossings(first, second);
    if (!found) return false;
    const std::vector<Crossing>& all = *found;
    if (all.empty()) {
        if (side_of_outline(first, second[0]) > 0) return true;
        if (side_of_outline(second, first[0]) < 1) return false;
        first = second;
        return true;
    }
    const Corners* shapes[2] = {&first, &second};
    std::vector<std::size_t> order[2], at[2];
    for (int of : {0, 1}) {
        if (!sort_along_outline(all, of, order[of])) return false;
        at[of].resize(all.size());
        for (std::size_t k = 0; k < all.size(); ++k) {
            const Crossing &here = all[order[of][k]], &next = all[order[of][k + 1 == all.size() ? 0 : k + 1]];
            const int depth = here.first_enters == (of == 0) ? 1 : -1;
            if (!is_on_expected_side(*shapes[of], here.edge[of], next.edge[of], depth, *shapes[1 - of])) return false;
            at[of][order[of][k]] = k;
        }
    }
    // Follow the first shape from where it leaves the second until it enters the second again. There the second shape
    // leaves the first.
    std::vector<bool> is_done(all.size(), false);
    Corners outline, cycle;
    for (std::size_t begin = 0; begin < all.size(); ++begin) {
        if (all[begin].first_enters || is_done[begin]) continue;
        cycle.clear();
        std::size_t k = begin;
        do {
            is_done[k] = true;
            for (int of : {0, 1}) {
                const Corners& shape = *shapes[of];
                const std::size_t n = shape.size(), place = at[of][k];
                const std::size_t next = order[of][place + 1 == all.size() ? 0 : place + 1];
                cycle.push_back(all[k].place);
                const bool is_same_edge = all[next].edge[of] == all[k].edge[of] && place + 1 != all.size();
                if (!is_same_edge)
                    for (std::size_t i = all[k].edge[of];;) {
                        i = i + 1 == n ? 0 : i + 1;
                        cycle.push_back(shape[i]);
                        if (i == all[next].edge[of]) break;
                    }
                k = next;
            }
        } while (!is_done[k]);
        if (k != begin) return false;
        const double area = area_of(cycle);
        if (std::abs(area) <= std::max(least_area, length_around(cycle))) continue;  // left over by rounding
        if (area < 0.0 || !outline.empty()) return false;
        outline = cycle;
    }
    if (area_of(outline) + length_around(outline) < std::max(area_of(first), area_of(second))) return false;
    straighten(outline);
    if (touches_itself(outline)) return false;
    first = std::move(outline);
    return true;
}

}  // namespace

std::optional<Rings> unite_chain(const Rings& rings, double units_per_mm) {
    std::vector<Corners> level;
    const double least_area = kMinAreaMm2 * units_per_mm * units_per_mm;
    for (const Ring& ring : rings) {
        if (!(ring.rows() > 0 && (ring * units_per_mm).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() < kMaxUnits))
            return std::nullopt;
        if (Corners corners = to_corners(ring, units_per_mm); corners.size() > 2) level.push_back(std::move(corners));
    }
    // by halves, so that each corner is visited only a few times
    for (std::size_t before = 0; before != level.size();) {
        before = level.size();
        std::vector<Corners> next;
        for (std::size_t k = 0; k < before; ++k) {
            next.push_back(std::move(level[k]));
            if (k + 1 < before && unite_into(next.back(), level[k + 1], least_area)) ++k;
        }
        level = std::move(next);
    }
    Rings out;
    for (Corners& corners : level) {
        std::rotate(corners.begin(), std::max_element(corners.begin(), corners.end(), is_left_of), corners.end());
        straighten(corners);
        Ring& ring = out.emplace_back(Eigen::Index(corners.size()), 2);
        for (Eigen::Index i = 0; i < ring.rows(); ++i) {
            const Corner& corner = corners[std::size_t(i)];
            ring.row(i) << double(corner.x) / units_per_mm, double(corner.y) / units_per_mm;
        }
    }
    return out;
}

}  // namespace brushsvg
