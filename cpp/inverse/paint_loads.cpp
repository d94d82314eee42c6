#include "brushsvg/paint_loads.hpp"

#include <algorithm>
#include <cmath>

#include "base/format_text.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/lag_arc.hpp"
#include "brushsvg/simulate.hpp"
#include "inverse/landing.hpp"
#include "values/require_usable.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Least depth [mm] for a landing. A brush that hardly touches has no patch to land in.
constexpr double kMinLandingDepthMm = 0.05;

/// Number of possible cuts per load of paint on long straight moves, whose ends alone are too far apart. Fewer would
/// leave more paint unused, more only cost time.
constexpr double kPlacesPerLoad = 200.0;

constexpr double kMaxLoads = 1000.0;  // of one stroke: with more, the brush would mainly travel

/// Largest distance [mm] of the patch from the arc's centre while the brush turns in place.
constexpr double kMaxTurnInPlaceMm = 0.01;

/// The pass with more poses along its moves. own[i]: whether pose i belongs to the original pass.
struct RefinedMoves {
    Pass pass;
    std::vector<bool> is_original;
};

/// Return the arc on which the pass continues from a pose.
const Arc* find_arc(const Pass& pass, Index pose) {
    for (const Arc& arc : pass.arcs)
        if (arc.first <= pose && pose < arc.last) return &arc;
    return nullptr;
}

Eigen::RowVector3d pose_on_arc(const Arc& arc, const Pass& pass, Index pose, double share) {
    const Vector2d from = pass.poses_mm.row(pose).head<2>().transpose();
    const Vector2d to = pass.poses_mm.row(pose + 1).head<2>().transpose();
    const Vector2d spoke = from - arc.centre_mm;
    const Vector2d at = arc.centre_mm + rotated<double>(spoke, share * turn_between(arc, from, to));
    return {at.x(), at.y(), pass.poses_mm(pose, 2)};
}

RefinedMoves refine_moves(const Pass& pass, double between_mm) {
    const Index count = pass.poses_mm.rows();
    RefinedMoves out{pass, {}};
    out.pass.tool_axes.resize(0, 3);  // upright, as are all passes that are split
    std::vector<Eigen::RowVector3d> poses;
    std::vector<Index> at;
    for (Index i = 0; i < count; ++i) {
        at.push_back(Index(poses.size()));
        poses.push_back(pass.poses_mm.row(i));
        out.is_original.push_back(true);
        if (i + 1 == count) continue;
        const Eigen::RowVector3d way = pass.poses_mm.row(i + 1) - pass.poses_mm.row(i);
        const Arc* arc = find_arc(pass, i);
        const auto parts = Index(std::ceil(way.norm() / between_mm));
        for (Index k = 1; k < parts; ++k) {
            const double share = double(k) / double(parts);
            poses.push_back(arc ? pose_on_arc(*arc, pass, i, share) : pass.poses_mm.row(i) + way * share);
            out.is_original.push_back(false);
        }
    }
    out.pass.poses_mm.resize(Index(poses.size()), 3);
    for (std::size_t i = 0; i < poses.size(); ++i) out.pass.poses_mm.row(Index(i)) = poses[i];
    for (Arc& arc : out.pass.arcs) {
        arc.first = at[std::size_t(arc.first)];
        arc.last = at[std::size_t(arc.last)];
    }
    return out;
}

/// A place where the pass may be cut: the brush is taut and pressed there, and does not turn in place.
struct CutPlace {
    Index pose;
    double along_mm;  ///< length of the TCP's path up to the place
    Stance stance;
};

std::vector<double> path_lengths(const Poses& poses) {
    std::vector<double> along{0.0};
    for (Index i = 1; i < poses.rows(); ++i) along.push_back(along.back() + (poses.row(i) - poses.row(i - 1)).norm());
    return along;
}

bool turns_in_place(const Pass& pass, Index pose, const Vector2d& contact) {
    for (const Arc& arc : pass.arcs)
        if (arc.first <= pose && pose <= arc.last) return (contact - arc.centre_mm).norm() < kMaxTurnInPlaceMm;
    return false;
}

std::vector<CutPlace> find_cut_places(const Pass& pass, const Brush& brush, const std::vector<double>& along) {
    const PassMarks marks = simulate(pass, brush, 0.05, false);
    std::vector<CutPlace> out;
    for (std::size_t row = 0; row < marks.pose.size(); ++row) {
        const double pose = marks.pose[row];
        const Index i = Index(std::lround(pose));
        if (pose != double(i) || (!marks.taut[row] && !brush.is_rigid()) || marks.depth_mm[row] < kMinLandingDepthMm)
            continue;
        const Vector2d contact = marks.contact_mm.row(Index(row)).transpose();
        if (i == 0 || i + 1 >= pass.poses_mm.rows() || turns_in_place(pass, i, contact)) continue;
        // a later row of a pose replaces an earlier one
        if (!out.empty() && out.back().pose == i) out.pop_back();
        const double u = marks.heading_rad[row];
        out.push_back({i, along[i], {contact, {std::cos(u), std::sin(u)}, marks.depth_mm[row]}});
    }
    return out;
}

/// Return the poses of the pass from one place to another with their arcs, between a landing and a lift.
Pass make_part(const RefinedMoves& fine, const Brush& brush, const CutPlace* from, const CutPlace* to, int number) {
    const Pass& pass = fine.pass;
    PoseList list;
    if (from) land(from->stance, brush, list);
    const Index first = from ? from->pose : 0, last = to ? to->pose : pass.poses_mm.rows() - 1;
    std::vector<std::int64_t> at;
    for (Index i = first; i <= last; ++i) {
        if (fine.is_original[std::size_t(i)] || i == first || i == last)
            list.add(pass.poses_mm.row(i).head<2>().transpose(), -pass.poses_mm(i, 2));
        at.push_back(list.last());
    }
    if (to) lift(to->stance, brush, list);
    Pass out = pass;
    list.write_to(out);
    out.arcs.clear();
    for (const Arc& arc : pass.arcs) {
        const Index begins = std::max<Index>(arc.first, first), ends = std::min<Index>(arc.last, last);
        if (begins < ends) out.arcs.push_back({at[begins - first], at[ends - first], arc.centre_mm, arc.direction});
    }
    out.stroke.load = out.load = number;
    return out;
}

}  // namespace

std::vector<Pass> split_into_loads(const Pass& pass, const Brush& brush, const PaintLoadOptions& options) {
    const auto refuse = [&](const char* pattern, double first, double second) {
        throw Error("load-too-short", format_text(pattern, first, second), pass.stroke, options.every_mm);
    };
    if (!(options.first_mm >= 0.0 && options.backtrack_mm >= 0.0))
        refuse("the first length is %.4g mm and the backtrack %.4g mm, but both must be at least 0", options.first_mm,
               options.backtrack_mm);
    if (!(options.every_mm > 2.0 * options.backtrack_mm))
        refuse(
            "the paint lasts %.4g mm, but must last for more than twice the backtrack of %.4g mm: refill after a "
            "longer path, or reduce the backtrack",
            options.every_mm, options.backtrack_mm);
    require_usable(brush);
    refuse_tilted(pass, "only strokes of an upright brush can be split into loads of paint");
    if (!(path_lengths(pass.poses_mm).back() > options.first_mm) || !pass.poses_mm.allFinite()) return {pass};
    for (std::size_t k = 0; k < pass.arcs.size(); ++k) check_arc(pass, k, pass.stroke);
    const auto require_few_loads = [&](double loads) {
        if (!(loads <= kMaxLoads))
            refuse(
                "the stroke would need more than %.0f refills, because its paint lasts only %.4g mm: refill after a "
                "longer path, or split the stroke",
                kMaxLoads, options.every_mm);
    };
    require_few_loads(path_lengths(pass.poses_mm).back() / options.every_mm);
    const RefinedMoves fine = refine_moves(pass, options.every_mm / kPlacesPerLoad);
    const std::vector<double> along = path_lengths(fine.pass.poses_mm);
    const std::vector<CutPlace> all = find_cut_places(fine.pass, brush, along);
    std::vector<Pass> parts;
    const CutPlace* from = nullptr;
    double load_end_mm = options.first_mm;
    while (along.back() > load_end_mm) {
        checkpoint(int(all.size()));
        require_few_loads(double(parts.size()) + 1.0);
        // cut at the last place that the paint reaches, else at the first after it; each cut must be beyond the last
        // one
        const double least = from ? from->along_mm + options.backtrack_mm : 0.0;
        const CutPlace *cut = nullptr, *back = nullptr;
        for (const CutPlace& place : all) {
            if (place.along_mm <= least || (cut && place.along_mm > load_end_mm)) continue;
            cut = &place;
            if (place.along_mm > load_end_mm) break;
        }
        if (!cut) break;
        for (const CutPlace& place : all) {
            // a part must advance
            if (place.pose >= cut->pose || (from && place.pose <= from->pose)) continue;
            if (!back || place.along_mm <= cut->along_mm - options.backtrack_mm) back = &place;
        }
        if (!back) back = cut;
        parts.push_back(make_part(fine, brush, from, cut, int(parts.size()) + 1));
        from = back;
        const double landing = brush.lag(back->stance.depth_mm);
        load_end_mm = back->along_mm + options.every_mm - landing;
    }
    if (parts.empty()) return {pass};
    parts.push_back(make_part(fine, brush, from, nullptr, int(parts.size()) + 1));
    return parts;
}

}  // namespace brushsvg
