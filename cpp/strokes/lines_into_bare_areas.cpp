#include "strokes/lines_into_bare_areas.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

// Half widths, as shares of the brush's half width: as narrow as at square ends, and wider next to deeper areas.
constexpr std::array<double, 4> kHalfWidthShares{0.27, 0.45, 0.7, 1.0};
constexpr double kDepthShare = 0.7;  // another half width, as a share of the area's depth from its edge
// Half widths by which a line is longer than the area at either end, on paint.
constexpr double kLandingHalfWidths = 2.5;
constexpr double kMinRoomHalfWidths = 0.9;     // least room on either side of a line, in its half widths
constexpr double kPlaceSpacingMm = 0.2;        // spacing of the places on a line
constexpr std::size_t kMaxCheckedPlaces = 60;  // most places of an area that are checked
constexpr double kCornerReachHalfWidths =
    0.4;  // half widths of the brush: an area this near to a corner is in the corner
constexpr double kTipHalfWidthShare =
    0.03;  // half width of a line where it begins in a corner, as a share of the brush's
// Change of half width per length where a limb ends round or square: a line stops there.
constexpr double kBluntEndTaper = -0.85;

std::vector<Vector2d> sample_places(const std::vector<Vector2d>& places) {
    std::vector<Vector2d> out;
    const std::size_t step = 1 + places.size() / kMaxCheckedPlaces;
    for (std::size_t k = 0; k < places.size(); k += step) out.push_back(places[k]);
    return out;
}

WideLine make_line(const std::vector<Vector2d>& places, const std::vector<double>& halves) {
    WideLine line(Index(places.size()), 3);
    for (Index i = 0; i < line.rows(); ++i) line.row(i) << places[std::size_t(i)].transpose(), halves[std::size_t(i)];
    return line;
}

void add_both_directions(const WideLine& line, Candidates& out) {
    out.push_back(line);
    out.push_back(line.colwise().reverse());
}

}  // namespace

ShapeOutline::ShapeOutline(const Rings& rings, const Canvas& canvas) : canvas_(canvas), edges_(find_edge_runs(rings)) {
    for (const Ring& ring : rings) {
        if (ring.rows() == 0) continue;
        Ring closed(ring.rows() + 1, 2);
        closed << ring, ring.row(0);
        closed_.push_back(std::move(closed));
    }
    nearest_ = std::vector<NearestOnPolyline<Ring>>(closed_.begin(), closed_.end());
}

double ShapeOutline::edge_mm(const Vector2d& at_mm) {
    double least = std::numeric_limits<double>::infinity();
    for (auto& ring : nearest_) least = std::min(least, ring.distance(at_mm, least));
    return least;
}

bool ShapeOutline::is_clear(const Vector2d& from_mm, const Vector2d& to_mm) const {
    const int count = 1 + int((to_mm - from_mm).norm() / kPlaceSpacingMm);
    for (int i = 0; i <= count; ++i)
        if (!canvas_.is_inside(from_mm + double(i) / count * (to_mm - from_mm))) return false;
    return true;
}

double ShapeOutline::room_mm(const Vector2d& at_mm) { return canvas_.is_inside(at_mm) ? edge_mm(at_mm) : 0.0; }

Stroke within_room(Stroke stroke, ShapeOutline& outline, double tolerance_mm) {
    const MiddlePolyline line = flatten(stroke, tolerance_mm);
    const double length = line(line.rows() - 1, 2);
    if (!(length > 0.0)) return stroke;
    std::vector<Vector2d> places;
    std::vector<double> halves;
    for (Index i = 0; i + 1 < line.rows(); ++i) {
        const Eigen::Vector3d from = line.block<1, 3>(i, 0), way = line.block<1, 3>(i + 1, 0).transpose() - from;
        const int count = 1 + int(way.z() / kPlaceSpacingMm);
        for (int k = i == 0 ? 0 : 1; k <= count; ++k) {
            checkpoint(1);
            const Eigen::Vector3d at = from + double(k) / count * way;
            places.push_back(at.head<2>());
            halves.push_back(std::min(half_width_at(stroke, at.z() / length), outline.room_mm(places.back())));
        }
    }
    stroke.half_width = fit_cubics(make_line(places, halves), tolerance_mm, stroke.closed).half_width;
    return stroke;
}

Candidates lines_straight_out(const BareArea& area, const std::vector<MiddlePolyline>& middles, ShapeOutline& outline,
                              const std::array<double, 2>& half_mm) {
    const auto nearest_on_middles = [&](const Vector2d& place) {
        Vector2d best(0.0, 0.0);
        double least = std::numeric_limits<double>::infinity();
        for (const MiddlePolyline& line : middles)
            for (Index i = 0; i < line.rows(); ++i) {
                const Vector2d a = line.block<1, 2>(i, 0).transpose();
                const Vector2d way = line.block<1, 2>(std::min(i + 1, line.rows() - 1), 0).transpose() - a;
                const double squared = way.squaredNorm();
                const double t = squared > 0.0 ? std::clamp((place - a).dot(way) / squared, 0.0, 1.0) : 0.0;
                const Vector2d on = a + t * way;
                if ((on - place).squaredNorm() >= least || !outline.is_clear(on, place)) continue;
                least = (on - place).squaredNorm();
                best = on;
            }
        return std::pair(best, std::sqrt(least));
    };
    Vector2d farthest = area.deepest;
    double most = -1.0;
    for (const Vector2d& place : sample_places(area.places))
        if (const double away = nearest_on_middles(place).second; away > most && std::isfinite(away)) {
            most = away;
            farthest = place;
        }
    Candidates out;
    for (const Vector2d& place : {area.deepest, farthest}) {
        const auto [root, away] = nearest_on_middles(place);
        // no middle line can be seen from there, or a stroke runs there and its mark leaves the place bare
        if (!std::isfinite(away) || away < kPlaceSpacingMm) continue;
        const Vector2d onward = (place - root) / away;
        const double there = (area.deepest - root).norm();
        double reach = 0.0;
        for (const Vector2d& each : area.places) reach = std::max(reach, (each - root).dot(onward));
        std::vector<Vector2d> places;
        std::vector<double> halves;
        for (double at = 0.0; at < away + 4.0 * half_mm[1]; at += kPlaceSpacingMm / 2.0) {
            const Vector2d here = root + at * onward;
            const double half = outline.room_mm(here);
            const bool is_out = at > there;
            if (half <= half_mm[0] || (is_out && at + half > reach)) break;
            if (is_out && halves.size() > 1 && half - halves[halves.size() - 2] < kBluntEndTaper * kPlaceSpacingMm)
                break;
            places.push_back(here);
            halves.push_back(half);
        }
        for (double& half : halves) half = std::min(half, half_mm[1]);
        if (places.size() > 2) out.push_back(make_line(places, halves));
    }
    return out;
}

Candidates lines_along_middles(const BareArea& area, const std::vector<MiddlePolyline>& former,
                               const std::array<double, 2>& half_mm) {
    const std::vector<Vector2d> places = sample_places(area.places);
    Candidates out;
    for (const MiddlePolyline& line : former) {
        Index first = line.rows(), last = -1;
        for (const Vector2d& place : places) {
            Index nearest = 0;
            const double off = (line.leftCols<2>().rowwise() - place.transpose()).rowwise().norm().minCoeff(&nearest);
            if (off > line(nearest, 3)) continue;
            first = std::min(first, nearest);
            last = std::max(last, nearest);
        }
        if (first >= last) continue;
        // Its ends are under paint, and no wider than where they leave the area.
        const double half_at_first = line(first, 3), half_at_last = line(last, 3);
        const auto landing_mm = [&](double half) {
            return kLandingHalfWidths * std::max(half, kHalfWidthShares[0] * half_mm[1]);
        };
        Index from = first, to = last;
        while (from > 0 && line(first, 2) - line(from - 1, 2) <= landing_mm(half_at_first)) --from;
        while (to + 1 < line.rows() && line(to + 1, 2) - line(last, 2) <= landing_mm(half_at_last)) ++to;
        WideLine wide(to - from + 1, 3);
        for (Index i = from; i <= to; ++i) {
            const double half = std::min(line(i, 3), i < first ? half_at_first : i > last ? half_at_last : line(i, 3));
            wide.row(i - from) << line.block<1, 2>(i, 0), std::clamp(half, half_mm[0], half_mm[1]);
        }
        if (wide.rows() > 3) add_both_directions(wide, out);
    }
    return out;
}

Candidates lines_along_edges(const BareArea& area, ShapeOutline& outline, const std::array<double, 2>& half_mm) {
    struct Side {
        double first = std::numeric_limits<double>::infinity(), last = -first, deep = 0.0;
        double before = first, behind = -first;  // for a ring: in its second half, in its first half
        std::size_t count = 0;
    };
    const std::vector<EdgeRun>& runs = outline.edges().runs;
    std::vector<Side> sides(runs.size());
    const std::vector<Vector2d> places = sample_places(area.places);
    for (const Vector2d& place : places) {
        double least = std::numeric_limits<double>::infinity(), at = 0.0;
        std::size_t which = 0;
        for (std::size_t k = 0; k < runs.size(); ++k)
            if (const auto [off, where] = runs[k].nearest(place); off < least) {
                least = off;
                at = where;
                which = k;
            }
        if (runs.empty()) break;
        Side& side = sides[which];
        side.first = std::min(side.first, at);
        side.last = std::max(side.last, at);
        const double half = runs[which].length_mm() / 2.0;
        if (at > half)
            side.before = std::min(side.before, at);
        else
            side.behind = std::max(side.behind, at);
        side.deep = std::max(side.deep, least);
        ++side.count;
    }
    Candidates out;
    for (std::size_t k = 0; k < runs.size(); ++k) {
        const EdgeRun& run = runs[k];
        Side side = sides[k];
        if (side.count == 0) continue;
        // the area crosses the place where the ring begins
        if (run.is_ring && side.last - side.first > run.length_mm() / 2.0) {
            side.first = side.before;
            side.last = side.behind + run.length_mm();
        }
        std::vector<double> widths{kDepthShare * side.deep};
        for (const double share : kHalfWidthShares) widths.push_back(share * half_mm[1]);
        for (const double width : widths) {
            if (width < half_mm[0] || width > half_mm[1] || side.deep >= 2.0 * width) continue;
            double first = side.first - kLandingHalfWidths * width, last = side.last + kLandingHalfWidths * width;
            if (!run.is_ring) {
                // a line ends before an outer corner, so that its mark stays in the shape, and runs on past an inner
                // corner
                const auto end_distance = [&](double turn) {
                    return turn < 0.0 ? -kLandingHalfWidths * width : width * std::tan(turn / 2.0);
                };
                first = std::max(first, end_distance(run.turns_rad[0]));
                last = std::min(last, run.length_mm() - end_distance(run.turns_rad[1]));
            }
            if (last - first < width) continue;
            const int count = std::max(int((last - first) / kPlaceSpacingMm), 4);
            std::vector<Vector2d> middle;
            bool is_clear = true;
            for (int i = 0; i < count && is_clear; ++i) {
                const double at = first + (last - first) * i / (count - 1);
                const auto [place, along] = run.at(at);
                const Vector2d here = place + width * Vector2d(-along.y(), along.x());
                if (outline.edge_mm(here) > kMinRoomHalfWidths * width)
                    middle.push_back(here);
                else if (at < side.first)
                    middle.clear();
                else if (at > side.last)
                    break;
                else
                    is_clear = false;
            }
            if (is_clear && middle.size() > 3)
                add_both_directions(make_line(middle, std::vector<double>(middle.size(), width)), out);
        }
    }
    return out;
}

Candidates lines_from_corners(const BareArea& area, ShapeOutline& outline, const std::array<double, 2>& half_mm) {
    Candidates out;
    for (const OuterCorner& corner : outline.edges().corners) {
        double least = std::numeric_limits<double>::infinity();
        for (const Vector2d& place : area.places) least = std::min(least, (place - corner.at_mm).squaredNorm());
        if (std::sqrt(least) > kCornerReachHalfWidths * half_mm[1]) continue;
        for (const double share : {kHalfWidthShares[0], kHalfWidthShares[1]}) {
            const double width = share * half_mm[1], thin = std::max(kTipHalfWidthShare * half_mm[1], half_mm[0]);
            if (width < thin) continue;
            std::vector<Vector2d> places;
            std::vector<double> halves;
            double wide_mm = -1.0;  // where the line reaches that width; negative: not yet
            for (double at = kPlaceSpacingMm; at < 4.0 * half_mm[1]; at += kPlaceSpacingMm) {
                const Vector2d here = corner.at_mm + at * corner.inwards;
                const double room = outline.room_mm(here);
                if (room < thin) {
                    if (places.empty()) continue;
                    break;
                }
                if (wide_mm < 0.0 && room >= width) wide_mm = at;
                if (wide_mm >= 0.0 && at > wide_mm + kLandingHalfWidths * width) break;
                places.push_back(here);
                halves.push_back(std::min(room, width));
            }
            if (wide_mm >= 0.0 && places.size() > 3) out.push_back(make_line(places, halves));
        }
    }
    return out;
}

Candidates lines_across(const BareArea& area, ShapeOutline& outline, const std::array<double, 2>& half_mm) {
    Eigen::Matrix2Xd places(2, Index(area.places.size()));
    for (Index i = 0; i < places.cols(); ++i) places.col(i) = area.places[std::size_t(i)];
    const Vector2d centre = (places.rowwise().minCoeff() + places.rowwise().maxCoeff()) / 2.0;
    const Eigen::Matrix2Xd off = places.colwise() - places.rowwise().mean();
    Eigen::Matrix2d axes = Eigen::Matrix2d::Identity();
    if (places.cols() > 1)
        axes = Eigen::JacobiSVD<Eigen::Matrix2d>(off * off.transpose(), Eigen::ComputeFullU).matrixU();
    Candidates out;
    for (const Index k : {0, 1}) {
        const Vector2d along = axes.col(k), aside = axes.col(1 - k);
        const Eigen::RowVectorXd on = along.transpose() * off, over = aside.transpose() * off;
        const double width = std::clamp(0.65 * (over.maxCoeff() - over.minCoeff()),
                                        std::max(kHalfWidthShares[0] * half_mm[1], half_mm[0]), half_mm[1]);
        const double reach = (on.maxCoeff() - on.minCoeff()) / 2.0 + kLandingHalfWidths * width;
        const int count = std::max(int(2.0 * reach / kPlaceSpacingMm), 4);
        std::vector<Vector2d> middle;
        for (int i = 0; i < count; ++i) {
            middle.push_back(centre + (2.0 * i / (count - 1) - 1.0) * reach * along);
            if (outline.room_mm(middle.back()) <= width) break;
        }
        if (int(middle.size()) == count && outline.room_mm(middle.back()) > width)
            add_both_directions(make_line(middle, std::vector<double>(middle.size(), width)), out);
    }
    return out;
}

}  // namespace brushsvg
