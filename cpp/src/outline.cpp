#include "outline.hpp"

#include <cmath>

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

}  // namespace

Outline::Outline(const Rings& rings) {
    for (const Ring& ring : rings) {
        std::vector<Vector2i> points;
        for (Index i = 0; i < ring.rows(); ++i) {
            const Vector2d p = kUnitsPerMm * ring.row(i).transpose();
            if (!(p.cwiseAbs().maxCoeff() < 2e9)) throw Error("geometry-out-of-range", "a ring reaches beyond 20 m");
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
    twice_area_.push_back(0.0);
    for (std::size_t k = 0; k < edges(); ++k) twice_area_.push_back(twice_area_.back() + cross(start(k), end(k)));
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
