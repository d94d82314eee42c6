#include "brushsvg/thin_out.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/lag.hpp"
#include "brushsvg/simulate.hpp"
#include "nearest.hpp"
#include "tolerance.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Places of a move that are looked at, at most: more find the same error, fewer miss a kink of the path.
constexpr Index kLooks = 10;
/// Less is not pressed any more.
constexpr double kLeastDepthMm = 1e-3;
/// A move shorter than this has no direction to speak of.
constexpr double kLeastMoveMm = 1e-6;
/// From one move to the next the tool turns by no more, up and down counted: or it would have to stop there. Bends this
/// tight slow it down anyway: 0.6 needs 8 % more poses and takes as long.
constexpr double kMostTurnRad = 1.0;
/// How far beside the path a move may end, in second differences over half its length: a third for an even curve. More
/// of them win less than 1 % of the poses, none but the third loses a tenth.
constexpr double kBeside[] = {1.0 / 3.0, 0.25, 0.45, 0.15, 0.0};
/// And how much of that in depth, which the brush does not smooth: half the sagitta at a third.
constexpr double kDeeper = 0.75;
/// The mark's middle may be so many tolerances ahead of or behind where it was after the same share of the way. Where
/// poses lie far apart, on straight lines, a mark beside the line is what else it would be next to: other sides of a
/// triangle, a there with no back.
constexpr double kSlipShare = 10.0;
/// The footprint's tip may be off by so many tolerances: it lies inside the mark, its sides are what shows.
constexpr double kTipShare = 3.0;

/// What the brush does at every pose of the pass as it is.
struct Traced {
    Ring tcp, middle;
    std::vector<double> depth, along;  ///< along: path of the TCP [mm]
    double deepest = 0.0;
    std::vector<Vector2d> contact, heading;
    std::vector<bool> taut;     ///< at the pose
    std::vector<bool> dragged;  ///< from the pose to the next: taut all the way, in a straight move

    Traced(const Pass& pass, const Brush& brush, const PassMarks& marks) {
        const Index n = pass.poses_mm.rows();
        tcp = pass.poses_mm.leftCols<2>();
        middle.resize(n, 2);
        depth.resize(n);
        along.assign(n, 0.0);
        contact.resize(n);
        heading.resize(n);
        taut.assign(n, false);
        dragged.assign(n, true);
        const Ring widest = widest_points(marks, brush);
        for (std::size_t row = 0; row < marks.pose.size(); ++row) {
            const double pose = marks.pose[row];
            const Index i = Index(std::floor(pose));
            const bool is_pose = pose == double(i);
            if (!marks.taut[row]) {  // on the way to this pose and from it on
                if (i < n) dragged[i] = false;
                if (is_pose && i > 0) dragged[i - 1] = false;
            }
            if (!is_pose) continue;
            middle.row(i) = widest.row(Index(row));
            contact[i] = marks.contact_mm.row(Index(row)).transpose();
            heading[i] = {std::cos(marks.heading_rad[row]), std::sin(marks.heading_rad[row])};
            taut[i] = marks.taut[row];
        }
        for (Index i = 0; i < n; ++i) {
            depth[i] = -pass.poses_mm(i, 2);
            deepest = std::max(deepest, depth[i]);
            if (i > 0) along[i] = along[i - 1] + (tcp.row(i) - tcp.row(i - 1)).norm();
        }
        for (Index i = 0; i + 1 < n; ++i)
            if (!(along[i + 1] - along[i] > kLeastMoveMm) || depth[i] <= 0.0 || depth[i + 1] <= 0.0) dragged[i] = false;
        if (n > 0) dragged[n - 1] = false;
        for (const Arc& arc : pass.arcs)
            for (Index i = arc.first; i < arc.last; ++i) dragged[i] = false;
    }

    /// Where the TCP was after a way: x, y, depth. `near`: a pose to look from.
    Vector3d at(double s, Index near) const {
        Index i = near;
        while (i > 0 && along[i] > s) --i;
        while (i + 2 < tcp.rows() && along[i + 1] < s) ++i;
        const double step = along[i + 1] - along[i], t = step > 0.0 ? (s - along[i]) / step : 0.0;
        return pose(i) + t * (pose(i + 1) - pose(i));
    }
    Vector3d pose(Index i) const { return {tcp(i, 0), tcp(i, 1), depth[i]}; }
};

/// One stretch of dragged moves, walked from its beginning: as far as possible in each move.
class Walk {
 public:
    Walk(const Traced& was, const Brush& brush, const LagLaw<double>& law, double tolerance_mm)
        : was_(was), brush_(brush), law_(law), tolerance_(tolerance_mm) {}

    /// Poses that lead from pose `first` to pose `last`, both ends left out.
    std::vector<Vector3d> operator()(Index first, Index last) {
        first_ = first;
        last_ = last;
        std::vector<Vector3d> out;
        state_.taut = state_.heading_known = true;
        state_.contact = was_.contact[first];
        state_.heading = was_.heading[first];
        at_ = was_.pose(first);
        way_ = Vector3d::Zero();
        Index i = first, stride = 4;
        while (i < last) {
            const auto [j, step] = farthest(i, stride);
            stride = std::max<Index>(2, j - i);
            way_ = step.to - at_;
            at_ = step.to;
            state_ = step.state;
            i = j;
            if (i < last) out.emplace_back(at_.x(), at_.y(), -at_.z());
        }
        return out;
    }

 private:
    struct Step {
        Vector3d to;  ///< x, y, depth
        LagState<double> state;
        bool good = false;
    };

    /// How far one move goes: to a pose, or beside it. Chords lie inside a curve, and the brush follows their mean. Out
    /// by q'' L^2 / 12 their error has none, and what is left goes back and forth too quickly for the brush. Where the
    /// curve changes on the way, more or less than that is better.
    std::pair<Index, Step> farthest(Index i, Index stride) const {
        Index good = i + 1;
        Step best = tried(i, good, was_.pose(good));
        for (double share : kBeside) {
            Index step = stride, bad = last_ + 1;
            for (Index j = std::min(good + step, last_); j > good; j = std::min(good + step, last_)) {
                const Step trial = tried(i, j, beside(i, j, share));
                if (!trial.good) {
                    bad = j;
                    break;
                }
                good = j;
                best = trial;
                step *= 2;
            }
            while (bad - good > 1 && good < last_) {
                const Index j = good + (bad - good) / 2;
                const Step trial = tried(i, j, beside(i, j, share));
                if (trial.good) {
                    good = j;
                    best = trial;
                } else {
                    bad = j;
                }
            }
            stride = 1;
        }
        return {good, best};
    }
    Vector3d beside(Index i, Index j, double share) const {
        const Vector3d here = was_.pose(j);
        const double h = std::min(0.5 * (was_.along[j] - was_.along[i]), was_.along[last_] - was_.along[j]);
        if (!(h > 0.0)) return here;
        const Vector3d bends = was_.at(was_.along[j] - h, j) - 2.0 * here + was_.at(was_.along[j] + h, j);
        Vector3d to = here - share * Vector3d(bends.x(), bends.y(), kDeeper * bends.z());
        to.z() = std::clamp(to.z(), std::min(here.z(), kLeastDepthMm), was_.deepest);
        return to;
    }

    Step tried(Index i, Index j, const Vector3d& to) const {
        checkpoint(10);
        Step step{to, state_};
        const Move<double> move(at_.head<2>(), to.head<2>(), at_.z(), to.z());
        if (move.length > kLeastMoveMm && j > i + 1) {
            const double turn = std::atan2(way_.cross(to - at_).norm(), way_.dot(to - at_));
            if (turn > kMostTurnRad) return step;
        }
        bool good = true;
        // a pen smooths nothing: every pose may be a spike of its own
        const Index stride = law_.rigid ? 1 : std::max<Index>(1, (j - i) / kLooks);
        Index k = i + 1;
        const double from = was_.along[i], length = was_.along[j] - from;
        advance(law_, move, step.state,
                [&](const auto& piece, const auto& mv, const auto& start, double begin, double end) {
                    good = good && start.taut;
                    while (good && k <= j) {
                        const double t = (was_.along[k] - from) / length;
                        if (t > end + 1e-12) break;
                        const double at = std::min(t, end);
                        const LagState<double> now =
                            law_.rigid ? rigid(mv, at) : within_phase(piece, mv, start, begin, at);
                        good = is_near(now, mv.depth(at), k);
                        k = k < j ? std::min(k + stride, j) : j + 1;
                    }
                });
        step.good = good && step.state.taut;
        return step;
    }
    static LagState<double> rigid(const Move<double>& move, double t) {
        LagState<double> state;
        state.contact = move.tcp(t);
        state.heading = move.along;
        return state;
    }

    /// Whether the footprint is where it was about pose k, to the tolerance.
    bool is_near(const LagState<double>& now, double depth, Index k) const {
        const Vector2d middle = now.contact + brush_.lever_to_widest(depth) * now.heading;
        const double most_slip = kSlipShare * tolerance_;
        if ((middle - was_.middle.row(k).transpose()).squaredNorm() > most_slip * most_slip) return false;
        double least = 1e300;
        for (Index i = std::max(first_, k - 2); i < std::min(last_, k + 2); ++i) {
            const Vector2d a = was_.middle.row(i).transpose(), d = was_.middle.row(i + 1).transpose() - a;
            const double squared = d.squaredNorm();
            const double t = squared > 0.0 ? std::clamp((middle - a).dot(d) / squared, 0.0, 1.0) : 0.0;
            least = std::min(least, (middle - a - t * d).squaredNorm());
        }
        if (least > tolerance_ * tolerance_) return false;
        if (std::abs(brush_.half_width(depth) - brush_.half_width(was_.depth[k])) > tolerance_) return false;
        if (law_.rigid) return true;
        const Vector2d& u = was_.heading[k];
        const double turned = std::abs(u.x() * now.heading.y() - u.y() * now.heading.x());
        return turned * brush_.tip_to_widest(depth) <= kTipShare * tolerance_ && u.dot(now.heading) > 0.0;
    }

    const Traced& was_;
    const Brush& brush_;
    const LagLaw<double>& law_;
    double tolerance_;
    Index first_ = 0, last_ = 0;
    LagState<double> state_;
    Vector3d at_, way_;  ///< where the walk is, and the move that led there
};

Pass thinned(const Pass& pass, const Brush& brush, const Traced& was, double tolerance_mm) {
    const LagLaw<double> law = make_law(pieces(brush.lag, brush.depth_range_mm[0], brush.depth_range_mm[1]));
    const Index n = pass.poses_mm.rows();
    std::vector<Vector3d> poses;
    std::vector<Index> now(n, 0);  // where the poses that stay are
    const auto keep = [&](Index i) {
        now[i] = Index(poses.size());
        poses.push_back(pass.poses_mm.row(i).transpose());
    };
    Walk walk(was, brush, law, tolerance_mm);
    for (Index i = 0; i < n;) {
        keep(i);
        Index end = i;
        if (was.taut[i] || brush.is_rigid())
            while (was.dragged[end]) ++end;
        if (end < i + 2) {
            ++i;
            continue;
        }
        for (const Vector3d& pose : walk(i, end)) poses.push_back(pose);
        i = end;
    }
    Pass out = pass;
    out.poses_mm.resize(Index(poses.size()), 3);
    for (Index i = 0; i < out.poses_mm.rows(); ++i) out.poses_mm.row(i) = poses[i].transpose();
    for (Arc& arc : out.arcs) {
        arc.first = now[arc.first];
        arc.last = now[arc.last];
    }
    return out;
}

/// Farthest that the middle of a mark lies from that of another, from the first taut row to the last.
double apart(const PassMarks& marks, const Brush& brush, const Ring& middle) {
    const Ring widest = widest_points(marks, brush);
    Nearest<Ring> nearest(middle);
    const Index n = Index(marks.taut.size());
    Index begin = 0, end = n;
    while (begin < end && !marks.taut[begin]) ++begin;
    while (end > begin && !marks.taut[end - 1]) --end;
    double largest = 0.0;
    along(widest, begin, end, 0.5,
          [&](const Vector2d& point) { largest = std::max(largest, nearest.distance(point)); });
    return largest;
}

}  // namespace

Pass thin_out(const Pass& pass, const Brush& brush, double tolerance_mm) {
    require_tolerance(tolerance_mm, pass.stroke);
    const double exact_mm = std::min(0.02, 0.1 * tolerance_mm);
    const PassMarks marks = simulate(pass, brush, exact_mm, false);
    if (pass.poses_mm.rows() < 4) return pass;
    const Traced was(pass, brush, marks);
    const Ring middle = widest_points(marks, brush);
    // what is found move by move adds up over a bend and at the ends; smaller steps where it was too much
    for (const double share : {0.95, 0.7, 0.4, 0.2, 0.1}) {
        const Pass trial = thinned(pass, brush, was, share * tolerance_mm);
        const PassMarks now = simulate(trial, brush, exact_mm, false);
        // both ways: a mark that lacks a part is nowhere beside what it should be
        if (apart(now, brush, middle) <= tolerance_mm && apart(marks, brush, widest_points(now, brush)) <= tolerance_mm)
            return trial;
    }
    return pass;
}

}  // namespace brushsvg
