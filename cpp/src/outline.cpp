#include "outline.hpp"

#include <cmath>
#include <numeric>
#include <utility>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector2i;

bool is_behind(const Foot& from, const Foot& to) {
    return to.edge < from.edge || (to.edge == from.edge && to.at < from.at);
}

/// How far corners at one place are moved apart: beyond what counts as nothing, and far below what is seen.
constexpr double kApart = 40.0;  // units

/// Where a corner that touches another one goes: into the smaller of its two angles, which nothing else reaches into.
Vector2i apart(const Vector2d& before, const Vector2d& at, const Vector2d& after) {
    const Vector2d in = (before - at).normalized(), out = (after - at).normalized();
    Vector2d into = in + out;
    if (into.norm() < 1e-6) into = Vector2d(-out.y(), out.x());
    return (at + kApart * into.normalized()).array().round().matrix().cast<int>();
}

}  // namespace

Outline::Outline(const Rings& rings) {
    for (const Ring& ring : rings) {
        std::vector<Vector2i> points;
        for (Index i = 0; i < ring.rows(); ++i) {
            const Vector2d p = kUnitsPerMm * ring.row(i).transpose();
            if (!(p.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() < 2e9))
                throw Error("geometry-out-of-range", "a ring reaches beyond 20 m");
            const Vector2i point(int(std::lround(p.x())), int(std::lround(p.y())));
            if (points.empty() || points.back() != point) points.push_back(point);
        }
        while (points.size() > 1 && points.front() == points.back()) points.pop_back();
        if (points.size() < 3) continue;
        const std::size_t first = starts_.size();
        starts_.insert(starts_.end(), points.begin(), points.end());
        ring_of_.resize(starts_.size(), rings_.size());
        rings_.push_back({first, starts_.size()});
    }
    move_apart();
    twice_area_.push_back(0.0);
    for (std::size_t k = 0; k < edges(); ++k) twice_area_.push_back(twice_area_.back() + cross(start(k), end(k)));
}

void Outline::move_apart() {
    std::vector<std::size_t> order(edges());
    std::iota(order.begin(), order.end(), std::size_t(0));
    const auto is_before = [this](std::size_t a, std::size_t b) {
        return std::make_pair(starts_[a].x(), starts_[a].y()) < std::make_pair(starts_[b].x(), starts_[b].y());
    };
    std::sort(order.begin(), order.end(), is_before);
    const std::vector<Vector2i> as_given = starts_;
    const auto place = [&](std::size_t k) -> Vector2d { return as_given[k].cast<double>(); };
    for (std::size_t i = 0; i < order.size(); ++i) {
        const std::size_t k = order[i];
        const bool touches = (i > 0 && as_given[order[i - 1]] == as_given[k]) ||
                             (i + 1 < order.size() && as_given[order[i + 1]] == as_given[k]);
        if (touches) starts_[k] = apart(place(before(k)), place(k), place(after(k)));
    }
}

double Outline::twice_area(const Foot& from, const Foot& to) const {
    if (!same_ring(from, to)) return cross(at(from), at(to));
    const auto up_to = [this](const Foot& f) { return twice_area_[f.edge] + cross(start(f.edge), at(f)); };
    double sum = up_to(to) - up_to(from);
    if (is_behind(from, to)) {
        const Span& whole = rings_[ring_of_[from.edge]];
        sum += twice_area_[whole.last] - twice_area_[whole.first];
    }
    return sum;
}

void Outline::walk(const Foot& from, const Foot& to, bool round, std::vector<Vector2d>& out) const {
    out.push_back(at(from));
    // the two ends of nothing may come in the wrong order, by rounding
    const bool is_near = (at(from) - at(to)).norm() < kNothing;
    const bool is_far = is_near ? round : from.edge != to.edge || is_behind(from, to);
    if (same_ring(from, to) && is_far) {
        std::size_t k = from.edge;
        do {
            checkpoint();
            out.push_back(end(k));
            k = after(k);
        } while (k != to.edge);
    }
    out.push_back(at(to));
}

Ring Outline::ring(std::size_t k) const {
    const auto& [first, last] = rings_[ring_of_[k]];
    Ring whole(Index(last - first), 2);
    for (std::size_t i = first; i < last; ++i) whole.row(Index(i - first)) = start(i).transpose() / kUnitsPerMm;
    return whole;
}

}  // namespace brushsvg
