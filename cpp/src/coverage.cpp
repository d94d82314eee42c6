#include "brushsvg/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "sweep.hpp"

namespace brushsvg {
namespace {

// exact along x, sampled along y: 4 bands a pixel leave a mean edge error of 0.03 px, 2 bands twice that
constexpr int kLinesPerPixel = 4;
// a picture of more would not fit into most memories; finer pixels tell nothing of paint
constexpr double kMostPixels = 4e8;
constexpr std::array<double, 2> kPxPerMm{1e-6, 1e6};
constexpr double kFarthestMm = 1e7;
// what is left of sums in single precision where nothing is painted
constexpr float kRounding = 1e-6f;

std::array<Eigen::Index, 2> picture_size(const Window& window, double px_per_mm) {
    const double w = std::ceil(window.width_mm * px_per_mm - 1e-9), h = std::ceil(window.height_mm * px_per_mm - 1e-9);
    if (!(px_per_mm >= kPxPerMm[0] && px_per_mm <= kPxPerMm[1] && w >= 1.0 && h >= 1.0 && w * h <= kMostPixels &&
          std::abs(window.x_mm) <= kFarthestMm && std::abs(window.y_mm) <= kFarthestMm)) {
        char text[120];
        std::snprintf(text, sizeof text, "a picture of %.0f x %.0f px cannot be made", w, h);
        throw Error("picture-size", text);
    }
    return {Eigen::Index(w), Eigen::Index(h)};
}

void require_finite(const Rings& rings) {
    for (const Ring& ring : rings)
        if (ring.rows() > 0 && !(ring.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kFarthestMm))
            throw Error("geometry-out-of-range", "a ring has a coordinate that is not finite, or beyond 1e7 mm");
}

/// Union of horizontal spans on sub-scanlines, in pixels, then coverage.
class Spans {
 public:
    Spans(const Window& window, double px_per_mm) : window_(window), scale_(px_per_mm) {
        const auto [width, height] = picture_size(window, px_per_mm);
        width_ = width;
        height_ = height;
        lo_.assign(height_ * kLinesPerPixel, std::numeric_limits<float>::infinity());
        hi_.assign(height_ * kLinesPerPixel, -std::numeric_limits<float>::infinity());
    }

    void convex_pair(const Ring& a, const Ring& b) {
        checkpoint(5);
        if (&a == &b) {
            chains(a, nullptr);
        } else {
            chains(a, &b);
        }
    }

    /// Any polygon, non-zero winding.
    void polygon(const Rings& rings) {
        checkpoint(20);
        struct Crossing {
            int line;
            double x;
            int winding;
        };
        std::vector<Crossing> crossings;
        for (const Ring& ring : rings)
            for (Eigen::Index i = 0, n = ring.rows(); i < n; ++i) {
                const Eigen::Index j = i + 1 == n ? 0 : i + 1;
                double x0 = to_x(ring(i, 0)), y0 = to_y(ring(i, 1)), x1 = to_x(ring(j, 0)), y1 = to_y(ring(j, 1));
                const int winding = y0 < y1 ? 1 : -1;
                if (y0 > y1) std::swap(x0, x1), std::swap(y0, y1);
                const int first = std::max(0, first_line(y0)), last = std::min(lines(), first_line(y1));
                for (int line = first; line < last; ++line)
                    crossings.push_back({line, x0 + (x1 - x0) * (line + 0.5 - y0) / (y1 - y0), winding});
            }
        std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
            return a.line < b.line || (a.line == b.line && a.x < b.x);
        });
        int winding = 0;
        double from = 0.0;
        for (const Crossing& c : crossings) {
            if (winding == 0) from = c.x;
            winding += c.winding;
            if (winding == 0) add(c.line, float(from), float(c.x));
        }
    }

    Coverage coverage() {
        const auto by_place = [](const Span& a, const Span& b) {
            return a.line < b.line || (a.line == b.line && a.lo < b.lo);
        };
        std::sort(more_.begin(), more_.end(), by_place);
        std::sort(parts_.begin(), parts_.end(), by_place);
        Coverage out(height_, width_);
        std::vector<float> steps(width_ + 2, 0.0f);
        std::vector<Eigen::Index> changes;  // pixels whose step may differ from zero
        std::size_t next = 0, next_part = 0;
        std::vector<Span> here, parts;
        for (Eigen::Index row = 0; row < height_; ++row) {
            checkpoint(20);
            changes.clear();
            for (int line = int(row) * kLinesPerPixel; line < int(row + 1) * kLinesPerPixel; ++line) {
                here.clear();
                parts.clear();
                if (lo_[line] < hi_[line]) here.push_back({line, lo_[line], hi_[line]});
                for (; next < more_.size() && more_[next].line == line; ++next) here.push_back(more_[next]);
                for (; next_part < parts_.size() && parts_[next_part].line == line; ++next_part)
                    parts.push_back(parts_[next_part]);
                merge(here);
                if (!parts.empty()) outside(here, parts);
                for (const Span& span : here)
                    for (const auto& [x, sign] : {std::pair(span.lo, 1.0f), std::pair(span.hi, -1.0f)}) {
                        const Eigen::Index i = step(steps, x, sign * span.height / kLinesPerPixel);
                        changes.insert(changes.end(), {i, i + 1});
                    }
            }
            std::sort(changes.begin(), changes.end());
            changes.erase(std::unique(changes.begin(), changes.end()), changes.end());
            float sum = 0.0f;
            float* const pixels = out.row(row).data();
            Eigen::Index x = 0;
            const auto fill_until = [&](Eigen::Index end) {
                std::fill(pixels + x, pixels + end, sum > kRounding ? std::min(1.0f, sum) : 0.0f);
                x = end;
            };
            for (const Eigen::Index change : changes) {
                fill_until(std::min(change, width_));
                sum += std::exchange(steps[change], 0.0f);
            }
            fill_until(width_);
        }
        return out;
    }

 private:
    struct Span {
        int line;
        float lo, hi;
        float height = 1.0f;  ///< of the band
        bool hangs = false;   ///< a part of a band: from its upper side
    };
    struct Point {
        double x, y;
    };

    /// Union of spans of full height.
    static void merge(std::vector<Span>& spans) {
        if (spans.size() < 2) return;
        std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) { return a.lo < b.lo; });
        std::size_t last = 0;
        for (std::size_t k = 1; k < spans.size(); ++k) {
            if (spans[k].lo <= spans[last].hi)
                spans[last].hi = std::max(spans[last].hi, spans[k].hi);
            else
                spans[++last] = spans[k];
        }
        spans.resize(last + 1);
    }

    /// Adds to disjoint full spans what parts of the band paint beside them: at every x the highest part that stands on
    /// the band's lower side and the longest that hangs from its upper one.
    void outside(std::vector<Span>& full, const std::vector<Span>& parts) {
        edges_.clear();
        for (const Span& s : full) edges_.insert(edges_.end(), {s.lo, s.hi});
        for (const Span& s : parts) edges_.insert(edges_.end(), {s.lo, s.hi});
        std::sort(edges_.begin(), edges_.end());
        const std::size_t fulls = full.size();
        for (std::size_t k = 0; k + 1 < edges_.size(); ++k) {
            const float lo = edges_[k], hi = edges_[k + 1];
            if (!(lo < hi)) continue;
            const auto holds = [&](const Span& s) { return s.lo <= lo && s.hi >= hi; };
            if (std::any_of(full.begin(), full.begin() + fulls, holds)) continue;
            float standing = 0.0f, hanging = 0.0f;
            for (const Span& s : parts)
                if (holds(s)) (s.hangs ? hanging : standing) = std::max(s.hangs ? hanging : standing, s.height);
            if (standing + hanging > 0.0f) full.push_back({0, lo, hi, std::min(1.0f, standing + hanging), false});
        }
    }

    double to_x(double x_mm) const { return (x_mm - window_.x_mm) * scale_; }
    double to_y(double y_mm) const { return (window_.y_mm + window_.height_mm - y_mm) * scale_ * kLinesPerPixel; }
    int lines() const { return int(height_) * kLinesPerPixel; }
    /// First sub-scanline whose centre is at or below y.
    static int first_line(double y) { return int(std::ceil(std::clamp(y, -1e9, 1e9) - 0.5)); }

    /// Coverage from x to the right end, as differences between neighbouring pixels: of the one returned and the next.
    Eigen::Index step(std::vector<float>& steps, float x, float weight) const {
        x = std::clamp(x, 0.0f, float(width_));
        const auto i = std::size_t(x);
        const float within = x - float(i);
        steps[i] += weight * (1.0f - within);
        steps[i + 1] += weight * within;
        return Eigen::Index(i);
    }

    void add(int line, float lo, float hi) {
        if (!(lo < hi)) return;
        if (lo <= hi_[line] && hi >= lo_[line]) {
            lo_[line] = std::min(lo_[line], lo);
            hi_[line] = std::max(hi_[line], hi);
        } else {
            if (lo_[line] < hi_[line]) more_.push_back({line, lo_[line], hi_[line]});
            lo_[line] = lo;
            hi_[line] = hi;
        }
    }

    /// Spans of the lines from `first` on, one each. Where all touch what is there, which is the rule along a stroke,
    /// the loops have no branch and run several lines at a time.
    void add(int first, const std::vector<float>& lo, const std::vector<float>& hi) {
        float* const all_lo = lo_.data() + first;
        float* const all_hi = hi_.data() + first;
        const std::size_t n = lo.size();
        int apart = 0;
        for (std::size_t k = 0; k < n; ++k)
            apart |= int(!(lo[k] < hi[k])) | int(!(lo[k] <= all_hi[k])) | int(!(hi[k] >= all_lo[k]));
        if (apart) {
            for (std::size_t k = 0; k < n; ++k) add(first + int(k), lo[k], hi[k]);
            return;
        }
        for (std::size_t k = 0; k < n; ++k) {
            all_lo[k] = lo[k] < all_lo[k] ? lo[k] : all_lo[k];
            all_hi[k] = hi[k] > all_hi[k] ? hi[k] : all_hi[k];
        }
    }

    /// Splits a convex counter-clockwise ring (y up) at its highest and lowest vertex into its left and right chain,
    /// both from the top down in pixels.
    void split(const Ring& ring, std::vector<Point>& left, std::vector<Point>& right) const {
        const Eigen::Index n = ring.rows();
        Eigen::Index top, bottom;
        ring.col(1).maxCoeff(&top);
        ring.col(1).minCoeff(&bottom);
        left.clear();
        right.clear();
        for (Eigen::Index k = top;; k = k + 1 == n ? 0 : k + 1) {  // counter-clockwise from the top: the left side
            left.push_back({to_x(ring(k, 0)), to_y(ring(k, 1))});
            if (k == bottom) break;
        }
        for (Eigen::Index k = top;; k = k == 0 ? n - 1 : k - 1) {
            right.push_back({to_x(ring(k, 0)), to_y(ring(k, 1))});
            if (k == bottom) break;
        }
    }

    /// Hull of one side of two shapes: `sign` 1 keeps the points farthest left, -1 farthest right.
    static void side(const std::vector<Point>& a, const std::vector<Point>& b, double sign, std::vector<Point>& hull) {
        hull.clear();
        std::size_t i = 0, j = 0;
        while (i < a.size() || j < b.size()) {
            const bool take_a = j == b.size() || (i < a.size() && a[i].y <= b[j].y);
            const Point c = take_a ? a[i++] : b[j++];
            while (hull.size() > 1) {
                const Point &p = hull[hull.size() - 2], &q = hull.back();
                if (sign * ((q.x - p.x) * (c.y - q.y) - (q.y - p.y) * (c.x - q.x)) < 0.0) break;
                hull.pop_back();
            }
            hull.push_back(c);
        }
    }

    void chains(const Ring& a, const Ring* b) {
        split(a, left_a_, right_a_);
        left_b_.clear();
        right_b_.clear();
        if (b) split(*b, left_b_, right_b_);
        side(left_a_, left_b_, 1.0, left_);
        side(right_a_, right_b_, -1.0, right_);
        // bands covered over their whole height count by their middle line, the two cut by the top and the bottom of
        // the shape by the part covered: without them a horizontal edge would be off by half a band
        const double top = std::clamp(left_.front().y, -1.0, double(lines()) + 1.0);
        const double bottom = std::clamp(left_.back().y, -1.0, double(lines()) + 1.0);
        const int full = int(std::ceil(top)), cut = int(std::floor(bottom));
        if (full > cut) {
            part(top, bottom, false);
            return;
        }
        part(top, full, false);
        part(cut, bottom, true);
        const int first = std::max(0, full), last = std::min(lines(), cut);
        if (first >= last) return;
        walk(left_, first, last, lo_here_);
        walk(right_, first, last, hi_here_);
        add(first, lo_here_, hi_here_);
    }

    static double x_at(const std::vector<Point>& chain, double y) {
        for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
            const Point &p = chain[k], &q = chain[k + 1];
            if (y <= q.y && q.y > p.y) return p.x + (q.x - p.x) * std::clamp((y - p.y) / (q.y - p.y), 0.0, 1.0);
        }
        return chain.back().x;
    }
    /// A piece of one band, from y0 down to y1; `hangs` from the band's upper side, or else stands on its lower one.
    void part(double y0, double y1, bool hangs) {
        const double middle = 0.5 * (y0 + y1);
        const int line = int(std::floor(middle));
        if (!(y1 > y0) || line < 0 || line >= lines()) return;
        const auto lo = float(x_at(left_, middle)), hi = float(x_at(right_, middle));
        if (lo < hi) parts_.push_back({line, lo, hi, float(y1 - y0), hangs});
    }

    /// Where a chain is at the middle of each of the lines from `first` to before `last`.
    static void walk(const std::vector<Point>& chain, int first, int last, std::vector<float>& xs) {
        xs.resize(last - first);
        int line = first;
        for (std::size_t k = 0; k + 1 < chain.size() && line < last; ++k) {
            const Point &p = chain[k], &q = chain[k + 1];
            const int until = std::min(last, first_line(q.y)), n = until - line;
            if (n <= 0) continue;
            const double slope = (q.x - p.x) / (q.y - p.y), x = p.x + (line + 0.5 - p.y) * slope;
            float* const at = xs.data() + (line - first);
            for (int j = 0; j < n; ++j) at[j] = float(x + j * slope);
            line = until;
        }
    }

    Window window_;
    double scale_;
    Eigen::Index width_ = 0, height_ = 0;
    std::vector<float> lo_, hi_;
    std::vector<Span> more_, parts_;
    std::vector<Point> left_a_, right_a_, left_b_, right_b_, left_, right_;
    std::vector<float> lo_here_, hi_here_, edges_;
};

}  // namespace

Coverage coverage(const Marks& marks, const Brush& brush, const Window& window, double px_per_mm) {
    Spans spans(window, px_per_mm);
    for (const PassMarks& pass : marks.passes)
        sweep(
            pass, brush, [&](const Ring& a, const Ring& b) { spans.convex_pair(a, b); },
            [&](const Ring& ring) { spans.polygon({ring}); },
            [&](const Ring& piece) { spans.convex_pair(piece, piece); });
    return spans.coverage();
}

Coverage coverage(const Rings& rings, const Window& window, double px_per_mm) {
    const std::array<Eigen::Index, 2> size = picture_size(window, px_per_mm);
    const Eigen::Index width = size[0], height = size[1];  // names of their own: clang 14 captures no bindings
    require_finite(rings);
    // exact: every edge leaves in each pixel it crosses the area to its right, and its height in all pixels beyond
    Eigen::MatrixXd edge = Eigen::MatrixXd::Zero(width + 2, height);                 // one column per pixel row
    const auto add = [&](double x0, double y0, double x1, double y1, double sign) {  // within one pixel row
        const auto row = Eigen::Index(std::floor(0.5 * (y0 + y1)));
        if (row < 0 || row >= height) return;
        if (x0 > x1) std::swap(x0, x1);
        const double dy = sign * (y1 - y0), w = double(width);
        x0 = std::clamp(x0, 0.0, w);
        x1 = std::clamp(x1, 0.0, w);
        const auto first = Eigen::Index(x0), last = Eigen::Index(x1);
        if (x1 - x0 < 1e-12) {
            edge(first, row) += dy * (first + 1 - x0);
            edge(first + 1, row) += dy * (x0 - first);
            return;
        }
        for (Eigen::Index k = first; k <= last; ++k) {
            const double a = std::max(x0, double(k)), b = std::min(x1, double(k + 1));
            const double part = dy * (b - a) / (x1 - x0), middle = 0.5 * (a + b) - double(k);
            edge(k, row) += part * (1.0 - middle);
            edge(k + 1, row) += part * middle;
        }
    };
    for (const Ring& ring : rings)
        for (Eigen::Index i = 0, n = ring.rows(); i < n; ++i) {
            const Eigen::Index j = i + 1 == n ? 0 : i + 1;
            double x0 = (ring(i, 0) - window.x_mm) * px_per_mm, x1 = (ring(j, 0) - window.x_mm) * px_per_mm;
            double y0 = (window.y_mm + window.height_mm - ring(i, 1)) * px_per_mm;
            double y1 = (window.y_mm + window.height_mm - ring(j, 1)) * px_per_mm;
            const double sign = y0 < y1 ? 1.0 : -1.0;
            if (y0 > y1) std::swap(x0, x1), std::swap(y0, y1);
            if (!(y1 > y0) || y1 <= 0.0 || y0 >= double(height)) continue;
            const double slope = (x1 - x0) / (y1 - y0);
            if (!std::isfinite(slope)) continue;
            const double top = std::max(y0, 0.0), bottom = std::min(y1, double(height));
            for (double y = top; y < bottom;) {
                checkpoint();
                const double until = std::min(bottom, std::floor(y) + 1.0);
                // a clipped row in x may bend the edge at the window's side: what lies beyond it does not show
                add(x0 + (y - y0) * slope, y, x0 + (until - y0) * slope, until, sign);
                y = until;
            }
        }
    Coverage out(height, width);
    for (Eigen::Index row = 0; row < height; ++row) {
        checkpoint(1 + int(width / 50));
        double sum = 0.0;
        for (Eigen::Index x = 0; x < width; ++x) {
            sum += edge(x, row);
            out(row, x) = float(std::clamp(std::abs(sum), 0.0, 1.0));
        }
    }
    return out;
}

Coverage coverage_of_pieces(const Rings& convex, const Window& window, double px_per_mm) {
    require_finite(convex);
    Spans spans(window, px_per_mm);
    for (const Ring& piece : convex) {
        if (piece.rows() == 0) continue;
        spans.convex_pair(piece, piece);
    }
    return spans.coverage();
}

Rings outline(const PassMarks& pass, const Brush& brush) {
    Rings swept, chain;
    const auto keep = [&](const Ring& ring) {
        if (ring.rows() > 2) swept.push_back(ring);
    };
    const auto end_chain = [&] {
        for (const Ring& piece : pieces_between(chain)) keep(piece);
        chain.clear();
    };
    sweep(
        pass, brush,
        [&](const Ring& a, const Ring& b) {
            if (&a == &b) end_chain();  // set down, or turned over at once
            chain.push_back(b);
        },
        keep, keep);
    end_chain();
    return unite(swept);
}

std::array<double, 4> painted_bounds(const PassMarks& marks, const Brush& brush) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    std::array<double, 4> box{inf, inf, -inf, -inf};
    const auto include = [&](const Ring& ring) {
        box = {std::min(box[0], ring.col(0).minCoeff()), std::min(box[1], ring.col(1).minCoeff()),
               std::max(box[2], ring.col(0).maxCoeff()), std::max(box[3], ring.col(1).maxCoeff())};
    };
    sweep(marks, brush, [&](const Ring&, const Ring& b) { include(b); }, include, [](const Ring&) {});
    return box;
}

}  // namespace brushsvg
