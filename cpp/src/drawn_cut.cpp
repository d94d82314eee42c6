#include "drawn_cut.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Width of the mark that runs along the cut, as shares of the stroke's: the finest of them that can be led. Its own
/// corners are as round as it is wide; finer ones leave a hole amid the end.
constexpr double kNarrowest = 0.27, kWidest = 0.6, kShareStep = 0.03;
/// Lever of a mark that is led into a corner: a widest section that hardly leads P swings about.
constexpr double kLeastLeverMm = 0.15;
/// In half widths before the cut: where the mark leaves the path at its full width, how much sooner where the cut is
/// slanted, and where it is narrow and beside the edge. Later the front sticks out of a slanted cut, sooner it leaves a
/// hole or a step.
constexpr double kLeaves = 1.15, kSlantedLeaves = 0.25, kBesideEdge = 0.5;
/// And how far before its corner it has to be there.
constexpr double kBeforeCorner = 0.2;
/// The slope from which on a cut is slanted in full, and the steepest that is a cut: beyond it is a side.
constexpr double kSlanted = 0.6, kSteepest = 1.3;
/// How far from its chord a cut may stray, and within what it is looked for, both in half widths.
constexpr double kStraight = 0.12, kNearest = 0.2, kFarthest = 2.5;
/// In half widths: within what a cap is looked at, how far it may stray from its circle, and how far the circle may be
/// from one about the path's end, as wide as the stroke.
constexpr double kAsideCap = 0.92, kRound = 0.06, kAsWide = 0.2;
/// A corner beyond 90 degrees is taken in two, so many levers apart, or the mark would swing out of it.
constexpr double kChamfer = 0.3;

/// How slanted a cut is, from 0 to 1.
double slant(const Cut& cut) { return std::min(1.0, std::abs(cut.slope) / kSlanted); }

/// How far ahead of the end the outline is first left, beside it by so much.
std::optional<double> left_ahead(const Rings& rings, const PathEnd& end, double aside_mm) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Ring& ring : rings)
        for (Index i = 0, n = ring.rows(); i < n; ++i) {
            const Vector2d a = ring.row(i).transpose() - end.at_mm, b = ring.row((i + 1) % n).transpose() - end.at_mm;
            const double ya = a.dot(end.left) - aside_mm, yb = b.dot(end.left) - aside_mm;
            if ((ya > 0.0) == (yb > 0.0)) continue;
            const double x = a.dot(end.along) + (b - a).dot(end.along) * ya / (ya - yb);
            if (x > 0.0) nearest = std::min(nearest, x);
        }
    if (!std::isfinite(nearest)) return {};
    return nearest;
}

/// The circle through a drawn end, by least squares; none where it strays from one as wide as the stroke.
std::optional<Cap> circle_of(const Rings& rings, const PathEnd& end) {
    constexpr int n = 9;
    Eigen::Matrix<double, n, 2> at;  // ahead and aside
    for (int k = 0; k < n; ++k) {
        const double aside = kAsideCap * (2.0 * k / (n - 1) - 1.0) * end.half_mm;
        const auto ahead = left_ahead(rings, end, aside);
        if (!ahead || *ahead > kFarthest * end.half_mm) return {};
        at.row(k) << *ahead, aside;
    }
    Eigen::Matrix<double, n, 3> rows;
    rows << 2.0 * at, Eigen::Matrix<double, n, 1>::Ones();
    const Eigen::Vector3d found = rows.colPivHouseholderQr().solve(at.rowwise().squaredNorm());
    const Vector2d middle = found.head<2>();
    const double radius = std::sqrt(std::max(0.0, found[2] + middle.squaredNorm()));
    const auto strays = ((at.rowwise() - middle.transpose()).rowwise().norm().array() - radius).abs();
    if (strays.maxCoeff() > kRound * end.half_mm || std::abs(radius - end.half_mm) > kAsWide * end.half_mm ||
        middle.norm() > kAsWide * end.half_mm)
        return {};
    return Cap{end.place(middle.x(), middle.y()), radius};
}

/// Both parts of a cubic (de Casteljau).
struct Halves {
    Eigen::Matrix<double, 1, 8> before, after;
};
Halves split(const Cubics& middle_mm, Index cubic, double t) {
    Vector2d p[4];
    for (int i = 0; i < 4; ++i) p[i] = middle_mm.row(cubic).segment<2>(2 * i);
    Halves out;
    for (int i = 0; i < 4; ++i) {
        out.before.segment<2>(2 * i) = p[0];
        out.after.segment<2>(6 - 2 * i) = p[3 - i];
        for (int k = 0; k + 1 < 4 - i; ++k) p[k] += t * (p[k + 1] - p[k]);
    }
    return out;
}

Cubics straight(const Vector2d& from_mm, const Vector2d& to_mm) {
    Cubics out(1, 8);
    for (int i = 0; i < 4; ++i) out.row(0).segment<2>(2 * i) = from_mm + i / 3.0 * (to_mm - from_mm);
    return out;
}

}  // namespace

Stroke as_wide_as_painted(const Stroke& stroke, const Brush& brush) {
    Stroke out = stroke;
    const auto [least, greatest] = brush.half_width_range_mm();
    for (WidthKnot& knot : out.half_width) knot.half_width_mm = std::clamp(knot.half_width_mm, least, greatest);
    return out;
}

std::optional<Cap> cap_of(const Stroke& stroke, const PathEnd& end) {
    return stroke.wanted_mm.empty() ? Cap{end.at_mm, end.half_mm} : circle_of(stroke.wanted_mm, end);
}

std::optional<Cut> cut_of(const Stroke& stroke, const PathEnd& end, double aside_mm, Caps caps) {
    if (stroke.wanted_mm.empty()) return caps == Caps::straight ? std::optional(Cut{end.half_mm, 0.0}) : std::nullopt;
    const auto right = left_ahead(stroke.wanted_mm, end, -aside_mm), left = left_ahead(stroke.wanted_mm, end, aside_mm);
    if (!right || !left) return {};
    const Cut cut{0.5 * (*right + *left), 0.5 * (*right - *left) / aside_mm};
    if (std::abs(cut.slope) > kSteepest) return {};
    for (const double share : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        const auto ahead = left_ahead(stroke.wanted_mm, end, share * aside_mm);
        if (!ahead || *ahead < kNearest * end.half_mm || *ahead > kFarthest * end.half_mm ||
            std::abs(*ahead - (cut.ahead_mm - cut.slope * share * aside_mm)) > kStraight * end.half_mm)
            return {};
    }
    return cut;
}

std::optional<double> half_along_cut_mm(const Brush& brush, double half_mm) {
    for (double share = kNarrowest; share < kWidest + 0.5 * kShareStep; share += kShareStep) {
        if (share * half_mm < brush.half_width_range_mm()[0]) continue;
        const double depth = brush.depth_for_half_width(share * half_mm, "");
        if (brush.lever_to_widest(depth) > kLeastLeverMm) return share * half_mm;
    }
    return {};
}

double leaves_ahead_mm(const Cut& cut, const PathEnd& end) {
    return cut.ahead_mm - (kLeaves + kSlantedLeaves * slant(cut)) * end.half_mm;
}

Cubics way_along(const Cut& cut, const PathEnd& end, const Vector2d& from_mm, double narrow_mm, double lever_mm) {
    const double aside = end.half_mm - narrow_mm;
    const double steep = std::hypot(1.0, cut.slope);
    const double first = cut.slope > 0.0 ? -aside : aside;
    const auto ahead = [&](double y) { return cut.ahead_mm - cut.slope * y - narrow_mm * steep; };
    const Vector2d a = end.place(ahead(first), first), b = end.place(ahead(-first), -first);
    const double beside =
        std::min(cut.ahead_mm - kBesideEdge * end.half_mm, ahead(first) - kBeforeCorner * end.half_mm);
    Cubics way = straight(from_mm, end.place(beside, first));
    const double chamfer = std::min(kChamfer * slant(cut) * lever_mm, 0.3 * (b - a).norm());
    if (chamfer > 0.0) append(way, a - chamfer * end.along);
    append(way, a + chamfer * (b - a).normalized());
    append(way, b);
    return way;
}

Cubics part_of(const Cubics& middle_mm, const Place& from, const Place& to) {
    // up to where a cubic begins is up to where the one before it ends
    if (to.t == 0.0 && from.cubic < to.cubic) return part_of(middle_mm, from, {to.cubic - 1, 1.0});
    Cubics out = middle_mm.middleRows(from.cubic, to.cubic - from.cubic + 1);
    const Index last = out.rows() - 1;
    out.row(last) = split(out, last, to.t).before;
    const double t = from.cubic < to.cubic ? from.t : to.t > 0.0 ? from.t / to.t : 0.0;
    out.row(0) = split(out, 0, t).after;
    return out;
}

Cubics reversed(const Cubics& middle_mm) {
    Cubics out(middle_mm.rows(), 8);
    for (Index i = 0, n = middle_mm.rows(); i < n; ++i)
        for (int k = 0; k < 4; ++k) out.row(i).segment<2>(6 - 2 * k) = middle_mm.row(n - 1 - i).segment<2>(2 * k);
    return out;
}

void append(Cubics& middle_mm, const Vector2d& to_mm) {
    append_way(middle_mm, straight(middle_mm.row(middle_mm.rows() - 1).tail<2>(), to_mm));
}

void append_way(Cubics& middle_mm, const Cubics& more_mm) {
    const Index before = middle_mm.rows();
    middle_mm.conservativeResize(before + more_mm.rows(), Eigen::NoChange);
    middle_mm.bottomRows(more_mm.rows()) = more_mm;
}

}  // namespace brushsvg
