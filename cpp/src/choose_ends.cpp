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
#include "round_cap.hpp"
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
/// lacks, what one has to look for. Two blunt corners lack 0.43. Of a round end less shows: the shoulders of a blunt
/// front beside it, which lack 0.044 of a line of 6 mm and make it a hexagon.
constexpr double kWorthIt = 0.2, kWorthRound = 0.02;
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

double greatest_half_mm(const Stroke& stroke, double half_mm) {
    for (const WidthKnot& knot : stroke.half_width) half_mm = std::max(half_mm, knot.half_width_mm);
    return half_mm;
}

}  // namespace

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

    Coverage picture(const Pass& pass) const {
        Marks marks;
        marks.passes.push_back(simulate_near(pass, brush_, window_, 0.05 * half_mm_));
        return coverage(marks, brush_, window_, px_per_mm_);
    }
    /// Whether the mark of another pass, made where it is asked for, wins what is worth it.
    template <class Other>
    bool is_better(Other&& other, const Coverage& before, double worth = kWorthIt) const {
        const double off = differs(before);
        if (!(off - worth > 0.0)) return false;  // the wanted mark itself would not win it
        const Coverage now = picture(other());
        const double won = off - differs(now) - worth;
        if (!(won > 0.0)) return false;
        const double turned =
            excess_turning(half_painted(now, window_, px_per_mm_), half_painted(before, window_, px_per_mm_));
        return won * half_mm_ * half_mm_ > kCalm * turned * greatest_mm_ * greatest_mm_;
    }

 private:
    /// From what is wanted, in squares of the half width.
    double differs(const Coverage& seen) const { return (seen - wanted_).cwiseAbs().sum() / (kPixels * kPixels); }

    const Brush& brush_;
    double half_mm_, greatest_mm_, px_per_mm_;
    Window window_;
    Coverage wanted_;
};

Ends::Ends(const Stroke& wanted, const Stroke& stroke, const Brush& brush, double step_tolerance)
    : wanted_(wanted), stroke_(stroke), brush_(brush), line_(stroke_, brush), step_tolerance_(step_tolerance) {}

Ends::~Ends() = default;

const Pass& Ends::plain(Beginning start) {
    std::optional<Pass>& pass = start == Beginning::hidden ? hidden_ : start == Beginning::turned ? turned_ : exposed_;
    if (!pass) {
        bool turns = false;
        closed_form(stroke_, brush_, line_, start, step_tolerance_, turns).into(pass.emplace());
    }
    return *pass;
}

double Ends::made_mm() const {
    const double depth = depth_of(stroke_, brush_, 0.0);
    return kMade * brush_.half_width(depth) + 4.0 * brush_.lag(depth);
}

Pass Ends::begun(const Pass& pass, const Pass& other) const {
    return beginning_of(pass, made_mm() + way_of(pass) - way_of(other));
}

const View& Ends::at_beginning() {
    if (!view_) {
        const double half = brush_.half_width(depth_of(stroke_, brush_, 0.0));
        view_ = std::make_unique<View>(wanted_, line_.at(0.0).middle, half, greatest_half_mm(stroke_, half), brush_);
    }
    return *view_;
}

const Coverage& Ends::exposed_picture() {
    if (!exposed_picture_)
        exposed_picture_ = at_beginning().picture(beginning_of(plain(Beginning::exposed), made_mm()));
    return *exposed_picture_;
}

Beginning Ends::best_beginning() {
    const double last_mm = painted_stretch(stroke_, brush_, line_.length())[1];
    const std::optional<Dot> dot = dot_of(wanted_, brush_);
    const bool hides =
        dot || hidden_beginning(stroke_, brush_, line_, InverseLag(line_, brush_), last_mm, step_tolerance_);
    if (!hides && !turned_beginning(stroke_, brush_, step_tolerance_)) return Beginning::exposed;
    const Pass& exposed = plain(Beginning::exposed);
    const View& view = at_beginning();
    if (dot) {
        Pass hidden;
        poses_of(*dot, brush_).into(hidden);
        return view.is_better([&] { return hidden; }, view.picture(exposed)) ? Beginning::hidden : Beginning::exposed;
    }
    const auto hidden = [&] { return begun(plain(Beginning::hidden), exposed); };
    if (!view.is_better(hidden, exposed_picture())) return Beginning::exposed;
    return hides ? hidden_or_turned() : Beginning::hidden;
}

Beginning Ends::hidden_or_turned() {
    const bool is_ball = begins_in_ball(stroke_, line_.length());
    if (!is_ball && (wanted_.start_covered || !begins_in_cap(stroke_, brush_))) return Beginning::hidden;
    if (!turned_beginning(stroke_, brush_, step_tolerance_)) return Beginning::hidden;
    const View& view = at_beginning();
    const Pass& exposed = plain(Beginning::exposed);
    const auto turned = [&] { return begun(plain(Beginning::turned), exposed); };
    const Coverage hidden = view.picture(begun(plain(Beginning::hidden), exposed));
    return view.is_better(turned, hidden, is_ball ? kWorthIt : kWorthRound) ? Beginning::turned : Beginning::hidden;
}

bool Ends::is_better_squared(const SquaredDot& dot, Beginning start) {
    const double half = std::min(half_width_at(wanted_, 0.0), brush_.half_width_range_mm()[1]);
    const View view(wanted_, dot.dot.from_mm, half, half, brush_);
    Pass round;
    if (start == Beginning::hidden) poses_of(dot.dot, brush_).into(round);
    const auto squared = [&] {
        bool turns = false;
        Pass pass;
        closed_form(dot, brush_, step_tolerance_, turns).into(pass);
        return pass;
    };
    return view.is_better(squared, view.picture(start == Beginning::hidden ? round : plain(start)));
}

bool Ends::begins_better(const Stroke& whole, Beginning start) {
    const Pass& before = plain(start);
    const View& view = at_beginning();
    const auto other = [&] {
        bool turns = false;
        Pass pass;
        closed_form(whole, brush_, Line(whole, brush_), Beginning::exposed, step_tolerance_, turns).into(pass);
        return begun(pass, before);
    };
    if (start == Beginning::exposed) return view.is_better(other, exposed_picture());
    return view.is_better(other, view.picture(beginning_of(before, made_mm())));
}

Ending Ends::best_ending(const SquaredEnd& squared, Beginning start) {
    return is_better_at_end(
               [&](bool& turns) {
                   return closed_form(squared.stroke, brush_, Line(squared.stroke, brush_), start, step_tolerance_,
                                      turns);
               },
               start, kWorthIt)
               ? Ending::squared
               : Ending::lifted;
}

bool Ends::is_better(const TurnedEnd& turned, Beginning start) {
    return is_better_at_end(
        [&](bool& turns) {
            return closed_form(turned.stroke, brush_, Line(turned.stroke, brush_), start, step_tolerance_, turns,
                               turned.depth_mm);
        },
        start, kWorthRound);
}

template <class Poses>
bool Ends::is_better_at_end(Poses&& poses, Beginning start, double worth) {
    const double half = brush_.half_width(depth_of(stroke_, brush_, 1.0));
    const View view(wanted_, line_.at(line_.length()).middle, half, greatest_half_mm(stroke_, half), brush_);
    const auto other = [&] {
        bool turns = false;
        Pass pass;
        poses(turns).into(pass);
        return pass;
    };
    return view.is_better(other, view.picture(plain(start)), worth);
}

}  // namespace brushsvg
