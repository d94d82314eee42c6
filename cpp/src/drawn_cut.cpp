#include "drawn_cut.hpp"

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

}  // namespace

Stroke as_wide_as_painted(const Stroke& stroke, const Brush& brush) {
    Stroke out = stroke;
    const auto [least, greatest] = brush.half_width_range_mm();
    for (WidthKnot& knot : out.half_width) knot.half_width_mm = std::clamp(knot.half_width_mm, least, greatest);
    return out;
}

std::optional<Cut> cut_of(const Stroke& stroke, const PathEnd& end, double aside_mm) {
    if (stroke.wanted_mm.empty()) return Cut{end.half_mm, 0.0};
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

std::vector<Vector2d> way_along(const Cut& cut, const PathEnd& end, double narrow_mm, double lever_mm) {
    const double steep = std::hypot(1.0, cut.slope), aside = end.half_mm - narrow_mm;
    const double first = cut.slope > 0.0 ? -aside : aside;
    const auto ahead = [&](double y) { return cut.ahead_mm - cut.slope * y - narrow_mm * steep; };
    const Vector2d a = end.place(ahead(first), first), b = end.place(ahead(-first), -first);
    const double beside =
        std::min(cut.ahead_mm - kBesideEdge * end.half_mm, ahead(first) - kBeforeCorner * end.half_mm);
    std::vector<Vector2d> way{end.place(beside, first)};
    const double chamfer = std::min(kChamfer * slant(cut) * lever_mm, 0.3 * (b - a).norm());
    if (chamfer > 0.0) way.push_back(a - chamfer * end.along);
    way.push_back(a + chamfer * (b - a).normalized());
    way.push_back(b);
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

void append(Cubics& middle_mm, const Vector2d& to_mm) {
    const Index last = middle_mm.rows();
    const Vector2d from = middle_mm.row(last - 1).tail<2>();
    middle_mm.conservativeResize(last + 1, Eigen::NoChange);
    for (int i = 0; i < 4; ++i) middle_mm.row(last).segment<2>(2 * i) = from + i / 3.0 * (to_mm - from);
}

}  // namespace brushsvg
