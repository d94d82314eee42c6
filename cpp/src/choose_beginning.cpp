#include "choose_beginning.hpp"

#include <algorithm>
#include <optional>

#include "brushsvg/coverage.hpp"
#include "brushsvg/excess_turning.hpp"
#include "brushsvg/mark_overlap.hpp"
#include "brushsvg/simulate.hpp"
#include "closed_form.hpp"
#include "dot.hpp"
#include "hidden_beginning.hpp"
#include "stroke_ends.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Half a side of the square about the beginning that is looked at, and how far the mark is made for it, in half
/// widths; pixels on one half width. A pointed footprint reaches back by two half widths from its widest section.
constexpr double kLookedAt = 3.0, kMade = 6.0, kPixels = 8.0;
/// What hiding must win, in squares of the half width: of the 1.5 that a pointed beginning lacks, what one has to look
/// for.
constexpr double kWorthHiding = 0.2;
/// And what a full turn more of the mark's outline weighs against it, in squares of the greatest half width: knobs on
/// the thin ends of drops.
constexpr double kCalm = 0.3;

/// The pass up to where its path is so long, the brush left on the paper.
Pass beginning_of(const Pass& pass, double length_mm) {
    Pass out;
    out.stroke = pass.stroke;
    Index n = std::min<Index>(2, pass.poses_mm.rows());
    for (double way = 0.0; n < pass.poses_mm.rows() && way < length_mm; ++n)
        way += (pass.poses_mm.row(n) - pass.poses_mm.row(n - 1)).norm();
    out.poses_mm = pass.poses_mm.topRows(n);
    return out;
}

}  // namespace

Beginning best_beginning(const Stroke& wanted_stroke, const Stroke& stroke, const Brush& brush, const Line& line,
                         double step_tolerance) {
    const double last_mm = painted_stretch(stroke, brush, line.length())[1];
    const std::optional<Dot> dot = dot_of(wanted_stroke, brush);
    if (!dot && !hidden_beginning(stroke, brush, line, Inverse(line, brush), last_mm, step_tolerance))
        return Beginning::exposed;
    bool turns = false;
    Pass exposed, hidden;
    closed_form(stroke, brush, line, Beginning::exposed, step_tolerance, turns).into(exposed);
    (dot ? poses_of(*dot, brush) : closed_form(stroke, brush, line, Beginning::hidden, step_tolerance, turns))
        .into(hidden);
    const double depth = depth_of(stroke, brush, 0.0), half = brush.half_width(depth);
    const Vector2d at = line.at(0.0).middle;
    const double side = 2.0 * kLookedAt * half, made = kMade * half + 4.0 * brush.lag(depth);
    const Window window{at.x() - 0.5 * side, at.y() - 0.5 * side, side, side};
    const Coverage wanted = wanted_coverage({wanted_stroke}, window, kPixels / half);
    const auto mark = [&](const Pass& pass) {
        Marks marks;
        marks.passes = {simulate(dot ? pass : beginning_of(pass, made), brush, 0.05 * half)};
        return marks;
    };
    const auto differs = [&](const Marks& marks) {
        return (coverage(marks, brush, window, kPixels / half) - wanted).cwiseAbs().sum() / (kPixels * kPixels);
    };
    const Marks pointed = mark(exposed), round = mark(hidden);
    const double won = differs(pointed) - differs(round) - kWorthHiding;
    if (!(won > 0.0)) return Beginning::exposed;
    const double turned = excess_turning(outline(round.passes[0], brush), outline(pointed.passes[0], brush));
    double greatest = half;
    for (const auto& knot : stroke.half_width) greatest = std::max(greatest, knot.half_width_mm);
    return won * half * half > kCalm * turned * greatest * greatest ? Beginning::hidden : Beginning::exposed;
}

}  // namespace brushsvg
