#include "marks/rasterizer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/format_text.hpp"
#include "base/parallel.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "values/require_usable.hpp"

namespace brushsvg {
namespace {

// a larger picture would not fit into most memories; finer pixels show no more of the paint
constexpr double kMaxPixels = 4e8;
constexpr std::array<double, 2> kPxPerMmRange{1e-6, 1e6};
// rounding error of sums in single precision where nothing is painted
constexpr float kRoundingShare = 1e-6f;
constexpr Eigen::Index kPixelsPerPart = 1 << 18;  // size of a part of a picture that one processor makes

}  // namespace

std::array<Eigen::Index, 2> picture_size(const Window& window, double px_per_mm) {
    const auto refuse = [](const char* pattern, auto... numbers) {
        throw Error("picture-size", format_text(pattern, numbers...));
    };
    if (!(px_per_mm >= kPxPerMmRange[0] && px_per_mm <= kPxPerMmRange[1]))
        refuse("the scale of the picture, %g px/mm, is outside the range [%g, %g] px/mm", px_per_mm, kPxPerMmRange[0],
               kPxPerMmRange[1]);
    if (!(std::abs(window.x_mm) <= kMaxPaintedCoordinateMm && std::abs(window.y_mm) <= kMaxPaintedCoordinateMm))
        refuse("the corner of the picture, (%g, %g) mm, is outside the range [-%g, %g] mm", window.x_mm, window.y_mm,
               kMaxPaintedCoordinateMm, kMaxPaintedCoordinateMm);
    const double w = std::ceil(window.width_mm * px_per_mm - 1e-9), h = std::ceil(window.height_mm * px_per_mm - 1e-9);
    if (!(w >= 1.0 && h >= 1.0 && w * h <= kMaxPixels))
        refuse(
            "the picture would have %.10g x %.10g px, but must have at least 1 x 1 and at most %g in total: change the "
            "window or the scale",
            w, h, kMaxPixels);
    return {Eigen::Index(w), Eigen::Index(h)};
}

Rasterizer::Rasterizer(const Window& window, double px_per_mm) : window_(window), scale_(px_per_mm) {
    const auto [width, height] = picture_size(window, px_per_mm);
    width_ = width;
    height_ = height;
    lo_.assign(height_ * kLinesPerPixel, std::numeric_limits<float>::infinity());
    hi_.assign(height_ * kLinesPerPixel, -std::numeric_limits<float>::infinity());
}

bool Rasterizer::is_outside(const Eigen::RowVector2d& low, const Eigen::RowVector2d& high) const {
    return to_x(high.x()) <= 0.0 || to_x(low.x()) >= double(width_) || to_y(low.y()) <= 0.0 ||
           to_y(high.y()) >= double(lines());
}

void Rasterizer::convex_pair(const Ring& a, const Ring& b) {
    checkpoint(5);
    if (is_outside(a.colwise().minCoeff().cwiseMin(b.colwise().minCoeff()),
                   a.colwise().maxCoeff().cwiseMax(b.colwise().maxCoeff())))
        return;
    if (&a == &b) {
        chains(a, nullptr);
    } else {
        chains(a, &b);
    }
}

void Rasterizer::polygon(const Rings& rings) {
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
    std::sort(crossings.begin(), crossings.end(),
              [](const Crossing& a, const Crossing& b) { return a.line < b.line || (a.line == b.line && a.x < b.x); });
    int winding = 0;
    double from = 0.0;
    for (const Crossing& c : crossings) {
        if (winding == 0) from = c.x;
        winding += c.winding;
        if (winding == 0) add(c.line, float(from), float(c.x));
    }
}

void Rasterizer::add_shapes_of(const Rasterizer& other) {
    for (int line = 0; line < lines(); ++line) add(line, other.lo_[line], other.hi_[line]);
    extra_spans_.insert(extra_spans_.end(), other.extra_spans_.begin(), other.extra_spans_.end());
    parts_.insert(parts_.end(), other.parts_.begin(), other.parts_.end());
}

Coverage Rasterizer::coverage() {
    const auto by_place = [](const Span& a, const Span& b) {
        return a.line < b.line || (a.line == b.line && a.lo < b.lo);
    };
    std::sort(extra_spans_.begin(), extra_spans_.end(), by_place);
    std::sort(parts_.begin(), parts_.end(), by_place);
    Coverage out(height_, width_);
    const Eigen::Index at_once = std::max<Eigen::Index>(1, kPixelsPerPart / width_);
    parallel_for(0, std::size_t((height_ + at_once - 1) / at_once), [&](std::size_t k) {
        rows(Eigen::Index(k) * at_once, std::min(height_, Eigen::Index(k + 1) * at_once), out);
    });
    return out;
}

void Rasterizer::rows(Eigen::Index first, Eigen::Index last, Coverage& out) const {
    std::vector<float> steps(width_ + 2, 0.0f);
    std::vector<Eigen::Index> changes;  // pixels whose step may differ from zero
    const auto begin_of = [&](const std::vector<Span>& spans) {
        const auto is_above = [](const Span& span, int line) { return span.line < line; };
        const int line = int(first) * kLinesPerPixel;
        return std::size_t(std::lower_bound(spans.begin(), spans.end(), line, is_above) - spans.begin());
    };
    std::size_t next = begin_of(extra_spans_), next_part = begin_of(parts_);
    std::vector<Span> here, parts;
    for (Eigen::Index row = first; row < last; ++row) {
        checkpoint(20);
        changes.clear();
        for (int line = int(row) * kLinesPerPixel; line < int(row + 1) * kLinesPerPixel; ++line) {
            here.clear();
            parts.clear();
            if (lo_[line] < hi_[line]) here.push_back({line, lo_[line], hi_[line]});
            for (; next < extra_spans_.size() && extra_spans_[next].line == line; ++next)
                here.push_back(extra_spans_[next]);
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
            std::fill(pixels + x, pixels + end, sum > kRoundingShare ? std::min(1.0f, sum) : 0.0f);
            x = end;
        };
        for (const Eigen::Index change : changes) {
            fill_until(std::min(change, width_));
            sum += std::exchange(steps[change], 0.0f);
        }
        fill_until(width_);
    }
}

void Rasterizer::merge(std::vector<Span>& spans) {
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

void Rasterizer::outside(std::vector<Span>& full, const std::vector<Span>& parts) {
    std::vector<float> edges;
    for (const Span& s : full) edges.insert(edges.end(), {s.lo, s.hi});
    for (const Span& s : parts) edges.insert(edges.end(), {s.lo, s.hi});
    std::sort(edges.begin(), edges.end());
    const std::size_t fulls = full.size();
    for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
        const float lo = edges[k], hi = edges[k + 1];
        if (!(lo < hi)) continue;
        const auto holds = [&](const Span& s) { return s.lo <= lo && s.hi >= hi; };
        if (std::any_of(full.begin(), full.begin() + fulls, holds)) continue;
        float standing = 0.0f, hanging = 0.0f;
        for (const Span& s : parts)
            if (holds(s)) (s.hangs ? hanging : standing) = std::max(s.hangs ? hanging : standing, s.height);
        if (standing + hanging > 0.0f) full.push_back({0, lo, hi, std::min(1.0f, standing + hanging), false});
    }
}

Eigen::Index Rasterizer::step(std::vector<float>& steps, float x, float weight) const {
    x = std::clamp(x, 0.0f, float(width_));
    const auto i = std::size_t(x);
    const float within = x - float(i);
    steps[i] += weight * (1.0f - within);
    steps[i + 1] += weight * within;
    return Eigen::Index(i);
}

void Rasterizer::add(int line, float lo, float hi) {
    if (!(lo < hi)) return;
    if (lo <= hi_[line] && hi >= lo_[line]) {
        lo_[line] = std::min(lo_[line], lo);
        hi_[line] = std::max(hi_[line], hi);
    } else {
        if (lo_[line] < hi_[line]) extra_spans_.push_back({line, lo_[line], hi_[line]});
        lo_[line] = lo;
        hi_[line] = hi;
    }
}

void Rasterizer::add(int first, const std::vector<float>& lo, const std::vector<float>& hi) {
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

void Rasterizer::split(const Ring& ring, std::vector<Point>& left, std::vector<Point>& right) const {
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

void Rasterizer::side(const std::vector<Point>& a, const std::vector<Point>& b, double sign, std::vector<Point>& hull) {
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

void Rasterizer::chains(const Ring& a, const Ring* b) {
    split(a, left_a_, right_a_);
    left_b_.clear();
    right_b_.clear();
    if (b) split(*b, left_b_, right_b_);
    side(left_a_, left_b_, 1.0, left_);
    side(right_a_, right_b_, -1.0, right_);
    // bands that are covered over their whole height count by their middle line; the bands at the top and the bottom of
    // the shape count by the covered part: otherwise a horizontal edge would be off by half a band
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

double Rasterizer::x_at(const std::vector<Point>& chain, double y) {
    for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
        const Point &p = chain[k], &q = chain[k + 1];
        if (y <= q.y && q.y > p.y) return p.x + (q.x - p.x) * std::clamp((y - p.y) / (q.y - p.y), 0.0, 1.0);
    }
    return chain.back().x;
}

void Rasterizer::part(double y0, double y1, bool hangs) {
    const double middle = 0.5 * (y0 + y1);
    const int line = int(std::floor(middle));
    if (!(y1 > y0) || line < 0 || line >= lines()) return;
    const auto lo = float(x_at(left_, middle)), hi = float(x_at(right_, middle));
    if (lo < hi) parts_.push_back({line, lo, hi, float(y1 - y0), hangs});
}

void Rasterizer::walk(const std::vector<Point>& chain, int first, int last, std::vector<float>& xs) {
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

}  // namespace brushsvg
