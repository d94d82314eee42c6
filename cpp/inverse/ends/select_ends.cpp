#include "inverse/ends/select_ends.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "brushsvg/coverage.hpp"
#include "brushsvg/mark_overlap.hpp"
#include "brushsvg/simulate.hpp"
#include "inverse/closed_form.hpp"

namespace brushsvg {
namespace {

/// The surroundings of an end, used to measure how far marks differ from the target there.
class EndView {
 public:
    EndView(const Stroke& target, const Brush& brush, Side side, double step_tolerance)
        : brush_(brush), step_tolerance_(step_tolerance), side_(side) {
        const Line line(target, brush);
        const PathEnd end = path_end(target, line, side);
        at_mm_ = end.at_mm;
        half_mm_ = std::max(kEndTuning.min_view_half_width_mm, std::min(end.half_mm, brush.half_width_range_mm()[1]));
        px_per_mm_ = kEndTuning.pixels_per_half_width / half_mm_;
        const double reach_mm = kEndTuning.view_half_side * half_mm_;
        window_ = {end.at_mm.x() - reach_mm, end.at_mm.y() - reach_mm, 2.0 * reach_mm, 2.0 * reach_mm};
        target_ = target_coverage({target}, window_, px_per_mm_);
    }

    /// Return the area of missing and excess paint, in squares of the half width. None if the moves cannot be made.
    std::optional<double> score(BrushMoves moves) const {
        trim_far_part(moves);
        bool turns = false;
        const auto poses = closed_form(moves, brush_, step_tolerance_, turns);
        if (!poses) return {};
        Marks marks;
        Pass pass;
        poses->write_to(pass);
        marks.passes.push_back(simulate_near(pass, brush_, window_, 0.05 * half_mm_));
        const Coverage seen = coverage(marks, brush_, window_, px_per_mm_);
        return (seen - target_).cwiseAbs().sum() /
               (kEndTuning.pixels_per_half_width * kEndTuning.pixels_per_half_width);
    }

 private:
    /// Leave out the part of the path from which no paint reaches the window.
    void trim_far_part(BrushMoves& moves) const {
        const bool at_start = side_ == Side::start;
        BrushMove& move = at_start ? moves.back() : moves.front();
        if (!move.line || (!at_start && move.turn)) return;
        const MiddlePolyline line = flatten(*move.line, kEndTuning.flattening_tolerance * half_mm_);
        const double reach_mm =
            std::sqrt(2.0) * kEndTuning.view_half_side * half_mm_ + kEndTuning.footprint_reach * line.col(3).maxCoeff();
        double first = line(line.rows() - 1, 2), last = 0.0;
        for (Eigen::Index i = 0; i + 1 < line.rows(); ++i) {
            const Eigen::Vector2d a = line.block<1, 2>(i, 0).transpose() - at_mm_;
            const Eigen::Vector2d way = (line.block<1, 2>(i + 1, 0) - line.block<1, 2>(i, 0)).transpose();
            const double length = way.norm(), near = length > 0.0 ? std::clamp(-a.dot(way) / length, 0.0, length) : 0.0;
            if (!(length > 0.0) || (a + near / length * way).norm() > reach_mm) continue;
            first = std::min(first, line(i, 2) + std::max(0.0, near - 2.0 * reach_mm));
            last = std::max(last, line(i, 2) + std::min(length, near + 2.0 * reach_mm));
        }
        if (at_start)
            move.to_mm = std::min(move.to_mm, std::max(last, move.latest_mm + reach_mm));
        else
            move.from_mm = move.latest_mm =
                std::min(std::max(move.from_mm, first), std::max(move.from_mm, move.to_mm - reach_mm));
    }

    const Brush& brush_;
    double step_tolerance_, half_mm_, px_per_mm_;
    Side side_;
    Eigen::Vector2d at_mm_;
    Window window_;
    Coverage target_;
};

/// Groups of terminals to try together. The next group is tried only if none of a group has room.
using Requests = std::vector<std::vector<Terminal>>;

Requests list_requests(Side side, Terminal terminal) {
    using T = Terminal;
    if (terminal == T::pointed) return {{T::pointed}, {T::round}};
    if (terminal == T::round) return {{T::round}, {T::pointed}};
    if (terminal == T::butt) return {{T::butt}, {T::round}, {T::pointed}};
    // no end is drawn into a point unless that is requested: it would be a thorn where the drawn end is blunt
    std::vector<T> all{T::round, T::butt, T::automatic};
    if (side == Side::start) all.push_back(T::pointed);
    return {all};
}

/// Try the requested styles and keep those that are better than the ones before them, the best first. `worth`: how much
/// each must win. `make_moves`: the moves with a style; none if there is no room.
template <class Styles, class MakeMoves>
std::vector<std::pair<typename Styles::value_type, BrushMoves>> rank_styles(const Styles& styles,
                                                                            const Requests& requests,
                                                                            const EndView& view, double min_gain,
                                                                            MakeMoves&& make_moves) {
    std::vector<std::pair<typename Styles::value_type, BrushMoves>> best;
    for (const std::vector<Terminal>& names : requests) {
        std::optional<double> least;
        for (const auto& style : styles) {
            if (std::find(names.begin(), names.end(), style.name) == names.end()) continue;
            const std::optional<BrushMoves> moves = make_moves(style);
            // the plainest style has room everywhere: where it is requested, nothing else is tried
            const bool is_plainest = names.size() == 1 && names.front() == styles.front().name;
            const std::optional<double> score = !moves ? std::nullopt : is_plainest ? 0.0 : view.score(*moves);
            if (!score || (least && !(*score + min_gain < *least))) continue;
            least = score;
            best.insert(best.begin(), {style, *moves});
        }
        if (least) break;
    }
    return best;
}

std::optional<BrushMoves> make_moves(const StartStyle& start, const StrokeWithEnd& ended, const Brush& brush,
                                     Caps caps) {
    std::optional<BrushMoves> moves = start.moves(ended.stroke, brush, caps);
    if (moves && ended.turn_depth_mm) {
        const Cubics& line = ended.stroke.middle_mm;
        moves->push_back({TurnRound{point_at(line, {line.rows() - 1, 1.0}), *ended.turn_depth_mm}});
    }
    return moves;
}

}  // namespace

std::vector<BrushMoves> select_ends(const Stroke& stroke, const Brush& brush, const CompensateOptions& options,
                                    double step_tolerance) {
    const Settings& own = stroke.settings;
    const bool is_dot = turned_dot(stroke, brush).has_value();
    Terminal start = own.start ? parse_terminal(*own.start, stroke.id) : options.start;
    if (is_dot && start == Terminal::butt) start = Terminal::automatic;  // for a dot with corners
    const Terminal end = own.end ? parse_terminal(*own.end, stroke.id) : options.end;
    const Caps start_caps = start == Terminal::butt ? Caps::straight : Caps::round;
    const Caps end_caps = end == Terminal::butt ? Caps::straight : Caps::round;
    const auto starts = [&](const auto& styles, const StrokeWithEnd& ended) {
        return rank_styles(styles, list_requests(Side::start, start),
                           EndView(stroke, brush, Side::start, step_tolerance),
                           stroke.start_covered ? kEndTuning.min_gain_covered : kEndTuning.min_gain,
                           [&](const StartStyle& style) { return make_moves(style, ended, brush, start_caps); });
    };
    std::vector<BrushMoves> out;
    if (is_dot) {
        for (auto& [style, moves] : starts(kDotStyles, {stroke, {}})) out.push_back(std::move(moves));
        return out;
    }
    const auto begun = starts(kStartStyles, {extend_to_drawn_end(stroke, brush), {}});
    const auto ended =
        rank_styles(kEndStyles, list_requests(Side::end, end), EndView(stroke, brush, Side::end, step_tolerance),
                    stroke.end_covered ? kEndTuning.min_gain_covered : kEndTuning.min_gain,
                    [&](const EndStyle& style) -> std::optional<BrushMoves> {
                        const auto with_end = style.ended(stroke, brush, end_caps);
                        if (!with_end) return {};
                        return make_moves(begun.front().first, *with_end, brush, start_caps);
                    });
    out.push_back(ended.front().second);
    const auto with_end = ended.front().first.ended(stroke, brush, end_caps);
    for (std::size_t i = 1; i < begun.size(); ++i)
        if (auto moves = make_moves(begun[i].first, *with_end, brush, start_caps)) out.push_back(std::move(*moves));
    return out;
}

}  // namespace brushsvg
