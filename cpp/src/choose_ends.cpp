#include "choose_ends.hpp"

#include <algorithm>
#include <optional>

#include "brushsvg/coverage.hpp"
#include "brushsvg/excess_turning.hpp"
#include "brushsvg/mark_overlap.hpp"
#include "brushsvg/simulate.hpp"
#include "closed_form.hpp"
#include "dot.hpp"
#include "half_painted.hpp"
#include "hidden_beginning.hpp"
#include "stroke_ends.hpp"
#include "turned_beginning.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Half a side of the square about an end that is looked at, and how far the mark is made for it, in half widths;
/// pixels on one half width. A pointed footprint reaches back by two half widths from its widest section.
constexpr double kLookedAt = 3.0, kMade = 6.0, kPixels = 8.0;
/// What another end than the plain one must win, in squares of the half width: of the 1.5 that a pointed beginning
/// lacks, what one has to look for. Two blunt corners lack 0.43. Of a round cap less shows: the shoulders of a blunt
/// front beside it.
constexpr double kWorthIt = 0.2, kWorthRound = 0.05;
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

double way_of(const Pass& pass) {
    const Index n = pass.poses_mm.rows();
    return (pass.poses_mm.bottomRows(n - 1) - pass.poses_mm.topRows(n - 1)).rowwise().norm().sum();
}

/// The surroundings of an end, what is wanted there, and how marks compare with it.
class View {
 public:
    View(const Stroke& wanted, const Vector2d& at_mm, double half_mm, double greatest_mm, const Brush& brush)
        : brush_(brush),
          half_mm_(half_mm),
          greatest_mm_(greatest_mm),
          px_per_mm_(kPixels / half_mm),
          window_{at_mm.x() - kLookedAt * half_mm, at_mm.y() - kLookedAt * half_mm, 2.0 * kLookedAt * half_mm,
                  2.0 * kLookedAt * half_mm},
          wanted_(wanted_coverage({wanted}, window_, px_per_mm_)) {}

    /// Whether the mark of another pass wins what is worth it.
    bool is_better(const Pass& other, const Pass& plain, bool is_round = false) const {
        const Coverage now = picture(other), before = picture(plain);
        const double won = differs(before) - differs(now) - (is_round ? kWorthRound : kWorthIt);
        if (!(won > 0.0)) return false;
        const double turned =
            excess_turning(half_painted(now, window_, px_per_mm_), half_painted(before, window_, px_per_mm_));
        return won * half_mm_ * half_mm_ > kCalm * turned * greatest_mm_ * greatest_mm_;
    }

 private:
    Coverage picture(const Pass& pass) const {
        Marks marks;
        marks.passes = {simulate(pass, brush_, 0.05 * half_mm_)};
        return coverage(marks, brush_, window_, px_per_mm_);
    }
    /// From what is wanted, in squares of the half width.
    double differs(const Coverage& seen) const { return (seen - wanted_).cwiseAbs().sum() / (kPixels * kPixels); }

    const Brush& brush_;
    double half_mm_, greatest_mm_, px_per_mm_;
    Window window_;
    Coverage wanted_;
};

double greatest_half_mm(const Stroke& stroke, double half_mm) {
    for (const WidthKnot& knot : stroke.half_width) half_mm = std::max(half_mm, knot.half_width_mm);
    return half_mm;
}

}  // namespace

Beginning best_beginning(const Stroke& wanted, const Stroke& stroke, const Brush& brush, const Line& line,
                         double step_tolerance) {
    const double last_mm = painted_stretch(stroke, brush, line.length())[1];
    const std::optional<Dot> dot = dot_of(wanted, brush);
    const bool hides = dot || hidden_beginning(stroke, brush, line, InverseLag(line, brush), last_mm, step_tolerance);
    if (!hides && !turned_beginning(stroke, brush, line)) return Beginning::exposed;
    bool turns = false;
    Pass exposed, hidden;
    closed_form(stroke, brush, line, Beginning::exposed, step_tolerance, turns).into(exposed);
    (dot ? poses_of(*dot, brush) : closed_form(stroke, brush, line, Beginning::hidden, step_tolerance, turns))
        .into(hidden);
    const double depth = depth_of(stroke, brush, 0.0), half = brush.half_width(depth),
                 made = kMade * half + 4.0 * brush.lag(depth);
    const View view(wanted, line.at(0.0).middle, half, greatest_half_mm(stroke, half), brush);
    const bool is_better = dot ? view.is_better(hidden, exposed)
                               : view.is_better(beginning_of(hidden, made + way_of(hidden) - way_of(exposed)),
                                                beginning_of(exposed, made));
    return is_better ? Beginning::hidden : Beginning::exposed;
}

bool is_better_squared(const Stroke& wanted, const SquaredDot& dot, const Brush& brush, double step_tolerance) {
    bool turns = false;
    Pass round, squared;
    poses_of(dot.dot, brush).into(round);
    closed_form(dot, brush, step_tolerance, turns).into(squared);
    const double half = std::min(half_width_at(wanted, 0.0), brush.half_width_range_mm()[1]);
    const View view(wanted, dot.dot.from_mm, half, half, brush);
    return view.is_better(squared, round);
}

bool begins_better(const Stroke& wanted, const SquaredBeginning& squared, const Stroke& whole, const Stroke& stroke,
                   const Brush& brush, Beginning start, double step_tolerance) {
    const Line line(stroke, brush);
    bool turns = false;
    Pass plain, other;
    closed_form(stroke, brush, line, start, step_tolerance, turns).into(plain);
    closed_form(whole, brush, Line(whole, brush), Beginning::exposed, step_tolerance, turns).into(other);
    const double depth = depth_of(stroke, brush, 0.0), half = brush.half_width(depth),
                 made = kMade * half + 4.0 * brush.lag(depth);
    const View view(wanted, line.at(0.0).middle, half, greatest_half_mm(stroke, half), brush);
    // both up to the same place: from there on they are the same
    return view.is_better(beginning_of(other, made + way_of(other) - way_of(plain)), beginning_of(plain, made),
                          squared.is_round);
}

Ending best_ending(const Stroke& wanted, const Stroke& lifted, const SquaredEnd& squared, const Brush& brush,
                   Beginning start, double step_tolerance) {
    const Line line(lifted, brush);
    const double half = brush.half_width(depth_of(lifted, brush, 1.0));
    bool turns = false;
    Pass plain, other;
    closed_form(lifted, brush, line, start, step_tolerance, turns).into(plain);
    closed_form(squared.stroke, brush, Line(squared.stroke, brush), start, step_tolerance, turns).into(other);
    const View view(wanted, line.at(line.length()).middle, half, greatest_half_mm(lifted, half), brush);
    return view.is_better(other, plain, squared.is_round) ? Ending::squared : Ending::lifted;
}

}  // namespace brushsvg
