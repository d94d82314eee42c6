#include "brushsvg/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "brushsvg/error.hpp"
#include "brushsvg/lag.hpp"

namespace brushsvg {
namespace {

/// The footprint's bounding box about the contact, for the sampling: how far back, forward and to the sides it reaches.
struct Extents {
    std::vector<double> depth, front, half_width;

    explicit Extents(const Brush& brush) {
        depth.push_back(0.0);
        front.push_back(0.0);
        half_width.push_back(0.0);
        for (const Footprint& shape : brush.footprints.dragged) {
            depth.push_back(shape.depth_mm);
            front.push_back(shape.outline_mm.col(0).maxCoeff());
            half_width.push_back(shape.outline_mm.col(1).maxCoeff());
        }
    }
    std::array<double, 2> at(double d) const {
        const std::size_t i = std::upper_bound(depth.begin(), depth.end(), d) - depth.begin();
        if (i >= depth.size()) return {front.back(), half_width.back()};
        const double c = (d - depth[i - 1]) / (depth[i] - depth[i - 1]);
        return {front[i - 1] + c * (front[i] - front[i - 1]), half_width[i - 1] + c * (half_width[i] - half_width[i - 1])};
    }
};

class Tracer {
   public:
    Tracer(const Brush& brush, double tolerance_mm, PassMarks& out)
        : brush_(brush), law_(make_law(pieces(brush.lag, brush.depth_range_mm[0], brush.depth_range_mm[1]))),
          extents_(brush), tolerance_(tolerance_mm), out_(out) {}

    /// Poses index and fractions of the following moves: pose + scale * t.
    void place(double pose, double scale) {
        pose_ = pose;
        scale_ = scale;
    }
    void touch(const Vec2<double>& q) {
        state_ = touch_down<double>(q);
        if (heading_known_once_) state_.heading = last_heading_;
    }
    void row_now(const Vec2<double>& q, double depth, double t) {
        const double r = law_.at(depth);
        const bool taut = state_.taut || law_.rigid;
        add(t, q, depth, state_, taut || r <= 0.0 ? 1.0 : std::min(1.0, (q - state_.contact).norm() / r));
    }
    void lifted(const Vec2<double>& q, double z, double t) {
        LagState<double> away = state_;
        away.contact = q;
        away.taut = false;
        add(t, q, -z, away, 0.0);
    }
    void move(const Move<double>& m) {
        advance(law_, m, state_, [&](const auto& piece, const auto& mv, const auto& start, double begin, double end) {
            sample(piece, mv, start, begin, end);
        });
        if (state_.heading_known || state_.taut) note_heading(state_.heading);
        row_now(m.tcp(1.0), m.depth(1.0), 1.0);
    }
    bool deeper_than_allowed(double depth) const { return depth > brush_.depth_range_mm[1] + 1e-9; }
    double first_heading() const { return first_heading_; }
    std::size_t rows_before_heading() const { return rows_before_heading_; }

   private:
    struct Corners {
        Eigen::Matrix<double, 2, 4> points;
        Vec2<double> heading;
        double depth;
        LagState<double> state;
    };

    template <class Piece>
    Corners corners(const Piece& piece, const Move<double>& m, const LagState<double>& start, double begin, double t) const {
        Corners c;
        if (law_.rigid) {
            c.state = start;
            c.state.contact = m.tcp(t);
        } else {
            c.state = within_phase(piece, m, start, begin, t);
        }
        c.depth = m.depth(t);
        const double b = brush_.tip_gap(c.depth);
        const auto [front, half] = extents_.at(c.depth);
        const Vec2<double> u = c.state.heading, n(-u.y(), u.x());
        const Vec2<double> tip = c.state.contact - b * u;
        c.heading = u;
        c.points << tip + half * n, tip - half * n, tip + front * u + half * n, tip + front * u - half * n;
        return c;
    }

    template <class Piece>
    void sample(const Piece& piece, const Move<double>& m, const LagState<double>& start, double begin, double end) {
        if (begin > 0.0) {
            // the state at an event stands as a row of its own
            row(m, start, begin);
        }
        if (start.heading_known || start.taut) note_heading(start.heading);
        // straight out from the contact the heading is the direction of motion from the first instant
        LagState<double> from = start;
        if (!from.taut && !from.heading_known && m.length > 0.0) from.heading = m.along;
        const Corners a = corners(piece, m, from, begin, begin), b = corners(piece, m, start, begin, end);
        split(piece, m, start, begin, begin, a, end, b, 0);
    }

    template <class Piece>
    void split(const Piece& piece, const Move<double>& m, const LagState<double>& start, double begin, double ta,
               const Corners& a, double tb, const Corners& b, int level) {
        if (level >= 40) return;
        const double tm = 0.5 * (ta + tb);
        const Corners c = corners(piece, m, start, begin, tm);
        const double bend = (c.points - 0.5 * (a.points + b.points)).colwise().norm().maxCoeff();
        const bool turned = a.heading.dot(b.heading) < 0.8;  // a chord of the motion says nothing of a wide turn
        if (bend <= tolerance_ && !(turned && level < 24)) return;
        split(piece, m, start, begin, ta, a, tm, c, level + 1);
        row(m, c.state, tm);
        split(piece, m, start, begin, tm, c, tb, b, level + 1);
    }

    void row(const Move<double>& m, const LagState<double>& state, double t) {
        const double depth = m.depth(t), r = law_.at(depth);
        const Vec2<double> q = m.tcp(t);
        if (state.heading_known || state.taut) note_heading(state.heading);
        add(t, q, depth, state, state.taut || r <= 0.0 ? 1.0 : std::min(1.0, (q - state.contact).norm() / r));
    }

    void add(double t, const Vec2<double>& q, double depth, const LagState<double>& state, double pull) {
        out_.pose.push_back(pose_ + scale_ * t);
        tcp_.insert(tcp_.end(), {q.x(), q.y()});
        contact_.insert(contact_.end(), {state.contact.x(), state.contact.y()});
        out_.heading_rad.push_back(std::atan2(state.heading.y(), state.heading.x()));
        out_.depth_mm.push_back(depth);
        out_.taut.push_back(state.taut ? 1 : 0);
        out_.pull.push_back(pull);
    }

    void note_heading(const Vec2<double>& u) {
        if (!heading_known_once_) {
            first_heading_ = std::atan2(u.y(), u.x());
            rows_before_heading_ = out_.pose.size();
            heading_known_once_ = true;
        }
        last_heading_ = u;
    }

   public:
    void finish() {
        const Eigen::Index n = Eigen::Index(out_.pose.size());
        out_.tcp_mm = Eigen::Map<const Ring>(tcp_.data(), n, 2);
        out_.contact_mm = Eigen::Map<const Ring>(contact_.data(), n, 2);
        if (heading_known_once_)
            std::fill_n(out_.heading_rad.begin(), rows_before_heading_, first_heading_);
    }

   private:
    const Brush& brush_;
    LagLaw<double> law_;
    Extents extents_;
    double tolerance_;
    PassMarks& out_;
    LagState<double> state_;
    std::vector<double> tcp_, contact_;
    double pose_ = 0.0, scale_ = 1.0;
    Vec2<double> last_heading_ = Vec2<double>(1.0, 0.0);
    double first_heading_ = 0.0;
    std::size_t rows_before_heading_ = 0;
    bool heading_known_once_ = false;
};

void refuse_bad_poses(const Pass& pass, const Brush& brush) {
    for (Eigen::Index i = 0; i < pass.poses_mm.rows(); ++i) {
        if (!pass.poses_mm.row(i).allFinite())
            throw Error("pose " + std::to_string(i) + " has a coordinate that is not finite", pass.stroke);
        const double depth = -pass.poses_mm(i, 2);
        if (depth > brush.depth_range_mm[1] + 1e-9) {
            char text[200];
            std::snprintf(text, sizeof text, "depth %.3f mm of pose %ld is outside the range [%.1f, %.1f] mm of brush ", depth,
                          long(i), brush.depth_range_mm[0], brush.depth_range_mm[1]);
            throw Error(text + brush.name, pass.stroke, depth, brush.depth_range_mm);
        }
    }
}

}  // namespace

PassMarks simulate(const Pass& pass, const Brush& brush, double tolerance_mm) {
    refuse_bad_poses(pass, brush);
    PassMarks marks;
    marks.stroke = pass.stroke;
    Tracer tracer(brush, tolerance_mm, marks);
    const Eigen::Index n = pass.poses_mm.rows();
    if (n == 0) {
        tracer.finish();
        return marks;
    }
    const auto q = [&](Eigen::Index i) -> Vec2<double> { return pass.poses_mm.row(i).head<2>().transpose(); };
    const auto z = [&](Eigen::Index i) { return pass.poses_mm(i, 2); };

    // a pass that begins below the paper's surface is set down on the spot, one that ends there lifted on the spot
    tracer.place(0.0, 0.0);
    if (z(0) > 0.0) {
        tracer.lifted(q(0), z(0), 0.0);
    } else {
        tracer.touch(q(0));
        tracer.row_now(q(0), 0.0, 0.0);
        if (z(0) < 0.0) tracer.move(Move<double>(q(0), q(0), 0.0, -z(0)));
    }
    for (Eigen::Index i = 0; i + 1 < n; ++i) {
        const Vec2<double> a = q(i), b = q(i + 1);
        const double za = z(i), zb = z(i + 1);
        if (za <= 0.0 && zb <= 0.0) {
            tracer.place(double(i), 1.0);
            tracer.move(Move<double>(a, b, -za, -zb));
        } else if (za > 0.0 && zb > 0.0) {
            tracer.place(double(i), 1.0);
            tracer.lifted(b, zb, 1.0);
        } else {
            const double t = za / (za - zb);
            const Vec2<double> c = a + t * (b - a);
            if (za > 0.0) {
                tracer.place(double(i) + t, 1.0 - t);
                tracer.touch(c);
                tracer.row_now(c, 0.0, 0.0);
                if (zb < 0.0) tracer.move(Move<double>(c, b, 0.0, -zb));
            } else {
                tracer.place(double(i), t);
                if (t > 0.0) tracer.move(Move<double>(a, c, -za, 0.0));
                tracer.place(double(i), 1.0);
                tracer.lifted(b, zb, 1.0);
            }
        }
    }
    tracer.place(double(n - 1), 0.0);
    if (z(n - 1) < 0.0) tracer.move(Move<double>(q(n - 1), q(n - 1), -z(n - 1), 0.0));
    tracer.finish();
    return marks;
}

Marks simulate(const Plan& plan, const Brush& brush, double tolerance_mm) {
    Marks marks;
    marks.passes.reserve(plan.passes.size());
    for (const Pass& pass : plan.passes) marks.passes.push_back(simulate(pass, brush, tolerance_mm));
    return marks;
}

Ring widest_points(const PassMarks& marks, const Brush& brush) {
    Ring points = marks.contact_mm;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const double e = brush.lever_to_widest(std::max(0.0, marks.depth_mm[i]));
        points(i, 0) += e * std::cos(marks.heading_rad[i]);
        points(i, 1) += e * std::sin(marks.heading_rad[i]);
    }
    return points;
}

}  // namespace brushsvg
