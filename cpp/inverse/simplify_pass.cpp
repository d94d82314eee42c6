#include "brushsvg/simplify_pass.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/tolerance.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/lag.hpp"
#include "brushsvg/lag_arc.hpp"
#include "brushsvg/simulate.hpp"
#include "inverse/traced_pass.hpp"
#include "regions/nearest_on_polyline.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Approximate number of original poses at which a new move is checked. More poses find the same error. With fewer
/// poses, a kink of the path can be missed.
constexpr Index kCheckedPoses = 10;
/// A depth [mm] below this is not pressed any more.
constexpr double kMinPressedDepthMm = 1e-3;
/// A move shorter than this [mm] has no meaningful direction.
constexpr double kMinMoveMm = 1e-6;
/// Largest turn of the tool from one move to the next [rad], up and down included. With a sharper turn the tool would
/// have to stop. Bends this tight slow it down anyway: 0.6 needs 8 % more poses and takes as long.
constexpr double kMaxTurnRad = 1.0;
/// Tried distances of a move's end from the path, in second differences over half the move's length. A third suits an
/// even curve. More values save less than 1 % of the poses; a third alone costs a tenth more poses.
constexpr double kEndOffsets[] = {1.0 / 3.0, 0.25, 0.45, 0.15, 0.0};
/// Share of this offset that is applied to the depth, which the brush does not smooth. It is half the sagitta at a
/// third.
constexpr double kDepthOffsetShare = 0.75;
/// Largest distance along the path, in tolerances, between the middle of the mark and its original place. This matters
/// on straight lines, where poses are far apart. There a mark close to the path could be close to a different part:
/// another side of a triangle, or a way there without the way back.
constexpr double kMaxSlipTolerances = 10.0;
/// Largest turn of the mark's edges where two moves meet [rad]: eight degrees, less a margin for rounding. At the end
/// of each move the edges may differ from their original direction by kMaxEdgeDeviationRad. A smaller value leaves less
/// for the next move; with a larger one the next move cannot be as long.
constexpr double kMaxEdgeCornerRad = 0.125, kMaxEdgeDeviationRad = 0.07;
/// Share of the tolerance that a move may use up at its end. If nothing were left, the next move could only jump back.
constexpr double kEndToleranceShare = 0.5;
/// Number of steps that are tried where none keeps its direction.
constexpr Index kMaxTries = 6;
/// Limits of arcs. Flatter arcs are lines, and two places do not determine an arc that is nearly a whole circle. A
/// program holds too few digits of a far centre. kMaxArcStepRad limits the turn between two poses of an arc, for
/// machines that know only its chords.
constexpr double kMinArcTurnRad = 0.05, kMaxArcTurnRad = 5.0, kMaxArcStepRad = 0.4;
constexpr double kMinRadiusMm = 2.0 * kArcRadiusRangeMm[0], kMaxRadiusMm = 1000.0;
constexpr double kMaxDepthDifferenceMm = 1e-9;
constexpr double kPi = 3.14159265358979323846;
/// Largest error of the footprint's tip, in tolerances. The tip is inside the mark; only the sides show.
constexpr double kMaxTipTolerances = 3.0;

/// Poses that continue a pass, and the arcs through some of them.
struct NewPoses {
    std::vector<Vector3d> poses;
    std::vector<Arc> arcs;
};

/// An arc of a circle: its centre, radius, and signed turn [rad].
struct Circle {
    Vector2d centre;
    double radius, turn;

    /// Return the circle through three places. None if they are on a line, or if a plan cannot hold the circle.
    static std::optional<Circle> through(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
        const Vector2d ab = b - a, ac = c - a;
        const double cross = ab.x() * ac.y() - ab.y() * ac.x();
        if (!(std::abs(cross) > 1e-9 * ac.squaredNorm())) return {};
        const double s = ab.squaredNorm() / (2.0 * cross), t = ac.squaredNorm() / (2.0 * cross);
        const Vector2d out(s * ac.y() - t * ab.y(), t * ab.x() - s * ac.x());
        // by the inscribed angle theorem, half the turn is pi less the angle at the middle place
        const Vector2d ba = a - b, bc = c - b;
        const double within = std::atan2(std::abs(ba.x() * bc.y() - ba.y() * bc.x()), ba.dot(bc));
        const Circle found{a + out, out.norm(), std::copysign(2.0 * (kPi - within), cross)};
        const double turn = std::abs(found.turn);
        const bool fits = found.radius >= kMinRadiusMm && found.radius <= kMaxRadiusMm;
        return fits && turn >= kMinArcTurnRad && turn <= kMaxArcTurnRad ? std::optional(found) : std::nullopt;
    }
    Vector2d along(const Vector2d& at) const {
        const Vector2d spoke = (at - centre) / radius;
        return turn > 0.0 ? Vector2d(-spoke.y(), spoke.x()) : Vector2d(spoke.y(), -spoke.x());
    }
    /// Return how many poses the arc has after its first. With at least two, a robot gets a pose on its way.
    int poses() const { return std::max(2, int(std::ceil(std::abs(turn) / kMaxArcStepRad))); }
};

/// Simplifies one stretch of dragged moves from its beginning. Each new move goes as far as possible.
class PathSimplifier {
 public:
    PathSimplifier(const TracedPass& original, const Brush& brush, const LagLaw<double>& law, double tolerance_mm)
        : original_(original), brush_(brush), law_(law), tolerance_(tolerance_mm) {}

    /// Return the new poses after pose `first`, up to and including pose `last`.
    NewPoses operator()(Index first, Index last) {
        first_ = first;
        last_ = last;
        NewPoses out;
        state_.taut = state_.heading_known = true;
        state_.contact = original_.contact[first];
        state_.heading = original_.heading[first];
        position_ = original_.pose(first);
        last_move_ = Vector3d::Zero();
        edges_ = original_.leaving[first];
        Index i = first, stride = 4;
        while (i < last) {
            auto [j, step] = farthest_straight(i, stride);
            const auto [k, round] = farthest_round(i, j);
            if (round.circle && double(k - i) >= double(round.circle->poses()) * double(j - i)) {
                j = k;
                step = round;
            }
            stride = std::max<Index>(2, j - i);
            accept(step, out);
            i = j;
        }
        return out;
    }

 private:
    struct Step {
        Vector3d to;  ///< x, y, depth
        LagState<double> state;
        std::optional<Circle> circle;  ///< none for a straight move
        Edges edges;                   ///< at the end of the move; unknown if the mark is not near
        bool near = false;             ///< the mark is where it was
        double corner = 0.0;           ///< corner of the edges, as a share of the largest one allowed

        bool good() const { return near && corner <= 1.0; }
    };

    void accept(const Step& step, NewPoses& out) {
        const auto begin = Index(out.poses.size());
        if (step.circle) {
            const Circle& circle = *step.circle;
            const int n = circle.poses();
            for (int k = 1; k < n; ++k) {
                const Vector2d on =
                    circle.centre + rotated<double>(Vector2d(position_.head<2>() - circle.centre), circle.turn * k / n);
                out.poses.emplace_back(on.x(), on.y(), -position_.z());
            }
            out.arcs.push_back({begin, begin + n, circle.centre, circle.turn > 0.0 ? 1 : -1});
            last_move_ << circle.along(step.to.head<2>()), 0.0;
        } else {
            last_move_ = step.to - position_;
        }
        out.poses.emplace_back(step.to.x(), step.to.y(), -step.to.z());
        position_ = step.to;
        state_ = step.state;
        edges_ = step.edges;
    }

    /// Find how far one straight move can go: to a pose, or to a place near one. Chords are inside a curve, and the
    /// brush follows their mean. With ends moved out by q'' L^2 / 12 the mean error is zero. The remaining error
    /// alternates too quickly for the brush. Where the curve changes on the way, a larger or smaller offset is better.
    std::pair<Index, Step> farthest_straight(Index i, Index stride) const {
        Index good = i;
        Step best;
        for (double share : kEndOffsets) {
            const auto trial = [&](Index j) { return straight(i, j, offset_end(i, j, share)); };
            search(i, last_, good == i ? stride : 1, trial, good, best);
        }
        if (good > i) return {good, best};
        // no step keeps the direction: take the step that bends least
        good = i + 1;
        best = straight(i, good, original_.pose(good));
        for (Index j = i + 1; j <= std::min(i + kMaxTries, last_); ++j)
            for (double share : kEndOffsets) {
                const Step trial = straight(i, j, offset_end(i, j, share));
                if (!trial.near || (best.near && trial.corner >= best.corner)) continue;
                good = j;
                best = trial;
            }
        return {good, best};
    }
    /// Find how far one arc can go, through three places of the path.
    std::pair<Index, Step> farthest_round(Index i, Index straight_to) const {
        Index good = i;
        Step best;
        if (std::abs(position_.z() - original_.depth[i]) > kMaxDepthDifferenceMm) return {good, best};
        const auto trial = [&](Index j) { return round(i, j); };
        const Index level = std::min(last_, original_.level[i]);
        if (level > i) search(i, level, std::max<Index>(4, 2 * (straight_to - i)), trial, good, best);
        return {good, best};
    }

    /// Find the farthest good step beyond the known one: double the stride while steps are good, then bisect between
    /// the last good and the first bad step.
    template <class Trial>
    void search(Index i, Index last, Index step, Trial&& trial, Index& good, Step& best) const {
        Index bad = last + 1;
        const auto is_good = [&](Index j) {
            const Step found = trial(j);
            if (!found.good()) {
                bad = j;
                return false;
            }
            good = j;
            best = found;
            return true;
        };
        for (Index j = std::min(good + step, last); j > good && is_good(j); j = std::min(good + step, last)) step *= 2;
        if (good == i)
            while (bad - i > 1 && bad <= last && !is_good(i + (bad - i) / 2)) {
            }
        while (good > i && bad - good > 1 && good < last) is_good(good + (bad - good) / 2);
    }

    Vector3d offset_end(Index i, Index j, double share) const {
        const Vector3d here = original_.pose(j);
        const double h =
            std::min(0.5 * (original_.along[j] - original_.along[i]), original_.along[last_] - original_.along[j]);
        if (!(h > 0.0)) return here;
        const Vector3d bends =
            original_.at(original_.along[j] - h, j) - 2.0 * here + original_.at(original_.along[j] + h, j);
        Vector3d to = here - share * Vector3d(bends.x(), bends.y(), kDepthOffsetShare * bends.z());
        to.z() = std::clamp(to.z(), std::min(here.z(), kMinPressedDepthMm), original_.deepest);
        return to;
    }

    Step straight(Index i, Index j, const Vector3d& to) const {
        Step step;
        step.to = to;
        const Move<double> move(position_.head<2>(), to.head<2>(), position_.z(), to.z());
        if (!(move.length > kMinMoveMm)) return step;
        if (j > i + 1 && turn_to(to - position_) > kMaxTurnRad) return step;
        follow(move, i, j, move.depth_by / move.length, step);
        return step;
    }
    Step round(Index i, Index j) const {
        Step step;
        step.to = original_.pose(j);
        const Vector2d from = position_.head<2>(), to = step.to.head<2>();
        const Vector2d middle = original_.at(0.5 * (original_.along[i] + original_.along[j]), (i + j) / 2).head<2>();
        step.circle = Circle::through(from, middle, to);
        if (!step.circle) return step;
        const Vector2d along = step.circle->along(from);
        if (turn_to({along.x(), along.y(), 0.0}) > kMaxTurnRad) return step;
        follow(ArcMove<double>(from, along, step.circle->radius, step.circle->turn, position_.z()), i, j, 0.0, step);
        return step;
    }
    double turn_to(const Vector3d& along) const {
        return std::atan2(last_move_.cross(along).norm(), last_move_.dot(along));
    }

    /// Simulate the brush on a move that replaces the moves from pose i to pose j.
    template <class Motion>
    void follow(const Motion& move, Index i, Index j, double deeper, Step& step) const {
        checkpoint(10);
        step.state = state_;
        bool good = true;
        // a pen smooths nothing: every pose may be a spike of its own
        const Index stride = law_.rigid ? 1 : std::max<Index>(1, (j - i) / kCheckedPoses);
        Index k = i + 1;
        const double from = original_.along[i], length = original_.along[j] - from;
        advance(law_, move, step.state,
                [&](const auto& piece, const auto& mv, const auto& start, double begin, double end) {
                    good = good && start.taut;
                    while (good && k <= j) {
                        const double t = (original_.along[k] - from) / length;
                        if (t > end + 1e-12) break;
                        const double at = std::min(t, end);
                        const LagState<double> now =
                            law_.rigid ? rigid(mv, at) : state_in_phase(piece, mv, start, begin, at);
                        good = is_near(now, mv.depth(at), k, k < j ? tolerance_ : kEndToleranceShare * tolerance_);
                        k = k < j ? std::min(k + stride, j) : j + 1;
                    }
                });
        step.near = good && step.state.taut;
        if (!step.near) return;
        const LagState<double> begins = law_.rigid ? rigid(move, 0.0) : state_;
        if (law_.rigid) step.state = rigid(move, 1.0);
        const Edges leaving = edges_of(brush_, law_, begins, move.direction(0.0), position_.z(), deeper);
        step.edges = edges_of(brush_, law_, step.state, move.direction(1.0), step.to.z(), deeper);
        step.corner = std::max(corner_between(edges_, leaving) / kMaxEdgeCornerRad,
                               corner_between(step.edges, original_.reaching[j]) / kMaxEdgeDeviationRad);
    }
    template <class Motion>
    static LagState<double> rigid(const Motion& move, double t) {
        LagState<double> state;
        state.taut = state.heading_known = true;
        state.contact = move.tcp(t);
        state.heading = move.direction(t);
        return state;
    }

    /// Return whether the footprint is where it was near pose k, within the tolerance.
    bool is_near(const LagState<double>& now, double depth, Index k, double tolerance_mm) const {
        const Vector2d middle = now.contact + brush_.lever_to_widest(depth) * now.heading;
        const double most_slip = kMaxSlipTolerances * tolerance_;
        if ((middle - original_.middle.row(k).transpose()).squaredNorm() > most_slip * most_slip) return false;
        double least = 1e300;
        for (Index i = std::max(first_, k - 2); i < std::min(last_, k + 2); ++i) {
            const Vector2d a = original_.middle.row(i).transpose(), d = original_.middle.row(i + 1).transpose() - a;
            const double squared = d.squaredNorm();
            const double t = squared > 0.0 ? std::clamp((middle - a).dot(d) / squared, 0.0, 1.0) : 0.0;
            least = std::min(least, (middle - a - t * d).squaredNorm());
        }
        if (least > tolerance_mm * tolerance_mm) return false;
        if (std::abs(brush_.half_width(depth) - brush_.half_width(original_.depth[k])) > tolerance_mm) return false;
        if (law_.rigid) return true;
        const Vector2d& u = original_.heading[k];
        const double turned = std::abs(u.x() * now.heading.y() - u.y() * now.heading.x());
        return turned * brush_.tip_to_widest(depth) <= kMaxTipTolerances * tolerance_ && u.dot(now.heading) > 0.0;
    }

    const TracedPass& original_;
    const Brush& brush_;
    const LagLaw<double>& law_;
    double tolerance_;
    Index first_ = 0, last_ = 0;
    LagState<double> state_;
    Vector3d position_, last_move_;  ///< where the walk is, and the move that reached it
    Edges edges_;                    ///< edges of the mark at that place
};

Pass simplify(const Pass& pass, const Brush& brush, const LagLaw<double>& law, const TracedPass& original,
              double tolerance_mm) {
    const Index n = pass.poses_mm.rows();
    std::vector<Vector3d> poses;
    std::vector<Index> now(n, 0);  // new indices of the poses that stay
    const auto keep = [&](Index i) {
        now[i] = Index(poses.size());
        poses.push_back(pass.poses_mm.row(i).transpose());
    };
    Pass out = pass;
    out.tool_axes.resize(0, 3);  // upright, as are all passes that are simplified
    out.arcs.clear();
    PathSimplifier simplifier(original, brush, law, tolerance_mm);
    for (Index i = 0; i < n;) {
        keep(i);
        Index end = i;
        if (original.taut[i] || brush.is_rigid())
            while (original.dragged[end]) ++end;
        if (end < i + 2) {
            ++i;
            continue;
        }
        NewPoses new_poses = simplifier(i, end);
        for (Arc& arc : new_poses.arcs) {
            arc.first += now[i];
            arc.last += now[i];
            out.arcs.push_back(arc);
        }
        poses.insert(poses.end(), new_poses.poses.begin(), new_poses.poses.end() - 1);
        i = end;
    }
    out.poses_mm.resize(Index(poses.size()), 3);
    for (Index i = 0; i < out.poses_mm.rows(); ++i) out.poses_mm.row(i) = poses[i].transpose();
    for (Arc arc : pass.arcs) {
        arc.first = now[arc.first];
        arc.last = now[arc.last];
        out.arcs.push_back(arc);
    }
    std::sort(out.arcs.begin(), out.arcs.end(), [](const Arc& a, const Arc& b) { return a.first < b.first; });
    return out;
}

/// Return the largest distance of the widest points of a mark from the middle of another mark. Only rows from the first
/// taut row to the last count.
double largest_distance_mm(const PassMarks& marks, const Ring& widest, const Ring& middle) {
    NearestOnPolyline<Ring> nearest(middle);
    const Index n = Index(marks.taut.size());
    Index begin = 0, end = n;
    while (begin < end && !marks.taut[begin]) ++begin;
    while (end > begin && !marks.taut[end - 1]) --end;
    double largest = 0.0;
    visit_along(widest, begin, end, 0.5,
                [&](const Vector2d& point) { largest = std::max(largest, nearest.distance(point)); });
    return largest;
}

}  // namespace

Pass simplify_pass(const Pass& pass, const Brush& brush, double tolerance_mm) {
    refuse_tilted(pass, "only paths of an upright brush can be simplified");
    require_tolerance(tolerance_mm, pass.stroke);
    const double exact_mm = std::min(0.02, 0.1 * tolerance_mm);
    const PassMarks marks = simulate(pass, brush, exact_mm, false);
    if (pass.poses_mm.rows() < 4) return pass;
    const Ring middle = widest_points(marks, brush);
    const LagLaw<double> law = make_law(pieces(brush.lag, 0.0, brush.depth_range_mm[1]));
    const TracedPass original(pass, brush, law, marks, middle);
    // errors of single moves add up over a bend and at the ends, so smaller shares are tried where the sum is too large
    for (const double share : {0.95, 0.7, 0.4, 0.2, 0.1}) {
        const Pass trial = simplify(pass, brush, law, original, share * tolerance_mm);
        const PassMarks now = simulate(trial, brush, exact_mm, false);
        const Ring there = widest_points(now, brush);
        // check both ways: a mark that lacks a part is never far from the original mark, but the original is far from
        // it
        if (largest_distance_mm(now, there, middle) <= tolerance_mm &&
            largest_distance_mm(marks, middle, there) <= tolerance_mm)
            return trial;
    }
    return pass;
}

}  // namespace brushsvg
