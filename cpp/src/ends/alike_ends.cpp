#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "brushsvg/compensate.hpp"
#include "brushsvg/region.hpp"
#include "ends/select_ends.hpp"
#include "landing.hpp"
#include "parallel.hpp"
#include "refuse_unusable.hpp"

namespace brushsvg {
namespace {

/// How far ahead the outline of an end is, ray by ray from one side to the other, from the mean of them.
/// In half widths.
using EndProfile = Eigen::Array<double, 9, 1>;

/// An end whose terminal is to be chosen, and what each terminal costs there.
struct FreeEnd {
    std::size_t stroke;
    Side side;
    double half_mm;
    EndProfile profile;
    TerminalCosts costs;
};

/// None where the outline of the shape is not near on both sides and ahead: the end is in another stroke. A line
/// without a shape has round caps.
std::optional<EndProfile> profile_of(const Rings& shape, const PathEnd& end) {
    const EndProfile across = EndProfile::LinSpaced(-0.9, 0.9);
    if (shape.empty()) {
        const EndProfile round = (1.0 - across.square()).sqrt();
        return EndProfile(round - round.mean());
    }
    const PathEnd inside{end.place(-0.5 * end.half_mm, 0.0), end.along, end.left, end.half_mm};
    for (const double side : {-1.0, 1.0}) {
        const PathEnd sideways{inside.at_mm, side * end.left, -side * end.along, end.half_mm};
        if (!(outline_ahead_mm(shape, sideways, 0.0) <= kTuning.free_within * end.half_mm)) return {};
    }
    EndProfile ahead;
    for (Eigen::Index i = 0; i < across.size(); ++i) {
        ahead[i] = outline_ahead_mm(shape, inside, across[i] * end.half_mm) / end.half_mm;
        if (!std::isfinite(ahead[i])) ahead[i] = 0.0;  // beside a narrow tip
    }
    const double middle = ahead[across.size() / 2];
    if (!(middle > 0.0 && middle <= kTuning.cut_farthest)) return {};
    ahead = ahead.min(kTuning.cut_farthest);
    return EndProfile(ahead - ahead.mean());
}

/// The shapes of elements, each once, of what their strokes are to paint.
std::map<std::string, Rings> shapes_of(const std::vector<Stroke>& strokes) {
    std::map<std::string, Rings> shapes;
    for (const Stroke& stroke : strokes)
        if (stroke.id.repeat == 1) {
            Rings& rings = shapes[stroke.id.element];
            rings.insert(rings.end(), stroke.wanted_mm.begin(), stroke.wanted_mm.end());
        }
    std::vector<Rings*> all;
    for (auto& [element, rings] : shapes)
        if (!rings.empty()) all.push_back(&rings);
    on_all_processors(0, all.size(), [&](std::size_t i) { *all[i] = unite(*all[i]); });
    return shapes;
}

/// Whether two ends are drawn alike, or one as the other mirrored.
bool are_alike(const FreeEnd& a, const FreeEnd& b) {
    if (std::abs(a.half_mm - b.half_mm) > kTuning.alike_width * std::max(a.half_mm, b.half_mm)) return false;
    const double apart = std::min((a.profile - b.profile).abs().mean(), (a.profile - b.profile.reverse()).abs().mean());
    return apart <= kTuning.alike_outline;
}

/// The terminal that costs all ends least together, of those that each has room for; a plainer one where another wins
/// less than can be seen.
std::optional<Terminal> best_for_all(const std::vector<FreeEnd*>& ends) {
    std::optional<Terminal> best;
    double least = 0.0;
    for (const Terminal terminal : {Terminal::pointed, Terminal::round, Terminal::butt}) {
        double sum = 0.0;
        bool has_room = true;
        for (const FreeEnd* end : ends) {
            const std::optional<double>& cost = end->costs[std::size_t(terminal)];
            has_room = has_room && cost;
            sum += cost.value_or(0.0) + kTuning.worth;
        }
        if (!has_room || (best && !(sum < least))) continue;
        best = terminal;
        least = sum - kTuning.worth * double(ends.size());
    }
    return best;
}

}  // namespace

void match_alike_ends(std::vector<Stroke>& strokes, const Brush& brush, const CompensateOptions& options) {
    require_usable(brush);
    std::map<std::string, Rings> shapes = shapes_of(strokes);
    std::vector<FreeEnd> ends;
    for (std::size_t k = 0; k < strokes.size(); ++k) {
        Stroke& stroke = strokes[k];
        check(stroke);
        stroke.alike_start = stroke.alike_end = std::nullopt;
        if (stroke.closed || turned_dot(stroke, brush)) continue;
        const Line line(stroke, brush);
        const Rings& shape = shapes[stroke.id.element];
        const auto take = [&](Side side, const std::optional<std::string>& own, Terminal asked) {
            const Terminal terminal = own ? terminal_named(*own, stroke.id) : asked;
            if (terminal != Terminal::automatic || !(line.length() > 0.0)) return;
            const PathEnd end = path_end(stroke, line, side);
            if (end.half_mm < brush.half_width(std::max(brush.depth_range_mm[0], kTurnOverDepthMm))) return;
            if (const auto profile = profile_of(shape, end)) ends.push_back({k, side, end.half_mm, *profile, {}});
        };
        take(Side::start, stroke.settings.start, options.start);
        take(Side::end, stroke.settings.end, options.end);
    }
    std::vector<std::vector<FreeEnd*>> groups;
    for (FreeEnd& end : ends) {
        const auto is_of = [&](const auto& group) { return are_alike(*group.front(), end); };
        const auto found = std::find_if(groups.begin(), groups.end(), is_of);
        (found == groups.end() ? groups.emplace_back() : *found).push_back(&end);
    }
    groups.erase(std::remove_if(groups.begin(), groups.end(), [](const auto& group) { return group.size() < 2; }),
                 groups.end());
    std::vector<std::pair<FreeEnd*, bool>> all;  // and whether the start of its stroke is in the same group
    for (const auto& group : groups)
        for (FreeEnd* end : group) {
            const auto is_start = [&](const FreeEnd* other) {
                return other->stroke == end->stroke && other->side == Side::start;
            };
            all.emplace_back(end, std::any_of(group.begin(), group.end(), is_start));
        }
    on_all_processors(0, all.size(), [&](std::size_t i) {
        const auto& [end, with_same_start] = all[i];
        end->costs =
            terminal_costs(strokes[end->stroke], brush, end->side, with_same_start, 0.5 * options.tolerance_mm);
    });
    for (const auto& group : groups)
        if (const auto terminal = best_for_all(group))
            for (const FreeEnd* end : group) {
                Stroke& stroke = strokes[end->stroke];
                (end->side == Side::start ? stroke.alike_start : stroke.alike_end) =
                    kTerminals[std::size_t(*terminal)].first;
            }
}

}  // namespace brushsvg
