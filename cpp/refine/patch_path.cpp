#include "patch_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "brushsvg/simulate.hpp"
#include "inverse/landing.hpp"
#include "inverse/middle_line.hpp"

namespace brushsvg::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kPi = 3.14159265358979323846;
/// Path length that a turn in place counts for [mm per rad]: it needs samples and controls of its own.
constexpr double kPathLengthPerRad = 1.0;
/// Limits that detect a turning over: the patch rests in one place and the headings of neighbours are more than 120
/// degrees apart. Samples of a turn in place are closer.
constexpr double kMaxTurnOverCosine = -0.5, kMaxTurnOverMoveMm = 0.01;
/// Path length that a dab gets [mm]. Without a length no factor could make it a stroke.
constexpr double kMinPathLengthMm = 1.0;

double unwrapped(double angle, double near) { return angle - 2.0 * kPi * std::round((angle - near) / (2.0 * kPi)); }

PatchSample between(const PatchSample& a, const PatchSample& b, double c) {
    return {a.contact_mm + c * (b.contact_mm - a.contact_mm), a.heading_rad + c * (b.heading_rad - a.heading_rad),
            a.depth_mm + c * (b.depth_mm - a.depth_mm)};
}

Vector2d direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

}  // namespace

PatchPath::Splines PatchPath::splines_at(double t, int controls) {
    // clamped knots: the first control is the value at the start
    const int spans = controls - 3;
    const int k = std::clamp(int(t * spans), 0, spans - 1);
    const auto knot = [&](int i) { return double(std::clamp(i - 3, 0, spans)) / spans; };
    Splines out{k, {1.0, 0.0, 0.0, 0.0}};
    for (int degree = 1; degree <= 3; ++degree) {  // algorithm of Cox and de Boor
        double saved = 0.0;
        for (int r = 0; r < degree; ++r) {
            const double right = knot(k + 3 + r + 1) - t, left = t - knot(k + 3 + 1 - degree + r);
            const double part = out.value[r] / (right + left);
            out.value[r] = saved + right * part;
            saved = left * part;
        }
        out.value[degree] = saved;
    }
    return out;
}

PatchPath::PatchPath(PatchSamples base, int controls, const std::array<double, 2>& depths_mm)
    : base_(std::move(base)), controls_(controls), depths_mm_(depths_mm) {
    const double steps = double(base_.size() - 1);
    for (std::size_t i = 0; i < base_.size(); ++i) {
        here_.push_back(splines_at(double(i) / steps, controls));
        if (i + 1 < base_.size()) between_.push_back(splines_at((double(i) + 0.5) / steps, controls));
    }
}

PatchSamples PatchPath::at(const VectorXd& x) const {
    const Index turns = 2, longer = turns + controls_, deeper = longer + controls_;
    PatchSamples out = base_;
    Vector2d contact = base_[0].contact_mm + x.head<2>();
    for (std::size_t i = 0; i < base_.size(); ++i) {
        out[i].contact_mm = contact;
        out[i].heading_rad += here_[i].of(x, turns);
        if (depths_mm_[0] < depths_mm_[1])
            out[i].depth_mm = std::clamp(out[i].depth_mm + here_[i].of(x, deeper), depths_mm_[0], depths_mm_[1]);
        if (i + 1 == base_.size()) break;
        const Vector2d step = base_[i + 1].contact_mm - base_[i].contact_mm;
        contact += std::exp(between_[i].of(x, longer)) * (Eigen::Rotation2Dd(between_[i].of(x, turns)) * step);
    }
    return out;
}

VectorXd PatchPath::slope(const PatchSamples& samples, const std::vector<Eigen::Vector4d>& by_samples) const {
    const Index turns = 2, longer = turns + controls_, deeper = longer + controls_;
    VectorXd out = VectorXd::Zero(unknowns());
    Vector2d behind = Vector2d::Zero();  // derivatives by the contacts of all samples behind a step
    for (std::size_t i = samples.size(); i-- > 0;) {
        if (i + 1 < samples.size()) {
            const Vector2d step = samples[i + 1].contact_mm - samples[i].contact_mm;
            const Splines& s = between_[i];
            out.segment<4>(turns + s.first) += (step.x() * behind.y() - step.y() * behind.x()) * s.value;
            out.segment<4>(longer + s.first) += step.dot(behind) * s.value;
        }
        behind += by_samples[i].head<2>();
        const Splines& s = here_[i];
        out.segment<4>(turns + s.first) += by_samples[i][2] * s.value;
        if (is_free(samples[i].depth_mm)) out.segment<4>(deeper + s.first) += by_samples[i][3] * s.value;
    }
    out.head<2>() = behind;
    return out;
}

MatrixXd PatchPath::curvature(const PatchSamples& samples, const std::vector<Eigen::Matrix4d>& by_samples) const {
    // A contact's derivatives are X_i = X_0 + D_0 + .. + D_(i-1), by the steps up to it. Let P be the contacts' blocks
    // and C_l = P_(l+1) + .. their sums. Then sum X_i^T P_i X_i = X_0^T C_(-1) X_0 + sum X_l^T C_l D_l + its transpose
    // + D_l^T C_l D_l.
    const Index turns = 2, longer = turns + controls_, deeper = longer + controls_, n = unknowns();
    std::vector<Eigen::Matrix2d> behind(samples.size(), Eigen::Matrix2d::Zero());
    for (std::size_t i = samples.size() - 1; i-- > 0;)
        behind[i] = behind[i + 1] + by_samples[i + 1].topLeftCorner<2, 2>();
    MatrixXd half = MatrixXd::Zero(n, n);     // the result is this matrix plus its transpose
    MatrixXd contact = MatrixXd::Zero(n, 2);  // X_i, a column for x and one for y
    contact(0, 0) = contact(1, 1) = 1.0;
    half.topLeftCorner<2, 2>() = 0.5 * (behind[0] + by_samples[0].topLeftCorner<2, 2>());
    Index reached = 2;  // end of the turns' unknowns that move the contact
    // add X_i^T v to the column of an unknown
    const auto add = [&](Index unknown, const Vector2d& v) {
        half.col(unknown).head(reached) += contact.topRows(reached) * v;
        half.col(unknown).segment(longer, reached - turns) += contact.middleRows(longer, reached - turns) * v;
    };
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Splines& s = here_[i];
        const Eigen::Matrix4d& by = by_samples[i];
        const bool free = is_free(samples[i].depth_mm);
        const Eigen::Matrix4d square = s.value * s.value.transpose();
        const Index turn = turns + s.first, deep = deeper + s.first;
        half.block<4, 4>(turn, turn) += 0.5 * by(2, 2) * square;
        for (Index k = 0; k < 4; ++k) add(turn + k, s.value[k] * by.block<2, 1>(0, 2));
        if (free) {
            half.block<4, 4>(turn, deep) += by(2, 3) * square;
            half.block<4, 4>(deep, deep) += 0.5 * by(3, 3) * square;
            for (Index k = 0; k < 4; ++k) add(deep + k, s.value[k] * by.block<2, 1>(0, 3));
        }
        if (i + 1 == samples.size()) break;
        const Vector2d along = samples[i + 1].contact_mm - samples[i].contact_mm, across(-along.y(), along.x());
        const Vector2d by_turn = behind[i] * across, by_length = behind[i] * along;
        const Splines& t = between_[i];
        const Eigen::Matrix4d both = t.value * t.value.transpose();
        const Index turned = turns + t.first, lengthened = longer + t.first;
        for (Index k = 0; k < 4; ++k) {
            add(turned + k, t.value[k] * by_turn);
            add(lengthened + k, t.value[k] * by_length);
        }
        half.block<4, 4>(turned, turned) += 0.5 * across.dot(by_turn) * both;
        half.block<4, 4>(turned, lengthened) += across.dot(by_length) * both;
        half.block<4, 4>(lengthened, lengthened) += 0.5 * along.dot(by_length) * both;
        contact.block<4, 2>(turned, 0) += t.value * across.transpose();
        contact.block<4, 2>(lengthened, 0) += t.value * along.transpose();
        reached = std::max(reached, turned + 4);
    }
    return half + half.transpose();
}

double path_length(const PatchSamples& samples) {
    double way = 0.0;
    for (std::size_t i = 1; i < samples.size(); ++i) way += (samples[i].contact_mm - samples[i - 1].contact_mm).norm();
    return way;
}

namespace {

/// Rows of a trace as samples, without those where nothing moves, and the path length up to each.
struct TraceRows {
    PatchSamples samples;
    std::vector<double> way;

    TraceRows(const PassMarks& marks, std::size_t begin, std::size_t end, double heading_near) {
        for (std::size_t i = begin; i < end; ++i) {
            PatchSample row{marks.contact_mm.row(Index(i)).transpose(), marks.heading_rad[i], marks.depth_mm[i]};
            row.heading_rad = unwrapped(row.heading_rad, samples.empty() ? heading_near : samples.back().heading_rad);
            double step = 0.0;
            if (!samples.empty()) {
                step = (row.contact_mm - samples.back().contact_mm).norm() +
                       kPathLengthPerRad * std::abs(row.heading_rad - samples.back().heading_rad);
                if (step == 0.0) continue;
            }
            way.push_back(samples.empty() ? 0.0 : way.back() + step);
            samples.push_back(row);
        }
    }
    /// Append the samples, evenly resampled to between `least` and `most`.
    void write_to(PatchSamples& out, double step_mm, std::size_t least, std::size_t most) const {
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
    // the landing ends at a pose after which the brush becomes taut
    if (begin > 0 && begin < end && marks.pose[begin - 1] == std::floor(marks.pose[begin - 1])) --begin;
    while (end > begin && !marks.taut[end - 1]) --end;
    if (begin == end) return {};
    PatchSamples out;
    double heading = marks.heading_rad[begin];
    // P rests there: the part between both ends is not painted
    for (const TurnOver& turn : find_turn_overs(marks)) {
        const TraceRows rows(marks, begin, turn.first, heading);
        if (rows.samples.size() > 1) rows.write_to(out, step_mm, 2, most);
        begin = turn.last;
        heading = out.empty() ? marks.heading_rad[begin] : out.back().heading_rad;
    }
    TraceRows rows(marks, begin, end, heading);
    if (rows.way.back() < kMinPathLengthMm && out.empty()) {
        rows.samples = {rows.samples.back(), rows.samples.back()};
        rows.samples[0].contact_mm -= kMinPathLengthMm * direction(rows.samples[1].heading_rad);
        rows.way = {0.0, kMinPathLengthMm};
    }
    if (rows.samples.size() > 1) rows.write_to(out, step_mm, 8, most);
    return out;
}

bool turns_over(const PatchSample& a, const PatchSample& b) {
    return std::cos(b.heading_rad - a.heading_rad) < kMaxTurnOverCosine &&
           (b.contact_mm - a.contact_mm).norm() < kMaxTurnOverMoveMm;
}

namespace {

/// Return the path with additional samples in turns. They keep the heading between poses close to the samples'
/// headings.
PatchSamples add_turn_samples(const PatchSamples& samples) {
    PatchSamples out{samples[0]};
    for (std::size_t i = 1; i < samples.size(); ++i) {
        const PatchSample &a = samples[i - 1], &b = samples[i];
        const int n = turns_over(a, b)
                          ? 1
                          : std::max(1, int(std::ceil(std::abs(b.heading_rad - a.heading_rad) / kMaxTurnStepRad)));
        for (int k = 1; k <= n; ++k) out.push_back(between(a, b, double(k) / n));
    }
    return out;
}

}  // namespace

Poses poses_along(const PatchSamples& coarse, const Brush& brush, double tolerance_mm) {
    const PatchSamples samples = add_turn_samples(coarse);
    const auto tcp = [&](const PatchSample& s) {
        return Vector2d(s.contact_mm + brush.lag(s.depth_mm) * direction(s.heading_rad));
    };
    const auto stance = [&](const PatchSample& s) {
        return Stance{s.contact_mm, direction(s.heading_rad), s.depth_mm};
    };
    PoseList list;
    land(stance(samples.front()), brush, list);
    std::size_t from = 0;
    // as long a chord as the samples between its ends allow
    const auto fits = [&](std::size_t a, std::size_t b) {
        if (std::abs(samples[b].heading_rad - samples[a].heading_rad) > kMaxTurnStepRad) return false;
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
    list.write_to(pass);
    return pass.poses_mm;
}

}  // namespace brushsvg::fit
