#include "squared_dot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "drawn_cut.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Of more edges a drawn dot is no polygon that is looked at.
constexpr Index kMostEdges = 2000;
/// Of its rectangle, what a dot with corners fills: a disc fills 0.785, an octagon 0.83.
constexpr double kFilled = 0.92;
/// Where on its first side the way begins, of half its length from the middle: into a corner it would turn by more than
/// 90 degrees, and swing out of it.
constexpr double kOnSide = 0.4;

/// A rectangle by its middle, the direction of one side, and half of both sides.
struct Box {
    Vector2d middle_mm, along;
    std::array<double, 2> half_mm;
};

/// The least rectangle that holds the rings: one of its sides lies on an edge of theirs.
std::optional<Box> least_box(const Rings& rings) {
    Index edges = 0;
    for (const Ring& ring : rings) edges += ring.rows();
    if (edges == 0 || edges > kMostEdges) return {};
    std::optional<Box> best;
    double least = std::numeric_limits<double>::infinity();
    for (const Ring& of : rings)
        for (Index i = 0, n = of.rows(); i < n; ++i) {
            const Vector2d edge = (of.row((i + 1) % n) - of.row(i)).transpose();
            if (!(edge.norm() > 1e-6)) continue;
            const Vector2d along = edge.normalized(), left(-along.y(), along.x());
            Vector2d lo = Vector2d::Constant(std::numeric_limits<double>::infinity()), hi = -lo;
            for (const Ring& ring : rings) {
                lo = lo.cwiseMin(Vector2d((ring * along).minCoeff(), (ring * left).minCoeff()));
                hi = hi.cwiseMax(Vector2d((ring * along).maxCoeff(), (ring * left).maxCoeff()));
            }
            const Vector2d size = hi - lo;
            if (!(size.prod() < least)) continue;
            least = size.prod();
            const Vector2d middle = 0.5 * (lo + hi);
            best = Box{middle.x() * along + middle.y() * left, along, {0.5 * size.x(), 0.5 * size.y()}};
        }
    return best;
}

}  // namespace

std::optional<SquaredDot> squared_dot(const Stroke& stroke, const Brush& brush) {
    if (stroke.wanted_mm.empty()) return {};
    const std::optional<Dot> dot = dot_of(stroke, brush);
    const std::optional<Box> box = dot ? least_box(stroke.wanted_mm) : std::nullopt;
    double area_mm2 = 0.0;
    for (const Ring& ring : stroke.wanted_mm) area_mm2 += signed_area(ring);
    if (!box || std::abs(area_mm2) < kFilled * 4.0 * box->half_mm[0] * box->half_mm[1]) return {};
    const auto narrow = half_along_cut_mm(brush, std::min(box->half_mm[0], box->half_mm[1]));
    if (!narrow) return {};
    const Vector2d left(-box->along.y(), box->along.x()), at = dot->to_mm;
    const auto place = [&](double a, double b) -> Vector2d {
        return box->middle_mm + a * (box->half_mm[0] - *narrow) * box->along + b * (box->half_mm[1] - *narrow) * left;
    };
    const std::vector<Vector2d> places{place(1.0, kOnSide), place(1.0, 1.0),  place(-1.0, 1.0),
                                       place(-1.0, -1.0),   place(1.0, -1.0), place(1.0, kOnSide)};
    const double lever = brush.lever_to_widest(brush.depth_for_half_width(*narrow, stroke.id));
    SquaredDot out{*dot, stroke, lever, (places[0] - at).normalized(), 0.0};
    if (!((places[0] - at).norm() > lever)) return {};
    out.way.middle_mm.resize(0, 8);
    Vector2d here = at;
    for (const Vector2d& to : places) {
        Cubics& way = out.way.middle_mm;
        way.conservativeResize(way.rows() + 1, Eigen::NoChange);
        for (int i = 0; i < 4; ++i) way.row(way.rows() - 1).segment<2>(2 * i) = here + i / 3.0 * (to - here);
        out.reach_mm = std::max(out.reach_mm, (to - dot->from_mm).norm() + lever);
        here = to;
    }
    out.way.half_width = {{0.0, *narrow}, {1.0, *narrow}};
    return out;
}

}  // namespace brushsvg
