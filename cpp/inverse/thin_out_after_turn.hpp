#pragma once

#include <cmath>
#include <vector>

#include "brushsvg/simulate.hpp"
#include "brushsvg/thin_out.hpp"

namespace brushsvg {

constexpr double kCoarseMm = 1.0;

/// Simplify the part of a pass after the brush turns over for the last time. P rests while the brush turns over, and
/// fewer poses would put the brush down next to P.
inline Pass thin_out_after_turn(const Pass& pass, const Brush& brush, double tolerance_mm) {
    using Eigen::Index;
    // where the brush is loose, the simulation has rows at any step width
    const PassMarks marks = simulate(pass, brush, kCoarseMm, false);
    const std::vector<TurnOver> turns = turns_over(marks);
    if (turns.empty()) return thin_out(pass, brush, tolerance_mm);
    // the last pose where the brush is pressed least
    Index kept = Index(std::ceil(marks.pose[turns.back().first]));
    for (Index i = kept; double(i) < marks.pose[turns.back().last]; ++i)
        if (pass.poses_mm(i, 2) >= pass.poses_mm(kept, 2)) kept = i;
    Pass rest = pass;
    rest.poses_mm = pass.poses_mm.bottomRows(pass.poses_mm.rows() - kept);
    std::vector<Arc> before;
    rest.arcs.clear();
    for (Arc arc : pass.arcs) {
        if (arc.last <= kept) {
            before.push_back(arc);
            continue;
        }
        arc.first -= kept;
        arc.last -= kept;
        rest.arcs.push_back(arc);
    }
    rest = thin_out(rest, brush, tolerance_mm);
    Pass out = rest;
    out.poses_mm.resize(kept + rest.poses_mm.rows(), 3);
    out.poses_mm << pass.poses_mm.topRows(kept), rest.poses_mm;
    for (Arc& arc : out.arcs) {
        arc.first += kept;
        arc.last += kept;
    }
    out.arcs.insert(out.arcs.begin(), before.begin(), before.end());
    return out;
}

}  // namespace brushsvg
