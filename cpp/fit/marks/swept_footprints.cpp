#include "swept_footprints.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>

#include "trace.hpp"

namespace brushsvg::fit {
namespace {

// Where the TCP passes a loose brush, the footprint turns around within tenths of a mm of the path. With instants
// further apart, the edge of the swept area would be off, by 0.3 mm on a reversal.
constexpr double kMaxFootprintStepMm = 0.25;
constexpr int kMaxParts = 200, kMaxRounds = 4, kMaxTangentRounds = 6;
// Limits of the instants of one pass. Real brushes need less than one per place, and 1,500 for the largest footprint
// that turns around. Laws with footprints of half a metre, which a solver tries for marks that no brush paints, needed
// a million.
constexpr std::size_t kMaxInstants = 5000, kMaxInstantsPerPlace = 10;
// Cost of following a pass to the next instant, in evaluations of instants.
constexpr std::uint64_t kEvaluationsPerStep = 20;
// Least cosine between the normal of a footprint and the normal of a tangent.
constexpr double kMinTangentCosine = 0.05;

// Numbers with derivatives by the lag's unknowns and the height, and by the machine's errors. The number of derivatives
// is even, because processors compute two at a time.
constexpr int round_up_to_even(int n) { return n + n % 2; }
using Jet = ceres::Jet<double, round_up_to_even(kMaxTerms + 1)>;
using MachineJet = ceres::Jet<double, round_up_to_even(kMaxTerms + 1 + MachineIndex::field)>;
using FieldJet = ceres::Jet<double, round_up_to_even(kPathUnknowns)>;

double at_depth(const std::vector<double>& c, double d) {
    double y = 0.0;
    for (std::size_t i = c.size(); i-- > 0;) y = y * d + c[i];
    return y;
}
double slope_at_depth(const std::vector<double>& c, double d) {
    double y = 0.0;
    for (std::size_t i = c.size(); i-- > 1;) y = y * d + double(i) * c[i];
    return y;
}
void ratio_at_depth(const std::vector<double>& c, double constant, double d, double& ratio, double& slope) {
    ratio = c.empty() ? constant : at_depth(c, d);
    slope = c.empty() || ratio <= kMinRatio ? 0.0 : slope_at_depth(c, d);
    ratio = std::max(kMinRatio, ratio);
}

template <int N>
PathDerivatives path_derivatives(const Vec2<ceres::Jet<double, N>>& from) {
    constexpr int n = std::min(N, kPathUnknowns);
    PathDerivatives out = PathDerivatives::Zero();
    for (int i = 0; i < 2; ++i) out.row(i).head<n>() = from[i].v.template head<n>().transpose();
    return out;
}
template <int N>
void store_depth_derivatives(const ceres::Jet<double, N>& depth, Eigen::Matrix<double, 1, 1 + kMachineErrors>& by) {
    constexpr int n = std::min(N, kPathUnknowns) - kMaxTerms;
    by.setZero();
    by.template head<n>() = depth.v.template segment<n>(kMaxTerms).transpose();
}

template <class T>
std::vector<T> differentiable_law(const std::vector<double>& lag, const Eigen::MatrixXd& by) {
    std::vector<T> out;
    for (std::size_t i = 0; i < lag.size(); ++i) {
        out.emplace_back(lag[i]);
        out[i].v.head(by.cols()) = by.row(Eigen::Index(i)).transpose();
    }
    return out;
}

RealisedPath<double> realised_path(const PassSetup& pass) {
    const MachineState& machine = *pass.machine;
    return {pass.poses,     pass.arcs,  machine,
            pass.height_mm, machine.by, backlash_offsets(pass.poses, machine, machine.by)};
}
/// Returns the path with derivatives by the first `numbers` errors of the machine.
template <class T>
RealisedPath<T> differentiable_path(const PassSetup& pass, int numbers) {
    const MachineState& machine = *pass.machine;
    RealisedPath<T> out{pass.poses, pass.arcs, machine, T(pass.height_mm, kMaxTerms), {}, {}};
    for (int i = 0; i < kMachineErrors; ++i) {
        const double value = machine.by[std::size_t(i)];
        out.by[std::size_t(i)] = i < numbers ? T(value, kMaxTerms + 1 + i) : T(value);
    }
    out.behind = backlash_offsets(pass.poses, machine, out.by);
    return out;
}

/// Finds the first index from i on, in ascending numbers, of a number that is at least `least`. It searches in doubling
/// strides, because most distances are short.
std::size_t first_at_least(const std::vector<double>& rising, std::size_t i, double least) {
    std::size_t end = i;
    for (std::size_t stride = 1; end < rising.size() && rising[end] < least; stride *= 2) {
        i = end + 1;
        end += stride;
    }
    const auto begin = rising.begin();
    return std::size_t(
        std::lower_bound(begin + std::ptrdiff_t(i), begin + std::ptrdiff_t(std::min(end, rising.size())), least) -
        begin);
}
/// Counts how many of the first i numbers are at most `most`.
std::size_t count_at_most(const std::vector<double>& rising, std::size_t i, double most) {
    std::size_t begin = i;
    for (std::size_t stride = 1; begin > 0 && rising[begin - 1] > most; stride *= 2) {
        i = begin - 1;
        begin = i - std::min(i, stride - 1);
    }
    const auto at = rising.begin();
    return std::size_t(std::upper_bound(at + std::ptrdiff_t(begin), at + std::ptrdiff_t(i), most) - at);
}

}  // namespace

bool Footprints::follow(const PassSetup& pass, const std::vector<double>& at, double coarse) {
    max_step_mm_ = coarse * kMaxFootprintStepMm;
    if (!pass.machine) return follow_path(CommandedPath<double>{pass.poses, pass.arcs, pass.height_mm}, pass, at);
    return follow_path(realised_path(pass), pass, at);
}

template <class Way>
bool Footprints::follow_path(const Way& way, const PassSetup& pass, const std::vector<double>& at) {
    const std::vector<double>& lag = pass.laws.lag;
    reach_ = pass.deepest_mm + std::max(0.0, way.deeper_mm);
    for (Eigen::Index i = 0; i < way.count(); ++i) reach_ = std::max(reach_, way.depth(i));
    if (way.depth(0) > 0.0 || !(lag[0] > 0.0) || !real_roots(lag, 0.0, reach_).empty()) return false;
    std::vector<double> close = at;
    evaluations_ = 0;
    for (int round = 0; round < kMaxRounds; ++round) {
        walk(way, close, pass.laws);
        evaluations_ += kEvaluationsPerStep * close.size();
        bound_footprints();
        const std::vector<double> closer = refine_places(close);
        if (closer.size() == close.size()) break;
        if (closer.size() > kMaxInstants + kMaxInstantsPerPlace * at.size()) return false;
        close = closer;
    }
    return !rows_.empty();
}

void Footprints::derive(const PassSetup& pass, const Eigen::MatrixXd& lag_by, bool by_machine,
                        std::vector<std::size_t> rows) {
    for (std::size_t i = 0, count = rows.size(); i < count; ++i)
        if (rows_[rows[i]].heading_source != rows[i]) rows.push_back(rows_[rows[i]].heading_source);
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    if (derivatives_.size() < rows_.size()) derivatives_.resize(rows_.size());
    evaluations_ += kEvaluationsPerStep * rows.size();
    if (!pass.machine)
        derive_path<Jet>(CommandedPath<Jet>{pass.poses, pass.arcs, Jet(pass.height_mm, kMaxTerms)}, pass.laws, lag_by,
                         rows);
    else if (!by_machine)
        derive_path<Jet>(differentiable_path<Jet>(pass, 0), pass.laws, lag_by, rows);
    else if (pass.machine->has_field)
        derive_path<FieldJet>(differentiable_path<FieldJet>(pass, kMachineErrors), pass.laws, lag_by, rows);
    else
        derive_path<MachineJet>(differentiable_path<MachineJet>(pass, MachineIndex::field), pass.laws, lag_by, rows);
}

template <class T, class Way>
void Footprints::derive_path(const Way& way, const MarkLaws& laws, const Eigen::MatrixXd& lag_by,
                             const std::vector<std::size_t>& rows) {
    std::vector<double> at;
    for (const std::size_t row : rows) at.push_back(rows_[row].place);
    trace<T>(law_of(differentiable_law<T>(laws.lag, lag_by), 0.0, reach_), way, at,
             [&](std::size_t k, const Trace<T>& row) {
                 InstantDerivatives& by = derivatives_[rows[k]];
                 by.contact = path_derivatives(row.state.contact);
                 by.heading = path_derivatives(row.state.heading);
                 store_depth_derivatives(row.depth, by.depth);
             });
    for (const std::size_t row : rows) derivatives_[row].heading = derivatives_[rows_[row].heading_source].heading;
}

std::vector<double> Footprints::refine_places(const std::vector<double>& at) const {
    std::vector<double> out;
    std::size_t row = 0;
    for (std::size_t k = 0; k < at.size(); ++k) {
        out.push_back(at[k]);
        while (row + 1 < rows_.size() && rows_[row].place < at[k]) ++row;
        if (row + 1 >= rows_.size() || k + 1 >= at.size() || rows_[row].place != at[k] ||
            rows_[row + 1].place != at[k + 1])
            continue;
        const int parts = std::min(kMaxParts, int(std::ceil((travelled_[row + 1] - travelled_[row]) / max_step_mm_)));
        for (int i = 1; i < parts; ++i) out.push_back(at[k] + (at[k + 1] - at[k]) * i / parts);
    }
    return out;
}

template <class Way>
void Footprints::walk(const Way& way, const std::vector<double>& at, const MarkLaws& laws) {
    const LagLaw<double> law = law_of(laws.lag, 0.0, reach_);
    rows_.clear();
    trace<double>(law, way, at, [&](std::size_t k, const Trace<double>& row) {
        if (!row.down) return;
        Instant& now = rows_.emplace_back();
        const double d = std::max(0.0, row.depth);
        now.contact = row.state.contact;
        now.heading = row.state.heading;
        now.heading_known = row.state.heading_known || row.state.taut;
        now.heading_source = rows_.size() - 1;
        now.loose_lever_mm = row.state.taut ? INFINITY : (row.tcp - now.contact).norm();
        now.place = at[k];
        now.depth = d;
        now.gap = at_depth(laws.tip_gap, d);
        now.gap_slope = slope_at_depth(laws.tip_gap, d);
        const double half = at_depth(laws.half_width, d) + kMinHalfWidthMm;
        now.half_slope = slope_at_depth(laws.half_width, d);
        ratio_at_depth(laws.widest_by_depth, laws.widest_per_half, d, now.widest_ratio, now.widest_slope);
        ratio_at_depth(laws.front_by_depth, laws.front_per_half, d, now.front_ratio, now.front_slope);
        now.drop = {now.widest_ratio * half, half, now.front_ratio * half, laws.round_tail};
    });
    // Before the first motion there is no heading, and the first known one is used.
    std::size_t open = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        if (!rows_[i].heading_known) continue;
        for (; open < i; ++open)
            if (!rows_[open].heading_known) {
                rows_[open].heading = rows_[i].heading;
                rows_[open].heading_source = i;
            }
        open = i + 1;
    }
}

void Footprints::bound_footprints() {
    middle_.resize(rows_.size());
    radius_.resize(rows_.size());
    travelled_.resize(rows_.size());
    Eigen::Matrix<double, 2, 6> before;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const Instant& now = rows_[i];
        // Every point of the drop is a mean of these corners, with the same weights at all instants.
        const Eigen::Vector2d tip = now.contact - now.gap * now.heading;
        const Eigen::Vector2d widest = tip + now.drop.widest * now.heading;
        const Eigen::Vector2d front = widest + now.drop.front * now.heading;
        const Eigen::Vector2d side = now.drop.half * Eigen::Vector2d(-now.heading.y(), now.heading.x());
        Eigen::Matrix<double, 2, 6> corners;
        corners << tip + side, tip - side, widest + side, widest - side, front + side, front - side;
        travelled_[i] = i ? travelled_[i - 1] + std::sqrt((corners - before).colwise().squaredNorm().maxCoeff()) : 0.0;
        before = corners;
        const double to_middle = 0.5 * (now.drop.widest + now.drop.front);
        middle_[i] = tip + to_middle * now.heading;
        radius_[i] = std::sqrt(to_middle * to_middle + now.drop.half * now.drop.half);
    }
}

std::size_t Footprints::descend_to_nearest(const Eigen::Vector2d& x, std::size_t row) const {
    const auto least = [&](std::size_t i) {
        ++evaluations_;
        const Eigen::Vector2d here = rows_[i].in_frame(x);
        return least_distance(rows_[i].drop, here.x(), here.y());
    };
    double now = least(row);
    for (const std::size_t by : {std::size_t(1), std::size_t(-1)})
        for (bool is_nearer = true; is_nearer && row + by < rows_.size();) {
            const double next = least(row + by);
            is_nearer = next < now;
            if (!is_nearer) break;
            now = next;
            row += by;
        }
    return row;
}

NearestEdge Footprints::nearest(const Eigen::Vector2d& x, std::size_t& row) const {
    // Between instants, a distance changes by no more than the footprint moves. Where it is much too long, many
    // instants are skipped.
    const std::size_t begin = row = descend_to_nearest(x, row);
    const Eigen::Vector2d first = rows_[begin].in_frame(x);
    NearestEdge best = nearest_edge(rows_[begin].drop, first.x(), first.y());
    const auto evaluate = [&](std::size_t i) {
        ++evaluations_;
        const Eigen::Vector2d here = rows_[i].in_frame(x);
        const double least = least_distance(rows_[i].drop, here.x(), here.y());
        if (least < best.distance) {
            const NearestEdge edge = nearest_edge(rows_[i].drop, here.x(), here.y());
            if (edge.distance < best.distance) {
                best = edge;
                row = i;
            }
        }
        return least - best.distance;
    };
    for (std::size_t i = begin + 1; i < rows_.size() && best.distance >= 0.0;) {
        const double clear = travelled_[i] + evaluate(i);
        i = first_at_least(travelled_, i + 1, clear);
    }
    for (std::size_t i = begin; i > 0 && best.distance >= 0.0;) {
        const double clear = travelled_[i - 1] - evaluate(i - 1);
        i = count_at_most(travelled_, i - 1, clear);
    }
    return best;
}

SweptEdge Footprints::swept_edge(const Eigen::Vector2d& x, std::size_t row, const NearestEdge& own) const {
    const Instant& here = rows_[row];
    const Eigen::Vector2d normal = here.on_paper(own), from = here.place_of(own);
    SweptEdge best{normal.dot(x - from), normal, own};
    for (const std::size_t other : {row - 1, row + 1}) {
        if (other >= rows_.size()) continue;
        // Instants are further apart only where the brush was in the air in between.
        const double moved = std::abs(travelled_[other] - travelled_[row]);
        if (!(moved > 1e-9) || moved > 4.0 * max_step_mm_) continue;
        const Instant& there = rows_[other];
        NearestEdge touched = own, beyond = there.farthest(normal);
        Eigen::Vector2d n = normal, a = from, b = there.place_of(beyond);
        if (n.dot(b - a) <= 1e-12) continue;  // the neighbour stays behind the footprint's own tangent
        // The distance of x from the swept area is that from the farthest line that has both footprints behind it.
        SweptEdge pair{n.dot(x - b), n, own};
        // The common tangent is found by iteration: a line through the farthest places, and the farthest places
        // perpendicular to this line.
        for (int round = 0; round < kMaxTangentRounds; ++round) {
            const Eigen::Vector2d along = b - a;
            Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
            if (across.dot(n) < 0.0) across = -across;
            const bool still = (across - n).squaredNorm() < 1e-10;
            n = across;
            if (still) break;
            touched = here.farthest(n);
            a = here.place_of(touched);
            beyond = there.farthest(n);
            b = there.place_of(beyond);
        }
        const double distance = n.dot(x) - std::max(n.dot(a), n.dot(b));
        if (distance > pair.distance && n.dot(normal) > kMinTangentCosine) {
            const double t = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
            pair = {distance, n, between(here.drop, touched, beyond, t)};
        }
        if (pair.distance < best.distance) best = pair;
    }
    return best;
}

Eigen::Vector2d Footprints::motion_direction(std::size_t row, const NearestEdge& edge) const {
    if (row == 0 || row + 1 >= rows_.size()) return Eigen::Vector2d::Zero();
    const Eigen::Vector2d here = rows_[row].place_of(edge), come = here - rows_[row - 1].place_of(edge),
                          go = rows_[row + 1].place_of(edge) - here, both = come + go;
    const double as_far = std::sqrt(come.squaredNorm() * go.squaredNorm());
    if (!(as_far > 1e-12) || come.dot(go) < 0.8 * as_far) return Eigen::Vector2d::Zero();
    return both.normalized();
}

double Footprints::distance_to_outside(const Eigen::Vector2d& x, const Eigen::Vector2d& out, std::size_t& last) const {
    // Footprints with a smaller gap count as adjacent. The limit is larger than the distance between instants.
    const double gap = 2.0 * max_step_mm_;
    struct Part {
        Span span;
        std::size_t row;
    };
    thread_local std::vector<Part> parts;
    parts.clear();
    for (std::size_t i = 0, next; i < rows_.size(); i = next) {
        next = i + 1;
        ++evaluations_;
        const Eigen::Vector2d to = middle_[i] - x;
        const double beside = std::abs(out.x() * to.y() - out.y() * to.x()), off = std::max(beside, -out.dot(to));
        if (off >= radius_[i]) {
            next = first_at_least(travelled_, next, travelled_[i] + off - radius_[i]);
            continue;
        }
        const Eigen::Vector2d at = rows_[i].in_frame(x), u = rows_[i].heading;
        const Span span = span_inside(rows_[i].drop, at.x(), at.y(), out.dot(u), u.x() * out.y() - u.y() * out.x());
        if (span.to >= span.from && span.to >= 0.0) parts.push_back({span, i});
    }
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.span.from < b.span.from; });
    double far = 0.0;
    for (const Part& part : parts) {
        if (part.span.from > far + gap) break;
        if (part.span.to <= far) continue;
        far = part.span.to;
        last = part.row;
    }
    return far;
}

}  // namespace brushsvg::fit
