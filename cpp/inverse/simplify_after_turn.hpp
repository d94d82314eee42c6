#pragma once

#include <cmath>
#include <vector>

#include "brushsvg/simplify_pass.hpp"
#include "brushsvg/simulate.hpp"

namespace brushsvg {

constexpr double kCoarseMm = 1.0;

/// Simplify the part of a pass after the brush turns over for the last time. P rests while the brush turns over, and
/// fewer poses would put the brush down next to P.
inline Pass simplify_after_turn(const Pass& pass, const Brush& brush, double tolerance_mm) {
    using Eigen::Index;
    // where the brush is loose, the simulation has rows at any step width
    const PassMarks marks = simulate(pass, brush, kCoarseMm, false);
    const std::vector<TurnOver> turns = find_turn_overs(marks);
    if (turns.empty()) return simplify_pass(pass, brush, tolerance_mm);
    // the last pose where the brush is pressed least
    Index first_kept = Index(std::ceil(marks.pose[turns.back().first]));
    for (Index i = first_kept; double(i) < marks.pose[turns.back().last]; ++i)
        if (pass.poses_mm(i, 2) >= pass.poses_mm(first_kept, 2)) first_kept = i;
    Pass after_turn = pass;
    after_turn.poses_mm = pass.poses_mm.bottomRows(pass.poses_mm.rows() - first_kept);
    std::vector<Arc> earlier_arcs;
    after_turn.arcs.clear();
    for (Arc arc : pass.arcs) {
        if (arc.last <= first_kept) {
            earlier_arcs.push_back(arc);
            continue;
        }
        arc.first -= first_kept;
        arc.last -= first_kept;
        after_turn.arcs.push_back(arc);
    }
    after_turn = simplify_pass(after_turn, brush, tolerance_mm);
    Pass out = after_turn;
    out.poses_mm.resize(first_kept + after_turn.poses_mm.rows(), 3);
    out.poses_mm << pass.poses_mm.topRows(first_kept), after_turn.poses_mm;
    for (Arc& arc : out.arcs) {
        arc.first += first_kept;
        arc.last += first_kept;
    }
    out.arcs.insert(out.arcs.begin(), earlier_arcs.begin(), earlier_arcs.end());
    return out;
}

}  // namespace brushsvg
