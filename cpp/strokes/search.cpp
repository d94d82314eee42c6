#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/parallel.hpp"
#include "base/within.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/compensate.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/excess_turning.hpp"
#include "brushsvg/region.hpp"
#include "brushsvg/stroke_search.hpp"
#include "inverse/closed_form.hpp"
#include "inverse/ends/end_styles.hpp"
#include "inverse/repeats.hpp"
#include "marks/coverage_contours.hpp"
#include "strokes/canvas.hpp"
#include "strokes/cut_at_bends.hpp"
#include "strokes/lines_into_bare_areas.hpp"
#include "strokes/stroke_variants.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr std::size_t kMaxAreas = 200;  // bare areas of one shape that are tried at most: limits the work
// Tolerance of a trial's steps: coarser ones paint thorns that plans do not have.
constexpr double kStepToleranceMm = 0.01;
constexpr double kCurveToleranceHalfWidths = 0.03;  // how far a curve may be off its line, in half widths of the line
// Margin round a shape, in the brush's greatest half widths: no paint further away counts.
constexpr double kMarginHalfWidths = 2.0;
constexpr double kMiddleToleranceMm = 0.1;  // tolerance of flattened middle lines, used to find the nearest place
// Changes of a stroke's path that are tried: shares of its width, and half widths by which it is cut short.
constexpr std::array<double, 2> kWidthFactors{0.95, 0.88};
constexpr std::array<double, 4> kCutHalfWidths{0.1, 0.4, 0.8, 1.5};
constexpr double kPixelNoiseMm2 = 0.4;  // weighted area of paint outside of a shape: less is a pixel's noise
// Least gain of another way to paint a stroke: less is not worth differing from the request.
constexpr double kMinGainMm2 = 0.05;
// Margin round a stroke, in its half widths: no variant of it paints further away.
constexpr double kStrokeMarginHalfWidths = 3.0;
constexpr std::size_t kMaxChangedStrokes = 40;  // strokes of one shape that are changed at most
// Share of a pixel without paint above which it is bare, as at the edges of strips.
constexpr float kMinBareShare = 0.4f;
constexpr int kTurnMarginPx = 3;  // margin round a change, in which the outline's turning is compared

/// The search for strokes that paint the bare parts of one shape.
class Search {
 public:
    Search(const PaintedShape& shape, const Brush& brush, const ObjectiveWeights& weights)
        : brush_(brush),
          weights_(weights),
          half_mm_(brush.half_width_range_mm()),
          canvas_(shape.target_mm, weights, kMarginHalfWidths * half_mm_[1]),
          outline_(shape.target_mm, canvas_),
          paint_(Coverage::Zero(canvas_.whole().rows, canvas_.whole().columns)),
          refused_(Mask::Zero(paint_.rows(), paint_.cols())) {
        half_mm_[0] = std::max(half_mm_[0], 1e-3);
        for (const Pass& pass : shape.passes) tiles_.push_back(canvas_.paint(pass, brush));
        for (const Tile& tile : tiles_) paint_over(paint_, canvas_.whole(), tile);
    }

    /// Return the areas that the strokes leave bare, from `least_mm2` on, the largest first.
    std::vector<UncoveredArea> find_uncovered(double least_mm2) const {
        std::vector<UncoveredArea> found;
        for_each_bare_area([&](Pixels&& pixels, std::size_t) {
            Rings outline = trace_bare_area(pixels);
            const double mm2 = area(outline);
            if (mm2 >= least_mm2) found.push_back({std::move(outline), find_deepest(pixels), mm2});
        });
        std::stable_sort(found.begin(), found.end(),
                         [](const UncoveredArea& a, const UncoveredArea& b) { return a.mm2 > b.mm2; });
        return found;
    }

    /// are_free: whether strokes may get another path. Otherwise strokes are only added.
    SearchedShape run(const std::vector<Stroke>& strokes, bool are_free) {
        SearchedShape found;
        for (const Stroke& stroke : strokes) found.strokes.push_back({stroke});
        found.changed.assign(strokes.size(), false);
        if (are_free) improve(found);
        for (std::size_t k = 0; k < strokes.size(); ++k) {
            middles_.push_back(flatten_middles(found.strokes[k]));
            if (found.changed[k]) former_middles_.push_back(flatten_middles({strokes[k]}));
        }
        found.added = add_strokes();
        return found;
    }

 private:
    /// Improve the strokes that stick out of the shape, the worst first.
    void improve(SearchedShape& found) {
        std::vector<std::pair<double, std::size_t>> beyond;
        for (std::size_t k = 0; k < tiles_.size(); ++k)
            if (sticks_out(tiles_[k])) beyond.push_back({-canvas_.bulge_mm2(tiles_[k]), k});
        std::sort(beyond.begin(), beyond.end());
        if (beyond.size() > kMaxChangedStrokes) beyond.resize(kMaxChangedStrokes);
        for (const auto& [mm2, k] : beyond) {
            const Stroke given = found.strokes[k].front();
            if (is_set(given.settings.start) || is_set(given.settings.end)) continue;  // set by the artist
            const bool fills = given.start_covered && given.end_covered;
            Painting painting{{given}, tiles_[k]};
            if (!improve_stroke(painting, k, {fills, true, fills && k > 0, false})) continue;
            tiles_[k] = std::move(painting.tile);
            repaint(box_around(given));
            found.strokes[k] = std::move(painting.strokes);
            found.changed[k] = true;
        }
    }

    static bool is_set(const std::optional<std::string>& end) { return end && *end != "auto"; }

    bool sticks_out(const Tile& tile) const { return weights_.bulge * canvas_.bulge_mm2(tile) > kPixelNoiseMm2; }

    /// The strokes that replace a stroke, and their paint.
    struct Painting {
        std::vector<Stroke> strokes;
        Tile tile;
    };

    /// The changes that improve_stroke may make. is_last: no stroke is added after this one, so that the areas which it
    /// leaves bare count in full.
    struct AllowedChanges {
        bool reversed, cut, left_out, is_last;
    };

    /// Change a stroke, of the tile k, so that it costs less. Return false if no change does. k: the number of tiles if
    /// the stroke has none yet.
    bool improve_stroke(Painting& painting, std::size_t k, const AllowedChanges& allowed) {
        const Stroke given = painting.strokes.front();
        const PixelBox box = box_around(given);
        if (box.is_empty()) return false;
        Coverage other_paint = Coverage::Zero(box.rows, box.columns);
        for (std::size_t other = 0; other < tiles_.size(); ++other)
            if (other != k) paint_over(other_paint, box, tiles_[other]);
        const auto picture_with = [&](const Painting& now) {
            Coverage both = other_paint;
            paint_over(both, box, now.tile);
            return both;
        };
        const auto area_cost = [&](const Painting& now, const Coverage& both) {
            return canvas_.cost_mm2(box, both, allowed.is_last) + (double(now.strokes.size()) - 1.0) * stroke_mm2();
        };
        const double own_turns = target_turns(box);
        const auto excess = [&](const Coverage& both) { return std::max(0.0, turns(both, box) - own_turns); };
        const Coverage given_picture = picture_with(painting);
        double least_area = area_cost(painting, given_picture) - kMinGainMm2;
        double least = least_area + turn_mm2() * excess(given_picture);
        bool is_changed = false;
        const auto keep_better = [&](Painting other) {
            const Coverage both = picture_with(other);
            const double area_mm2 = area_cost(other, both);
            // fewer turns win at most the cost of one turn
            if (area_mm2 >= least_area + turn_mm2()) return false;
            const double cost = area_mm2 + turn_mm2() * excess(both);
            if (cost >= least) return false;
            least = cost;
            least_area = area_mm2;
            painting = std::move(other);
            return is_changed = true;
        };
        const Stroke in_room = within_room(given, outline_, kStepToleranceMm);
        Variant best;
        const auto try_variant = [&](const Variant& variant) {
            checkpoint(100);
            const std::optional<Stroke> stroke = apply_variant(variant.is_in_room ? in_room : given, variant, half_mm_);
            const std::optional<Tile> tile = stroke ? paint_strokes({*stroke}, box) : std::nullopt;
            if (tile && keep_better({{*stroke}, *tile})) best = variant;
        };
        // try one choice after the other: the direction, the ends, the room, the width, the length
        for (const bool reversed : {false, true}) {
            if (reversed && !allowed.reversed) break;
            Variant from;
            from.is_reversed = reversed;
            if (reversed) try_variant(from);
            for (const auto& [square, pointed] : {std::pair{true, true}, {false, false}, {false, true}}) {
                if (square != given.target_mm.empty()) continue;  // without a shape no end is square
                Variant variant = from;
                variant.is_square = square;
                variant.is_pointed = pointed;
                try_variant(variant);
            }
        }
        const auto try_each = [&](const auto& values, auto&& set) {
            const Variant so_far = best;
            for (const double value : values) {
                Variant variant = so_far;
                set(variant, value);
                try_variant(variant);
            }
        };
        Variant narrow = best;
        narrow.is_in_room = true;
        try_variant(narrow);
        try_each(kWidthFactors, [](Variant& variant, double width) { variant.width = width; });
        for (const std::size_t end : {0u, 1u})
            if (!given.closed) try_each(kCutHalfWidths, [&](Variant& variant, double cut) { variant.cut[end] = cut; });
        const Stroke whole = painting.strokes.front();
        std::vector<Gap> gaps;
        for (bool is_better = allowed.cut; is_better;) {
            is_better = false;
            std::vector<Gap> best_gaps;
            for (const Gap& gap : find_gaps(whole)) {
                std::vector<Gap> all = gaps;
                const auto meets = [&](const Gap& other) { return gap[0] <= other[1] && other[0] <= gap[1]; };
                if (std::any_of(all.begin(), all.end(), meets)) continue;
                all.insert(std::upper_bound(all.begin(), all.end(), gap), gap);
                const std::vector<Stroke> parts = brushsvg::cut_at_gaps(whole, all);
                const std::optional<Tile> tile = paint_strokes(parts, box);
                if (!tile || !keep_better({parts, *tile})) continue;
                best_gaps = all;
                is_better = true;
            }
            if (is_better) gaps = best_gaps;
        }
        if (allowed.left_out) keep_better({{}, Tile{}});
        return is_changed;
    }

    /// Update the paint in a box after a stroke has changed.
    void repaint(const PixelBox& box) {
        Coverage paint = Coverage::Zero(box.rows, box.columns);
        for (const Tile& tile : tiles_) paint_over(paint, box, tile);
        paint_.block(box.row, box.column, box.rows, box.columns) = paint;
    }

    static MiddlePolyline flatten_middles(const std::vector<Stroke>& parts) {
        MiddlePolyline all(0, 4);
        for (const Stroke& part : parts) {
            const MiddlePolyline line = flatten(part, kMiddleToleranceMm);
            const Index rows = all.rows();
            all.conservativeResize(rows + line.rows(), 4);
            all.bottomRows(line.rows()) = line;
        }
        return all;
    }

    PixelBox box_around(const Stroke& stroke) const {
        const MiddlePolyline line = flatten(stroke, kMiddleToleranceMm);
        const double beside = kStrokeMarginHalfWidths * line.col(3).maxCoeff();
        const Vector2d low = line.leftCols<2>().colwise().minCoeff().transpose().array() - beside;
        const Vector2d high = line.leftCols<2>().colwise().maxCoeff().transpose().array() + beside;
        return canvas_.box_of(low, high);
    }

    /// Return the paint of strokes in a box, as a plan would paint them. None if one of them cannot be painted.
    std::optional<Tile> paint_strokes(const std::vector<Stroke>& strokes, const PixelBox& box) const {
        CompensateOptions options;
        options.start = Terminal::automatic;
        options.end = Terminal::automatic;
        Tile all{box, Coverage::Zero(box.rows, box.columns)};
        for (const Stroke& stroke : strokes) try {
                checkpoint(100);
                const Pass pass = compensate(stroke, brush_, options).pass;
                if (pass.poses_mm.rows() == 0) return std::nullopt;
                paint_over(all.share, box, canvas_.paint(pass, brush_));
            } catch (const Error&) {
                return std::nullopt;
            }
        return all;
    }

    std::vector<AddedStroke> add_strokes() {
        std::vector<AddedStroke> added;
        for (std::size_t k = 0; k < kMaxAreas; ++k) {
            const std::optional<BareArea> area = find_largest_bare_area();
            if (!area) break;
            std::optional<AddedStroke> best = find_best_stroke(*area);
            if (best) {
                middles_.push_back(flatten(best->stroke, kMiddleToleranceMm));
                added.push_back(std::move(*best));
            } else {
                mark_refused();
            }
        }
        return added;
    }

    using Mask = Eigen::Matrix<unsigned char, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    double stroke_mm2() const { return weights_.stroke * half_mm_[1] * half_mm_[1]; }
    double turn_mm2() const { return weights_.turn * half_mm_[1] * half_mm_[1]; }

    /// Return how much the outlines in a picture of a box turn, in full turns.
    double turns(const Coverage& picture, const PixelBox& box) const {
        return excess_turning(trace_half_coverage(picture, canvas_.window_of(box), canvas_.px_per_mm()), {});
    }

    /// Return the shape's own turning in a box. A mark that turns less than the shape gains nothing.
    double target_turns(const PixelBox& box) const {
        return turns(canvas_.target().block(box.row, box.column, box.rows, box.columns), box);
    }

    bool is_bare(Index row, Index column) const {
        return !refused_(row, column) && canvas_.inner()(row, column) - paint_(row, column) > kMinBareShare;
    }

    using Pixels = std::vector<std::array<Index, 2>>;

    /// Call `visit` with the pixels of each bare area, and with the number of their neighbours that are not bare.
    template <class Visit>
    void for_each_bare_area(Visit&& visit) const {
        Mask seen = Mask::Zero(paint_.rows(), paint_.cols());
        for (Index row = 1; row + 1 < paint_.rows(); ++row) {
            checkpoint(1);
            if ((canvas_.inner().row(row) - paint_.row(row)).maxCoeff() <= kMinBareShare) continue;
            for (Index column = 1; column + 1 < paint_.cols(); ++column) {
                if (seen(row, column) || !is_bare(row, column)) continue;
                Pixels pixels{{row, column}};
                seen(row, column) = 1;
                std::size_t edges = 0;
                for (std::size_t k = 0; k < pixels.size(); ++k)
                    for (Index r = pixels[k][0] - 1; r <= pixels[k][0] + 1; ++r)
                        for (Index c = pixels[k][1] - 1; c <= pixels[k][1] + 1; ++c) {
                            if (r < 1 || c < 1 || r + 1 >= paint_.rows() || c + 1 >= paint_.cols()) continue;
                            if (!is_bare(r, c)) {
                                ++edges;
                            } else if (!seen(r, c)) {
                                seen(r, c) = 1;
                                pixels.push_back({r, c});
                            }
                        }
                visit(std::move(pixels), edges);
            }
        }
    }

    /// Return the bare area that is worth most, if a stroke that paints all of it is worth its cost.
    std::optional<BareArea> find_largest_bare_area() const {
        const double px_mm = 1.0 / canvas_.px_per_mm();
        Pixels largest;
        double most = stroke_mm2();
        for_each_bare_area([&](Pixels&& pixels, std::size_t edges) {
            const double gain = px_mm * (px_mm * double(pixels.size()) * (weights_.missing + weights_.notch) +
                                         double(edges) / 3.0 * weights_.seen_mm * weights_.missing);
            if (gain <= most) return;
            most = gain;
            largest = std::move(pixels);
        });
        if (largest.empty()) return std::nullopt;
        BareArea area;
        for (const auto& [row, column] : largest) area.places.push_back(canvas_.place(row, column));
        area.deepest = find_deepest(largest);
        pixels_ = std::move(largest);
        return area;
    }

    /// Return the place farthest from the edge of an area, found by removing rings of pixels.
    Vector2d find_deepest(const Pixels& pixels) const {
        Index top = pixels[0][0], left = pixels[0][1], bottom = top, right = left;
        for (const auto& [row, column] : pixels) {
            top = std::min(top, row), bottom = std::max(bottom, row);
            left = std::min(left, column), right = std::max(right, column);
        }
        Mask in = Mask::Zero(bottom - top + 3, right - left + 3);
        for (const auto& [row, column] : pixels) in(row - top + 1, column - left + 1) = 1;
        Pixels left_over = pixels;
        std::array<Index, 2> last = pixels[pixels.size() / 2];
        while (!left_over.empty()) {
            last = left_over[left_over.size() / 2];
            Pixels inner, rim;
            for (const auto& each : left_over) {
                const Index r = each[0] - top + 1, c = each[1] - left + 1;
                (in.block<3, 3>(r - 1, c - 1).cast<int>().sum() == 9 ? inner : rim).push_back(each);
            }
            for (const auto& each : rim) in(each[0] - top + 1, each[1] - left + 1) = 0;
            left_over = std::move(inner);
        }
        return canvas_.place(last[0], last[1]);
    }

    void mark_refused() {
        for (const auto& [row, column] : pixels_) refused_(row, column) = 1;
    }

    Candidates find_candidates(const BareArea& area) {
        Candidates all = lines_straight_out(area, middles_, outline_, half_mm_);
        const auto take = [&](Candidates&& more) { all.insert(all.end(), more.begin(), more.end()); };
        take(lines_along_middles(area, former_middles_, half_mm_));
        take(lines_along_edges(area, outline_, half_mm_));
        take(lines_from_corners(area, outline_, half_mm_));
        double edge_mm = std::numeric_limits<double>::infinity();
        for (const Vector2d& place : area.places) edge_mm = std::min(edge_mm, outline_.edge_mm(place));
        if (edge_mm > 2.0 * weights_.seen_mm) take(lines_across(area, outline_, half_mm_));
        return all;
    }

    struct Trial {
        Stroke stroke;
        Tile tile;
        double gain_mm2;
    };

    std::optional<Trial> try_line(const WideLine& line) const {
        Trial trial;
        FittedLine fitted = fit_cubics(line, kCurveToleranceHalfWidths * line.col(2).mean(), false);
        trial.stroke.middle_mm = std::move(fitted.middle_mm);
        trial.stroke.half_width = std::move(fitted.half_width);
        for (WidthKnot& knot : trial.stroke.half_width)
            knot.half_width_mm = std::clamp(knot.half_width_mm, half_mm_[0], half_mm_[1]);
        try {
            bool turns = false;
            const auto moves =
                kStartStyles.front().moves(extend_to_drawn_end(trial.stroke, brush_), brush_, Caps::round);
            const auto poses = moves ? closed_form(*moves, brush_, kStepToleranceMm, turns) : std::nullopt;
            if (!poses) return std::nullopt;
            Pass pass;
            poses->write_to(pass);
            trial.tile = canvas_.paint(pass, brush_);
        } catch (const Error&) {
            return std::nullopt;
        }
        // a mark that is finer than a pixel everywhere has no outline
        if (trial.tile.box.is_empty() || trial.tile.share.maxCoeff() <= kHalfCoverage) return std::nullopt;
        trial.gain_mm2 = area_gain_mm2(trial.tile);
        return trial;
    }

    /// Return how much less the areas cost with a tile, less the price of its stroke.
    double area_gain_mm2(const Tile& tile) const {
        const PixelBox& box = tile.box;
        const Coverage before = paint_.block(box.row, box.column, box.rows, box.columns);
        return canvas_.cost_mm2(box, before) - canvas_.cost_mm2(box, before.cwiseMax(tile.share)) - stroke_mm2();
    }

    /// Return how much more the outline of the paint turns with a tile, in full turns.
    double turning_gain(const Tile& tile) const {
        PixelBox box{std::max<Index>(tile.box.row - kTurnMarginPx, 0),
                     std::max<Index>(tile.box.column - kTurnMarginPx, 0), 0, 0};
        box.rows = std::min(tile.box.row + tile.box.rows + kTurnMarginPx, paint_.rows()) - box.row;
        box.columns = std::min(tile.box.column + tile.box.columns + kTurnMarginPx, paint_.cols()) - box.column;
        const Coverage before = paint_.block(box.row, box.column, box.rows, box.columns);
        Coverage after = before;
        paint_over(after, box, tile);
        const double own = target_turns(box);
        return std::max(own, turns(after, box)) - std::max(own, turns(before, box));
    }

    std::optional<AddedStroke> find_best_stroke(const BareArea& area) {
        std::optional<Trial> best;
        for (const WideLine& line : find_candidates(area)) {
            checkpoint(50);
            std::optional<Trial> trial = try_line(line);
            if (!trial || trial->gain_mm2 + turn_mm2() <= (best ? best->gain_mm2 : 0.0)) continue;
            trial->gain_mm2 -= turn_mm2() * turning_gain(trial->tile);
            if (trial->gain_mm2 > (best ? best->gain_mm2 : 0.0)) best = std::move(trial);
        }
        if (!best) return std::nullopt;
        const Rings area_mm = trace_bare_area(pixels_);
        best->stroke.settings.start = "pointed";  // under the paint of other strokes
        best->stroke.settings.end = "round";
        if (weights_.bulge * canvas_.bulge_mm2(best->tile) > kMinGainMm2) {
            Painting painting{{best->stroke}, best->tile};
            improve_stroke(painting, tiles_.size(), {true, false, false, true});
            // It must still win as the trials are measured: otherwise the same trial wins again and again.
            const double gain_mm2 = area_gain_mm2(painting.tile) - turn_mm2() * turning_gain(painting.tile);
            if (gain_mm2 > 0.0) best = Trial{std::move(painting.strokes.front()), std::move(painting.tile), gain_mm2};
        }
        tiles_.push_back(best->tile);
        paint_over(paint_, canvas_.whole(), best->tile);
        AddedStroke added;
        added.mark_mm = trace_half_coverage(best->tile.share, canvas_.window_of(best->tile.box), canvas_.px_per_mm());
        added.stroke = std::move(best->stroke);
        added.neighbour = nearest_middle(area.deepest);
        added.area_mm = area_mm;
        return added;
    }

    std::size_t nearest_middle(const Vector2d& place) const {
        std::size_t which = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < middles_.size(); ++k)
            for (Index i = 0; i < middles_[k].rows(); ++i)
                if (const double off = (middles_[k].block<1, 2>(i, 0).transpose() - place).squaredNorm(); off < least) {
                    least = off;
                    which = k;
                }
        return which;
    }

    /// Return the outline of a bare area, up to the edges of shape and paint.
    Rings trace_bare_area(const Pixels& pixels) const {
        const int steps = 1 + int(std::ceil(weights_.seen_mm * canvas_.px_per_mm()));
        Index top = pixels[0][0], left = pixels[0][1], bottom = top, right = left;
        for (const auto& [row, column] : pixels) {
            top = std::min(top, row), bottom = std::max(bottom, row);
            left = std::min(left, column), right = std::max(right, column);
        }
        PixelBox box{std::max<Index>(top - steps, 0), std::max<Index>(left - steps, 0), 0, 0};
        box.rows = std::min(bottom + steps + 1, paint_.rows()) - box.row;
        box.columns = std::min(right + steps + 1, paint_.cols()) - box.column;
        Coverage picture = Coverage::Zero(box.rows, box.columns);
        Pixels rim;
        for (const auto& [row, column] : pixels) rim.push_back({row - box.row, column - box.column});
        for (const auto& [row, column] : rim) picture(row, column) = 1.0f;
        const Coverage bare = (canvas_.target() - paint_).block(box.row, box.column, box.rows, box.columns);
        for (int step = 0; step < steps; ++step) {
            Pixels next;
            for (const auto& [row, column] : rim)
                for (Index r = std::max<Index>(row - 1, 0); r <= std::min(row + 1, box.rows - 1); ++r)
                    for (Index c = std::max<Index>(column - 1, 0); c <= std::min(column + 1, box.columns - 1); ++c)
                        if (picture(r, c) == 0.0f && bare(r, c) > kMinBareShare) {
                            picture(r, c) = 1.0f;
                            next.push_back({r, c});
                        }
            rim = std::move(next);
        }
        return trace_half_coverage(picture, canvas_.window_of(box), canvas_.px_per_mm());
    }

    const Brush& brush_;
    const ObjectiveWeights& weights_;
    std::array<double, 2> half_mm_;
    Canvas canvas_;
    ShapeOutline outline_;
    Coverage paint_;
    Mask refused_;
    std::vector<Tile> tiles_;  ///< paint of all strokes, with their current paths
    std::vector<MiddlePolyline> middles_;
    std::vector<MiddlePolyline> former_middles_;  ///< old middle lines of the strokes that have another path now
    mutable Pixels pixels_;                       ///< pixels of the bare area that is being painted
};

bool are_alike(const Pass& a, const Pass& b) {
    return a.poses_mm.rows() == b.poses_mm.rows() && a.poses_mm.col(2).isApprox(b.poses_mm.col(2)) &&
           a.arcs.size() == b.arcs.size() && a.tool_axes == b.tool_axes;
}

bool are_alike(const PaintedShape& a, const PaintedShape& b) {
    if (!brushsvg::are_alike(a.target_mm, b.target_mm) || a.strokes.size() != b.strokes.size() ||
        a.passes.size() != b.passes.size())
        return false;
    for (std::size_t k = 0; k < a.strokes.size(); ++k)
        if (!brushsvg::are_alike(a.strokes[k], b.strokes[k])) return false;
    for (std::size_t k = 0; k < a.passes.size(); ++k)
        if (!are_alike(a.passes[k], b.passes[k])) return false;
    return true;
}

/// Find the original of each shape: its outline, strokes and passes are equal but for their place.
std::vector<Original> find_originals(const std::vector<PaintedShape>& shapes) {
    std::vector<Points> points_mm;
    for (const PaintedShape& shape : shapes) {
        Rings lists = shape.target_mm;
        for (const Stroke& stroke : shape.strokes) lists.push_back(points_of(stroke));
        for (const Pass& pass : shape.passes) lists.push_back(pass.poses_mm.leftCols<2>());
        points_mm.push_back(joined(lists));
    }
    return brushsvg::find_originals(points_mm,
                                    [&](std::size_t k, std::size_t j) { return are_alike(shapes[k], shapes[j]); });
}

/// Move the result for the original of a shape to the shape.
SearchedShape moved_to(const PaintedShape& shape, SearchedShape found, const Vector2d& displacement_mm) {
    const auto move_stroke = [&](Stroke& stroke) {
        move(stroke.middle_mm, displacement_mm);
        move(stroke.target_mm, displacement_mm);
    };
    for (std::size_t k = 0; k < found.strokes.size(); ++k) {
        if (!found.changed[k]) {
            found.strokes[k] = {shape.strokes[k]};
            continue;
        }
        for (Stroke& stroke : found.strokes[k]) {
            move_stroke(stroke);
            stroke.id = shape.strokes[k].id;
            stroke.layer = shape.strokes[k].layer;
            stroke.colour = shape.strokes[k].colour;
            Settings settings = shape.strokes[k].settings;
            settings.start = stroke.settings.start;
            settings.end = stroke.settings.end;
            stroke.settings = settings;
        }
    }
    for (AddedStroke& added : found.added) {
        move_stroke(added.stroke);
        move(added.area_mm, displacement_mm);
        move(added.mark_mm, displacement_mm);
    }
    return found;
}

}  // namespace

std::vector<SearchedShape> search_strokes(const std::vector<PaintedShape>& shapes, const Brush& brush,
                                          const ObjectiveWeights& weights, bool are_free) {
    check(weights);
    const std::vector<Original> originals = find_originals(shapes);
    std::vector<SearchedShape> found(shapes.size());
    parallel_for(0, shapes.size(), [&](std::size_t k) {
        if (originals[k].index == k) found[k] = Search(shapes[k], brush, weights).run(shapes[k].strokes, are_free);
    });
    for (std::size_t k = 0; k < shapes.size(); ++k)
        if (originals[k].index != k)
            found[k] = moved_to(shapes[k], found[originals[k].index], originals[k].displacement_mm);
    return found;
}

std::vector<std::vector<UncoveredArea>> uncovered_areas(const std::vector<PaintedShape>& shapes, const Brush& brush,
                                                        double min_share) {
    require_within(min_share, {0.0, 1.0}, "the least share of a shape's area");
    std::vector<std::vector<UncoveredArea>> found(shapes.size());
    const ObjectiveWeights weights;
    parallel_for(0, shapes.size(), [&](std::size_t k) {
        found[k] = Search(shapes[k], brush, weights).find_uncovered(min_share * area(shapes[k].target_mm));
    });
    return found;
}

}  // namespace brushsvg
