#include "patch_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "brushsvg/simulate.hpp"
#include "landing.hpp"
#include "middle_line.hpp"

namespace brushsvg::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kPi = 3.14159265358979323846;
/// A turn in place counts as so much way per radian: it needs samples and controls of its own.
constexpr double kWayPerRadian = 1.0;
/// Neighbours with the patch at rest in one place and headings more than 120 degrees apart are those before and after
/// the brush turns over: samples of a turn in place lie closer.
constexpr double kTurnedOver = -0.5, kRestsMm = 0.01;
/// A dab is given some way, or no factor could make it a stroke.
constexpr double kLeastWayMm = 1.0;

/// Values of n uniform cubic B-splines at t in [0, 1].
void splines(double t, int n, Eigen::Ref<Eigen::RowVectorXd> out) {
    out.setZero();
    if (n < 4) {  // Bernstein: constant, linear, quadratic
        const double u = 1.0 - t;
        if (n == 1) out << 1.0;
        if (n == 2) out << u, t;
        if (n == 3) out << u * u, 2.0 * u * t, t * t;
        return;
    }
    // clamped knots: the first control is the value at the start
    const int spans = n - 3;
    const int k = std::clamp(int(t * spans), 0, spans - 1);
    const auto knot = [&](int i) { return double(std::clamp(i - 3, 0, spans)) / spans; };
    std::array<double, 4> b{1.0, 0.0, 0.0, 0.0};
    for (int degree = 1; degree <= 3; ++degree) {  // Cox and de Boor
        double saved = 0.0;
        for (int r = 0; r < degree; ++r) {
            const double right = knot(k + 3 + r + 1) - t, left = t - knot(k + 3 + 1 - degree + r);
            const double part = b[r] / (right + left);
            b[r] = saved + right * part;
            saved = left * part;
        }
        b[degree] = saved;
    }
    for (int i = 0; i < 4; ++i) out[k + i] = b[i];
}

double unwrapped(double angle, double near) { return angle - 2.0 * kPi * std::round((angle - near) / (2.0 * kPi)); }

PatchSample between(const PatchSample& a, const PatchSample& b, double c) {
    return {a.contact_mm + c * (b.contact_mm - a.contact_mm), a.heading_rad + c * (b.heading_rad - a.heading_rad),
            a.depth_mm + c * (b.depth_mm - a.depth_mm)};
}

Vector2d direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

}  // namespace

PatchPath::PatchPath(PatchSamples base, int controls, const std::array<double, 2>& depths_mm)
    : base_(std::move(base)), controls_(controls), depths_mm_(depths_mm) {
    const Index n = Index(base_.size());
    here_.resize(n, controls);
    between_.resize(n - 1, controls);
    Eigen::RowVectorXd row(controls);
    for (Index i = 0; i < n; ++i) {
        splines(double(i) / double(n - 1), controls, row);
        here_.row(i) = row;
        if (i + 1 == n) break;
        splines((double(i) + 0.5) / double(n - 1), controls, row);
        between_.row(i) = row;
    }
}

PatchSamples PatchPath::at(const VectorXd& x) const {
    const Index k = controls_;
    const VectorXd turn = here_ * x.segment(2, k), deeper = here_ * x.segment(2 + 2 * k, k);
    const VectorXd turn_step = between_ * x.segment(2, k), longer = between_ * x.segment(2 + k, k);
    PatchSamples out = base_;
    Vector2d contact = base_[0].contact_mm + x.head<2>();
    for (Index i = 0; i < Index(base_.size()); ++i) {
        out[i].contact_mm = contact;
        out[i].heading_rad += turn[i];
        if (depths_mm_[0] < depths_mm_[1])
            out[i].depth_mm = std::clamp(out[i].depth_mm + deeper[i], depths_mm_[0], depths_mm_[1]);
        if (i + 1 == Index(base_.size())) break;
        const Vector2d step = base_[i + 1].contact_mm - base_[i].contact_mm;
        contact += std::exp(longer[i]) * (Eigen::Rotation2Dd(turn_step[i]) * step);
    }
    return out;
}

PatchSamples PatchPath::at(const VectorXd& x, Slopes& slopes) const {
    const PatchSamples out = at(x);
    const Index n = Index(out.size()), k = controls_, all = unknowns();
    slopes.x = slopes.y = slopes.heading = slopes.depth = MatrixXd::Zero(n, all);
    slopes.heading.middleCols(2, k) = here_;
    slopes.x(0, 0) = slopes.y(0, 1) = 1.0;
    for (Index i = 0; i < n; ++i) {
        if (out[i].depth_mm > depths_mm_[0] && out[i].depth_mm < depths_mm_[1])
            slopes.depth.row(i).segment(2 + 2 * k, k) = here_.row(i);
        if (i + 1 == n) break;
        const Vector2d step = out[i + 1].contact_mm - out[i].contact_mm;
        slopes.x.row(i + 1) = slopes.x.row(i);
        slopes.y.row(i + 1) = slopes.y.row(i);
        slopes.x.row(i + 1).segment(2, k) -= step.y() * between_.row(i);
        slopes.y.row(i + 1).segment(2, k) += step.x() * between_.row(i);
        slopes.x.row(i + 1).segment(2 + k, k) += step.x() * between_.row(i);
        slopes.y.row(i + 1).segment(2 + k, k) += step.y() * between_.row(i);
    }
    return out;
}

double way_of(const PatchSamples& samples) {
    double way = 0.0;
    for (std::size_t i = 1; i < samples.size(); ++i) way += (samples[i].contact_mm - samples[i - 1].contact_mm).norm();
    return way;
}

namespace {

/// Rows of a trace as samples, those left out where nothing moves, and the way up to each.
struct Rows {
    PatchSamples samples;
    std::vector<double> way;

    Rows(const PassMarks& marks, std::size_t begin, std::size_t end, double heading_near) {
        for (std::size_t i = begin; i < end; ++i) {
            PatchSample row{marks.contact_mm.row(Index(i)).transpose(), marks.heading_rad[i], marks.depth_mm[i]};
            row.heading_rad = unwrapped(row.heading_rad, samples.empty() ? heading_near : samples.back().heading_rad);
            double step = 0.0;
            if (!samples.empty()) {
                step = (row.contact_mm - samples.back().contact_mm).norm() +
                       kWayPerRadian * std::abs(row.heading_rad - samples.back().heading_rad);
                if (step == 0.0) continue;
            }
            way.push_back(samples.empty() ? 0.0 : way.back() + step);
            samples.push_back(row);
        }
    }
    /// Evenly resampled: at least so many.
    void into(PatchSamples& out, double step_mm, std::size_t least, std::size_t most) const {
        const std::size_t n = std::clamp(std::size_t(std::ceil(way.back() / step_mm)) + 1, least, most);
        std::size_t j = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const double at = way.back() * double(i) / double(n - 1);
            while (j + 2 < way.size() && way[j + 1] < at) ++j;
            const double c = std::clamp((at - way[j]) / (way[j + 1] - way[j]), 0.0, 1.0);
            out.push_back(between(samples[j], samples[j + 1], c));
        }
    }
};

}  // namespace

PatchSamples patch_path(const Pass& pass, const Brush& brush, double step_mm, std::size_t most) {
    const PassMarks marks = simulate(pass, brush, 0.02, false);
    std::size_t begin = 0, end = marks.taut.size();
    while (begin < end && !marks.taut[begin]) ++begin;
    // the landing ends at a pose where the brush is about to be taut
    if (begin > 0 && begin < end && marks.pose[begin - 1] == std::floor(marks.pose[begin - 1])) --begin;
    while (end > begin && !marks.taut[end - 1]) --end;
    if (begin == end) return {};
    PatchSamples out;
    double heading = marks.heading_rad[begin];
    for (const TurnOver& turn : turns_over(marks)) {  // P rests there: what lies between both ends is not painted
        const Rows rows(marks, begin, turn.first, heading);
        if (rows.samples.size() > 1) rows.into(out, step_mm, 2, most);
        begin = turn.last;
        heading = out.empty() ? marks.heading_rad[begin] : out.back().heading_rad;
    }
    Rows rows(marks, begin, end, heading);
    if (rows.way.back() < kLeastWayMm && out.empty()) {
        rows.samples = {rows.samples.back(), rows.samples.back()};
        rows.samples[0].contact_mm -= kLeastWayMm * direction(rows.samples[1].heading_rad);
        rows.way = {0.0, kLeastWayMm};
    }
    if (rows.samples.size() > 1) rows.into(out, step_mm, 8, most);
    return out;
}

bool turns_over(const PatchSample& a, const PatchSample& b) {
    return std::cos(b.heading_rad - a.heading_rad) < kTurnedOver && (b.contact_mm - a.contact_mm).norm() < kRestsMm;
}

namespace {

/// The way with as many samples more as turns ask for: the heading between poses is never far from what it says.
PatchSamples turns_in_steps(const PatchSamples& samples) {
    PatchSamples out{samples[0]};
    for (std::size_t i = 1; i < samples.size(); ++i) {
        const PatchSample &a = samples[i - 1], &b = samples[i];
        const int n =
            turns_over(a, b) ? 1 : std::max(1, int(std::ceil(std::abs(b.heading_rad - a.heading_rad) / kTurnStepRad)));
        for (int k = 1; k <= n; ++k) out.push_back(between(a, b, double(k) / n));
    }
    return out;
}

}  // namespace

Poses poses_along(const PatchSamples& coarse, const Brush& brush, double tolerance_mm) {
    const PatchSamples samples = turns_in_steps(coarse);
    const auto tcp = [&](const PatchSample& s) {
        return Vector2d(s.contact_mm + brush.lag(s.depth_mm) * direction(s.heading_rad));
    };
    const auto stance = [&](const PatchSample& s) {
        return Stance{s.contact_mm, direction(s.heading_rad), s.depth_mm};
    };
    PoseList list;
    land(stance(samples.front()), brush, list);
    std::size_t from = 0;
    // as long a chord as the samples between allow
    const auto fits = [&](std::size_t a, std::size_t b) {
        if (std::abs(samples[b].heading_rad - samples[a].heading_rad) > kTurnStepRad) return false;
        const Vector2d q = tcp(samples[a]), by = tcp(samples[b]) - q;
        for (std::size_t k = a + 1; k < b; ++k) {
            const Vector2d to = tcp(samples[k]) - q;
            const double t = by.squaredNorm() > 0.0 ? std::clamp(to.dot(by) / by.squaredNorm(), 0.0, 1.0) : 0.0;
            const double deep =
                samples[k].depth_mm - samples[a].depth_mm - t * (samples[b].depth_mm - samples[a].depth_mm);
            if ((to - t * by).norm() + 0.5 * std::abs(deep) > tolerance_mm) return false;
        }
        return true;
    };
    while (from + 1 < samples.size()) {
        std::size_t to = from + 1;
        if (turns_over(samples[from], samples[to])) {
            turn_over(stance(samples[from]), stance(samples[to]), brush, list);
            from = to;
            continue;
        }
        while (to + 1 < samples.size() && to - from < 64 && fits(from, to + 1)) ++to;
        list.add(tcp(samples[to]), samples[to].depth_mm);
        from = to;
    }
    lift(stance(samples.back()), brush, list);
    Pass pass;
    list.into(pass);
    return pass.poses_mm;
}

}  // namespace brushsvg::fit
