#include "brushsvg/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/format_text.hpp"
#include "base/tolerance.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/lag.hpp"
#include "marks/pass_walk.hpp"
#include "values/require_usable.hpp"

namespace brushsvg {
namespace {

/// Most rows of a pass. Real passes have one to twenty rows per pose; landings have some hundred.
constexpr std::size_t kMaxRows = 1000000, kMaxRowsPerPose = 100;

/// Extents of the footprint by depth, for the sampling: how far it reaches forward and to the sides.
struct Extents {
    std::vector<double> depth, front, half_width;

    explicit Extents(const Brush& brush) {
        depth.push_back(0.0);
        front.push_back(0.0);
        half_width.push_back(0.0);
        for (const auto* shapes : {&brush.footprints.dragged, &brush.footprints.pressed})
            for (const Footprint& shape : *shapes) depth.push_back(shape.depth_mm);
        std::sort(depth.begin(), depth.end());
        depth.erase(std::unique(depth.begin(), depth.end()), depth.end());
        for (std::size_t i = 1; i < depth.size(); ++i) {
            const Ring outline = footprint_at(brush.footprints, depth[i], 1.0);
            front.push_back(outline.col(0).maxCoeff());
            half_width.push_back(outline.col(1).maxCoeff());
        }
    }
    std::array<double, 2> at(double d) const {
        const std::size_t i = std::upper_bound(depth.begin(), depth.end(), d) - depth.begin();
        if (i >= depth.size()) return {front.back(), half_width.back()};
        const double c = (d - depth[i - 1]) / (depth[i] - depth[i - 1]);
        return {front[i - 1] + c * (front[i] - front[i - 1]),
                half_width[i - 1] + c * (half_width[i] - half_width[i - 1])};
    }
};

/// Poses nearer to each other on the paper than this [mm] are one place. Files are rounded to 1e-7 mm.
constexpr double kMaxOnTheSpotMm = 1e-6;

/// Tolerance of a pose index: rows at a pose have its index, up to the rounding of shares of a move.
constexpr double kPoseRounding = 1e-9;

/// The path of the place where the brush's axis meets the paper, q + d s. The patch trails this place, which moves
/// straight from pose to pose. An upright brush's axis is over its tip, so its path is that of the poses.
///
/// While its tip goes straight down on the paper, or up from it, a leaning brush's axis wanders over the paper. The
/// patch trails the axis from where it is at the deepest. Otherwise bristles that are pressed down would fall the way
/// that the brush leans, even if it leans only a little. Real strokes (benchmarks/real_paint.py --tilt) fit worse so.
struct AxisPath {
    Ring lean{0, 2};  ///< per pose, s = (a_x, a_y) / a_z of the tool axis a; empty: upright
    Poses poses_mm;

    explicit AxisPath(const Pass& pass) : poses_mm(pass.poses_mm) {
        if (pass.poses_mm.rows() == 0 || !is_tilted(pass)) return;
        const Poses& tip = pass.poses_mm;
        const Eigen::Index last = tip.rows() - 1;
        lean = pass.tool_axes.leftCols<2>().array().colwise() / pass.tool_axes.col(2).array();
        const Ring axis = tip.leftCols<2>().array() - lean.array().colwise() * tip.col(2).array();
        poses_mm.leftCols<2>() = axis;
        // direction from pose i to the next one: 1 up on the spot, -1 down on the spot, 0 otherwise
        const auto vertical_direction = [&](Eigen::Index i) {
            const Eigen::RowVector3d way = tip.row(i + 1) - tip.row(i);
            return way.head<2>().norm() > kMaxOnTheSpotMm ? 0 : (way.z() > 0.0) - (way.z() < 0.0);
        };
        const auto hold = [&](Eigen::Index from, Eigen::Index to, Eigen::Index deepest) {
            for (Eigen::Index i = from; i <= to; ++i) poses_mm.row(i).head<2>() = axis.row(deepest);
        };
        for (Eigen::Index i = 0; i <= last; ++i) {
            Eigen::Index deepest = i;
            if (tip(i, 2) >= 0.0 || i == last) {
                while (deepest > 0 && vertical_direction(deepest - 1) > 0) --deepest;
                hold(deepest, i, deepest);
            }
            deepest = i;
            if (tip(i, 2) >= 0.0 || i == 0) {
                while (deepest < last && vertical_direction(deepest) < 0) ++deepest;
                if (deepest > i) hold(i, deepest, deepest);
            }
        }
    }
};

class Tracer {
 public:
    Tracer(const Brush& brush, double tolerance_mm, bool for_outlines, const Window* window, const Pass& pass,
           const AxisPath& way, PassMarks& out)
        : brush_(brush),
          window_(window),
          lean_(way.lean),
          law_(make_law(pieces(brush.lag, 0.0, brush.depth_range_mm[1]))),
          extents_(brush),
          tolerance_(tolerance_mm),
          for_outlines_(for_outlines),
          max_rows_(kMaxRows + kMaxRowsPerPose * std::size_t(pass.poses_mm.rows())),
          poses_mm_(pass.poses_mm),
          out_(out) {
        kinks_ = extents_.depth;
        for (const Profile* profile : {&brush.tip_gap, &brush.tip_to_widest})
            for (const auto& piece : pieces(*profile, 0.0, brush.depth_range_mm[1])) kinks_.push_back(piece.lo);
    }

    bool is_done() const { return false; }
    void begin_above(const Vec2<double>& q, double height) {
        place(0.0, 0.0);
        add_lifted_row(q, height, 0.0);
    }
    void above(Eigen::Index i, const AboveStretch<double>& stretch, double, bool touches) {
        if (touches) return;
        place(double(i), 1.0);
        add_lifted_row(stretch.to, -stretch.depth_to, 1.0);
    }
    void touch(Eigen::Index i, double at, const Vec2<double>& q) {
        place(double(i) + at, 0.0);
        state_ = touch_down<double>(q);
        state_.heading = last_heading_;
        // before any motion the first rows wait for a heading too
        if (moved_once_) first_row_ = out_.pose.size();
        moved_ = false;
        row(q, 0.0, state_, 0.0);
    }
    template <class Motion>
    void move(const Motion& m, Eigen::Index i, double begin, double end) {
        place(double(i) + begin, end - begin);
        advance(law_, m, state_, [&](const auto& piece, const auto& mv, const auto& start, double from, double until) {
            sample(piece, mv, start, from, until);
        });
        row(m.tcp(1.0), m.depth(1.0), state_, 1.0);
    }
    void finish() {
        const Eigen::Index n = Eigen::Index(out_.pose.size());
        out_.tcp_mm = Eigen::Map<const Ring>(tcp_.data(), n, 2);
        out_.contact_mm = Eigen::Map<const Ring>(contact_.data(), n, 2);
        if (lean_.rows() == 0) return;
        out_.lean_mm_per_mm.resize(n, 2);
        // the path followed is that of the axis on the paper, not of the tip
        for (Eigen::Index i = 0; i < n; ++i) {
            out_.tcp_mm.row(i) = between_poses(poses_mm_.leftCols<2>(), out_.pose[std::size_t(i)]);
            out_.lean_mm_per_mm.row(i) = between_poses(lean_, out_.pose[std::size_t(i)]);
        }
    }

 private:
    /// Set the pose indices of the following rows, with fractions: pose + scale * t.
    void place(double pose, double scale) {
        pose_ = pose;
        scale_ = scale;
    }
    void add_lifted_row(const Vec2<double>& q, double z, double t) {
        LagState<double> away = state_;
        away.contact = q;
        away.taut = false;
        add(t, q, -z, away, 0.0);
    }

    /// Interpolate a table with one row per pose, at an index with fractions.
    template <class Table>
    static Eigen::RowVector2d between_poses(const Table& table, double pose) {
        const auto i = std::min(Eigen::Index(pose), table.rows() - 1), next = std::min(i + 1, table.rows() - 1);
        const double share = pose - double(i);
        return (1.0 - share) * table.row(i) + share * table.row(next);
    }

    /// The footprint at one instant. Its corners are used to follow its motion.
    // stored by columns: x and y are read once for each normal
    using Columns = Eigen::Array<double, Eigen::Dynamic, 2>;
    struct Instant {
        LagState<double> state;
        double depth, pull;
        /// Stretch of a tilted brush's footprint, about the contact.
        Eigen::Matrix2d stretch = Eigen::Matrix2d::Identity();
        Eigen::Matrix<double, 2, 5> corners;  ///< corners of its bounding box, and the widest section's centre
        /// Filled in when needed: both halves of a motion use the outline at their common end.
        mutable Columns outline;
    };

    template <class Piece, class Motion>
    Instant instant(const Piece& piece, const Motion& m, const LagState<double>& start, double begin, double t) const {
        Instant now;
        if (law_.rigid) {
            now.state = start;
            now.state.contact = m.tcp(t);
            if (m.length > 0.0) now.state.heading = m.direction(t);
        } else {
            now.state = state_in_phase(piece, m, start, begin, t);
        }
        now.depth = m.depth(t);
        now.pull = pull_at(now.state, m.tcp(t), now.depth);
        const auto [front, half] = extents_.at(now.depth);
        const Vec2<double> u = now.state.heading, n(-u.y(), u.x()), tip = tip_of(now);
        now.corners << tip + half * n, tip - half * n, tip + front * u + half * n, tip + front * u - half * n,
            tip + brush_.tip_to_widest(now.depth) * u;
        if (lean_.rows() > 0) {
            now.stretch = stretch_of(between_poses(lean_, pose_ + scale_ * t));
            now.corners = (now.stretch * (now.corners.colwise() - now.state.contact)).colwise() + now.state.contact;
        }
        return now;
    }
    Vec2<double> tip_of(const Instant& now) const {
        return now.state.contact - brush_.tip_gap(now.depth) * now.state.heading;
    }

    template <class Piece, class Motion>
    void sample(const Piece& piece, const Motion& m, const LagState<double>& start, double begin, double end) {
        if (law_.rigid && !moved_) apply_heading(start);
        // a row for the event that begins this phase, or for a pen's turn
        if (begin > 0.0 || tightens_at_once(start) || turns_at_once(start, m.depth(begin)))
            row(m.tcp(begin), m.depth(begin), start, begin);
        // if the brush moves straight away from the contact, the heading is the direction of motion from the first
        // instant
        LagState<double> from = start;
        if (!from.taut && !from.heading_known && m.length > 0.0) from.heading = m.direction(begin);
        // outlines are blended between measured depths, and laws have kinks: there must be none between two rows
        std::vector<double> ends{end};
        for (double depth : kinks_) {
            const double t = (depth - m.depth_from) / m.depth_by;
            if (m.depth_by != 0.0 && t > begin + 1e-12 && t < end - 1e-12) ends.push_back(t);
        }
        std::sort(ends.begin(), ends.end());
        Instant a = instant(piece, m, from, begin, begin);
        double ta = begin;
        for (double tb : ends) {
            Instant b = instant(piece, m, start, begin, tb);
            if (!is_outside(a, b, m)) split(piece, m, start, begin, ta, a, tb, b, 0);
            if (tb < end) row(m.tcp(tb), m.depth(tb), b.state, tb);
            a = std::move(b);
            ta = tb;
        }
    }

    /// Return whether a footprint stays on one side of the window on its way from one instant to the next. At both
    /// instants it is within its corners. In between, no corner is off by more than twice the length of the way.
    template <class Motion>
    bool is_outside(const Instant& a, const Instant& b, const Motion& m) const {
        if (!window_ || !moved_) return false;
        const double about = 2.0 * (m.length + std::abs(m.depth_by) + tolerance_);
        const Vec2<double> low = a.corners.rowwise().minCoeff().cwiseMin(b.corners.rowwise().minCoeff()),
                           high = a.corners.rowwise().maxCoeff().cwiseMax(b.corners.rowwise().maxCoeff());
        return high.x() + about < window_->x_mm || low.x() - about > window_->x_mm + window_->width_mm + tolerance_ ||
               high.y() + about < window_->y_mm || low.y() - about > window_->y_mm + window_->height_mm + tolerance_;
    }

    /// Return whether the lever is taut at the start of a phase. A landing can end with the lever drawn out up to a
    /// rounding error. Then the brush is dragged from there, not from the next pose.
    bool tightens_at_once(const LagState<double>& start) const {
        return start.taut && start.heading_known && !law_.rigid && !out_.taut.back();
    }
    /// Return whether a pen turns here. Its heading changes to the next move without a transition. Without a second
    /// row, the turn would be spread over that move.
    bool turns_at_once(const LagState<double>& start, double depth) const {
        if (!law_.rigid || !moved_) return false;
        const auto [front, half] = extents_.at(depth);
        return (start.heading - last_heading_).norm() * std::max(front, half) > tolerance_;
    }

    template <class Piece, class Motion>
    void split(const Piece& piece, const Motion& m, const LagState<double>& start, double begin, double ta,
               const Instant& a, double tb, const Instant& b, int level) {
        if (level >= 40) return;
        const double tm = 0.5 * (ta + tb);
        const Instant c = instant(piece, m, start, begin, tm);
        const double bend = (c.corners - 0.5 * (a.corners + b.corners)).colwise().norm().maxCoeff();
        // a chord of the motion does not show a wide turn
        const bool turned = a.state.heading.dot(b.state.heading) < 0.8;
        const bool pressed = std::abs(a.depth - b.depth) > 0.5;  // nor does it show laws that bend twice
        if (bend <= tolerance_ && !((turned || pressed) && level < 24) && !(level < 12 && shape_bends(a, b, c))) return;
        split(piece, m, start, begin, ta, a, tm, c, level + 1);
        row(m.tcp(tm), m.depth(tm), c.state, tm);
        split(piece, m, start, begin, tm, c, tb, b, level + 1);
    }

    /// Return whether the outline half way differs by more than the tolerance from the mean of the outlines at both
    /// ends. Outlines are compared by their support functions h(n) = max n.v (Hausdorff distance of convex shapes).
    /// Only where they agree is the hull of both ends the area that they sweep.
    bool shape_bends(const Instant& a, const Instant& b, const Instant& c) const {
        if (!for_outlines_) return false;
        const bool grows = std::abs(a.depth - b.depth) > 0.1 || std::abs(a.pull - b.pull) > 0.05 ||
                           (a.stretch - b.stretch).cwiseAbs().maxCoeff() > 0.01;
        // a footprint that turns about a point of its flank leaves a waist that no hull has; while it is dragged
        // forwards the widest section has painted there before
        const bool turns_in_place = !a.state.taut && a.state.heading.dot(b.state.heading) < 1.0 - 1e-8;
        if (!grows && !turns_in_place) return false;
        // compare along the normals of the middle outline's edges: only long flanks show a difference
        const Columns &from = outline_of(a), &to = outline_of(b), &between = outline_of(c);
        const auto reach = [](const Columns& outline, const Vec2<double>& normal) {
            return (outline.col(0) * normal.x() + outline.col(1) * normal.y()).maxCoeff();
        };
        for (Eigen::Index k = 0, n = between.rows(); k < n; ++k) {
            const Eigen::Index j = k + 1 == n ? 0 : k + 1;
            const Vec2<double> edge = (between.row(j) - between.row(k)).matrix().transpose();
            const double length = edge.norm();
            if (length < 4.0 * tolerance_) continue;  // too short to open a gap of the tolerance
            const Vec2<double> normal(edge.y() / length, -edge.x() / length);
            const double mean = 0.5 * (reach(from, normal) + reach(to, normal));
            if (std::abs(reach(between, normal) - mean) > tolerance_) return true;
        }
        return false;
    }
    const Columns& outline_of(const Instant& now) const {
        if (now.outline.rows() == 0) now.outline = place_outline(now);
        return now.outline;
    }
    Ring place_outline(const Instant& now) const {
        const Vec2<double> u = now.state.heading, tip = tip_of(now);
        Eigen::Matrix2d turn;
        turn << u.x(), u.y(), -u.y(), u.x();
        const Ring upright = (footprint_at(brush_.footprints, now.depth, now.pull) * turn).rowwise() + tip.transpose();
        if (lean_.rows() == 0) return upright;
        const Eigen::RowVector2d contact = now.state.contact.transpose();
        return ((upright.rowwise() - contact) * now.stretch).rowwise() + contact;
    }

    /// Return r'/r, which is 1 when taut.
    double pull_at(const LagState<double>& state, const Vec2<double>& q, double depth) const {
        const double r = law_.at(depth);
        return state.taut || law_.rigid || r <= 0.0 ? 1.0 : std::min(1.0, (q - state.contact).norm() / r);
    }

    /// Give the first known heading to all rows since touch-down, or since the pass began. A pen is taut before it has
    /// a heading.
    void apply_heading(const LagState<double>& state) {
        if (!moved_ && (state.heading_known || (state.taut && !law_.rigid))) {
            std::fill(out_.heading_rad.begin() + first_row_, out_.heading_rad.end(),
                      std::atan2(state.heading.y(), state.heading.x()));
            moved_ = moved_once_ = true;
        }
        if (moved_) last_heading_ = state.heading;
    }

    void row(const Vec2<double>& q, double depth, const LagState<double>& state, double t) {
        apply_heading(state);
        add(t, q, depth, state, pull_at(state, q, depth));
    }

    void add(double t, const Vec2<double>& q, double depth, const LagState<double>& state, double pull) {
        checkpoint();
        if (out_.pose.size() >= max_rows_)
            throw Error("tolerance-too-fine",
                        "the mark of the pass needs more than " + std::to_string(max_rows_) +
                            " rows: use a larger tolerance, or split the pass",
                        out_.stroke, tolerance_);
        out_.pose.push_back(pose_ + scale_ * t);
        tcp_.insert(tcp_.end(), {q.x(), q.y()});
        contact_.insert(contact_.end(), {state.contact.x(), state.contact.y()});
        out_.heading_rad.push_back(std::atan2(state.heading.y(), state.heading.x()));
        out_.depth_mm.push_back(depth);
        out_.taut.push_back(state.taut ? 1 : 0);
        out_.pull.push_back(pull);
    }

    const Brush& brush_;
    const Window* window_;  ///< outside of it only the rows at ends are kept; none: keep all rows
    const Ring& lean_;      ///< lean at each pose; empty for an upright brush
    LagLaw<double> law_;
    Extents extents_;
    std::vector<double> kinks_;
    double tolerance_;
    bool for_outlines_;
    std::size_t max_rows_;
    const Poses& poses_mm_;
    PassMarks& out_;
    LagState<double> state_;
    std::vector<double> tcp_, contact_;
    double pose_ = 0.0, scale_ = 1.0;
    Vec2<double> last_heading_ = Vec2<double>(1.0, 0.0);
    std::size_t first_row_ = 0;  ///< first of the rows that wait for a heading
    bool moved_ = false, moved_once_ = false;
};

void require_valid_poses(const Pass& pass, const Brush& brush, bool may_rise) {
    for (Eigen::Index i = 0; i < pass.poses_mm.rows(); ++i) {
        if (!pass.poses_mm.row(i).allFinite())
            throw Error("not-finite", "pose " + std::to_string(i) + " has a coordinate that is not finite",
                        pass.stroke);
        const double largest = pass.poses_mm.row(i).cwiseAbs().maxCoeff();
        if (largest > kMaxCoordinateMm) {
            throw Error(
                "geometry-out-of-range",
                format_text("pose %ld has a coordinate of %.3g mm, outside the range [-1e6, 1e6] mm", long(i), largest),
                pass.stroke, largest, std::array<double, 2>{-kMaxCoordinateMm, kMaxCoordinateMm});
        }
        const double depth = -pass.poses_mm(i, 2);
        if (depth > brush.depth_range_mm[1] + 1e-9) {
            throw Error("depth-out-of-range",
                        format_text("depth %.3f mm of pose %ld is outside the range [%.1f, %.1f] mm of brush ", depth,
                                    long(i), brush.depth_range_mm[0], brush.depth_range_mm[1]) +
                            brush.name,
                        pass.stroke, depth, brush.depth_range_mm);
        }
    }
    const double lowest = pass.poses_mm.rows() > 0 ? pass.poses_mm.col(2).minCoeff() : 0.0;
    Eigen::Index highest = 0;
    if (lowest <= 0.0 && !may_rise && pass.poses_mm.rows() > 0 &&
        pass.poses_mm.col(2).maxCoeff(&highest) > kMaxOnTheSpotMm) {
        const double z = pass.poses_mm(highest, 2);
        throw Error("above-paper",
                    format_text("pose %ld is %.3g mm above the paper, but inside a pass z must be 0 or below: begin a "
                                "new pass where the brush is set down again",
                                long(highest), z),
                    pass.stroke, z, std::array<double, 2>{-std::numeric_limits<double>::infinity(), 0.0});
    }
    // all poses are above the paper: probably a wrong sign, because such a pass paints nothing
    if (lowest > 0.0) {
        throw Error(
            "never-pressed",
            format_text("the brush never touches the paper, because its lowest pose is %.3g mm above it: set z to the "
                        "negative depth",
                        lowest),
            pass.stroke, lowest);
    }
}

}  // namespace

namespace {

PassMarks simulate_pass(const Pass& pass, const Brush& brush, double tolerance_mm, bool for_outlines, bool may_rise,
                        const Window* window) {
    require_usable(brush);
    require_tolerance(tolerance_mm, pass.stroke);
    require_valid_poses(pass, brush, may_rise);
    for (std::size_t k = 0; k < pass.arcs.size(); ++k) check_arc(pass, k, pass.stroke);
    check_tool_axes(pass, pass.stroke);
    PassMarks marks;
    marks.stroke = pass.stroke;
    const AxisPath way(pass);
    Tracer tracer(brush, tolerance_mm, for_outlines, window, pass, way, marks);
    if (const Poses& poses = way.poses_mm; poses.rows() > 0) {
        if (poses(0, 2) > 0.0) tracer.begin_above(poses.row(0).head<2>().transpose(), poses(0, 2));
        walk_pass<double>(CommandedPath<double>{poses, pass.arcs, 0.0}, tracer);
    }
    tracer.finish();
    return marks;
}

}  // namespace

PassMarks simulate(const Pass& pass, const Brush& brush, double tolerance_mm, bool for_outlines, bool may_rise) {
    return simulate_pass(pass, brush, tolerance_mm, for_outlines, may_rise, nullptr);
}

PassMarks simulate_near(const Pass& pass, const Brush& brush, const Window& window, double tolerance_mm) {
    return simulate_pass(pass, brush, tolerance_mm, true, false, &window);
}

Marks simulate(const Plan& plan, const Brush& brush, double tolerance_mm) {
    Marks marks;
    marks.passes.reserve(plan.passes.size());
    for (const Pass& pass : plan.passes) marks.passes.push_back(simulate(pass, brush, tolerance_mm));
    return marks;
}

std::vector<std::size_t> pose_rows(const PassMarks& marks) {
    require_usable(marks);
    std::vector<std::size_t> rows;
    const auto is_at = [&](std::size_t row, std::size_t pose) {
        return std::abs(marks.pose[row] - double(pose)) <= kPoseRounding;
    };
    for (std::size_t row = 0; row < marks.pose.size(); ++row)
        if (is_at(row, rows.size())) rows.push_back(row);
    // if it is set down on the spot, the brush is at its first pose when it has reached its depth
    while (!rows.empty() && rows[0] + 1 < marks.pose.size() && is_at(rows[0] + 1, 0) &&
           marks.depth_mm[rows[0] + 1] > marks.depth_mm[rows[0]])
        ++rows[0];
    return rows;
}

Ring widest_points(const PassMarks& marks, const Brush& brush) {
    require_usable(marks);
    Ring points = marks.contact_mm;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const double e = brush.lever_to_widest(std::max(0.0, marks.depth_mm[i]));
        Eigen::RowVector2d away(e * std::cos(marks.heading_rad[i]), e * std::sin(marks.heading_rad[i]));
        if (marks.lean_mm_per_mm.rows() > 0) away *= stretch_of(marks.lean_mm_per_mm.row(i));
        points.row(i) += away;
    }
    return points;
}

std::vector<TurnOver> find_turn_overs(const PassMarks& marks) {
    require_usable(marks);
    std::vector<TurnOver> out;
    const std::size_t n = marks.taut.size();
    for (std::size_t i = 1; i < n; ++i) {
        if (marks.taut[i] || !marks.taut[i - 1]) continue;
        const std::size_t first = i;
        double least = marks.depth_mm[i];
        for (; i < n && !marks.taut[i]; ++i) least = std::min(least, marks.depth_mm[i]);
        if (i < n && least <= 0.5 * std::min(marks.depth_mm[first - 1], marks.depth_mm[i])) out.push_back({first, i});
    }
    return out;
}

}  // namespace brushsvg
