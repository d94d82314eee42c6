#include "inverse/traced_pass.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "brushsvg/simulate.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// A move shorter than this [mm] has no meaningful direction.
constexpr double kMinMoveMm = 1e-6;
/// Least advance of an edge that shows, per mm of the TCP's way. An edge that advances less is about to turn back, and
/// where it does it is inside the mark.
constexpr double kMinEdgeAdvance = 0.01;
/// Largest corner between chords of a bend [rad]. A larger corner was drawn, or is made by the brush.
constexpr double kMaxBendRad = 0.14;
/// Half the step of a numerical derivative by depth [mm].
constexpr double kSlopeHalfStepMm = 1e-4;

template <class Of>
double slope(const Of& law, double depth_mm) {
    const double from = std::max(0.0, depth_mm - kSlopeHalfStepMm), to = depth_mm + kSlopeHalfStepMm;
    return (law(to) - law(from)) / (to - from);
}

Vector2d bisector(const Vector2d& a, const Vector2d& b) { return a.normalized() + b.normalized(); }

}  // namespace

Edges edges_of(const Brush& brush, const LagLaw<double>& law, const LagState<double>& state, const Vector2d& along,
               double depth_mm, double deeper) {
    const Vector2d& u = state.heading;
    const Vector2d across(-u.y(), u.x());
    const double r = law.at(depth_mm), wider = slope(brush.half_width, depth_mm) * deeper;
    const double turn = law.rigid || !(r > 0.0) ? 0.0 : along.dot(across) / r;
    const auto lever = [&](double d) { return brush.lever_to_widest(d) - (law.rigid ? 0.0 : law.at(d)); };
    const double ahead = along.dot(u) + slope(lever, depth_mm) * deeper;
    Edges edges;
    for (int side : {0, 1}) {
        const double sign = side ? -1.0 : 1.0;
        const double forwards = ahead - sign * brush.half_width(depth_mm) * turn;
        edges.direction[side] = forwards * u + (brush.lever_to_widest(depth_mm) * turn + sign * wider) * across;
        edges.is_visible[side] = forwards > kMinEdgeAdvance;
    }
    return edges;
}

double corner_between(const Edges& before, const Edges& after) {
    double greatest = 0.0;
    for (int side : {0, 1}) {
        if (!before.is_visible[side] || !after.is_visible[side]) continue;
        const Vector2d &a = before.direction[side], &b = after.direction[side];
        greatest = std::max(greatest, std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b))));
    }
    return greatest;
}

TracedPass::TracedPass(const Pass& pass, const Brush& brush, const LagLaw<double>& law, const PassMarks& marks,
                       const Ring& widest) {
    const Index n = pass.poses_mm.rows();
    tcp = pass.poses_mm.leftCols<2>();
    middle.resize(n, 2);
    depth.resize(n);
    along.assign(n, 0.0);
    contact.resize(n);
    heading.resize(n);
    taut.assign(n, false);
    dragged.assign(n, true);
    trace(marks, widest);
    for (Index i = 0; i < n; ++i) {
        depth[i] = -pass.poses_mm(i, 2);
        deepest = std::max(deepest, depth[i]);
        if (i > 0) along[i] = along[i - 1] + (tcp.row(i) - tcp.row(i - 1)).norm();
    }
    for (Index i = 0; i + 1 < n; ++i)
        if (!(along[i + 1] - along[i] > kMinMoveMm) || depth[i] <= 0.0 || depth[i + 1] <= 0.0) dragged[i] = false;
    if (n > 0) dragged[n - 1] = false;
    for (const Arc& arc : pass.arcs)
        for (Index i = arc.first; i < arc.last; ++i) dragged[i] = false;
    level.resize(n);
    for (Index i = n; i-- > 0;) level[i] = i + 1 < n && depth[i + 1] == depth[i] ? level[i + 1] : i;
    find_edges(brush, law);
}

void TracedPass::trace(const PassMarks& marks, const Ring& widest) {
    const Index n = tcp.rows();
    for (std::size_t row = 0; row < marks.pose.size(); ++row) {
        const double pose = marks.pose[row];
        const Index i = Index(std::floor(pose));
        const bool is_pose = pose == double(i);
        if (!marks.taut[row]) {  // both the move that reaches this pose and the move that leaves it
            if (i < n) dragged[i] = false;
            if (is_pose && i > 0) dragged[i - 1] = false;
        }
        if (!is_pose) continue;
        middle.row(i) = widest.row(Index(row));
        contact[i] = marks.contact_mm.row(Index(row)).transpose();
        heading[i] = {std::cos(marks.heading_rad[row]), std::sin(marks.heading_rad[row])};
        taut[i] = marks.taut[row];
    }
}

void TracedPass::find_edges(const Brush& brush, const LagLaw<double>& law) {
    const Index n = tcp.rows();
    reaching.resize(n);
    leaving.resize(n);
    const auto edges_at = [&](Index at, Index move) {
        const Vector3d way = pose(move + 1) - pose(move);
        LagState<double> state;
        const Vector2d along_it = way.head<2>().normalized();
        state.heading = law.rigid ? along_it : heading[at];
        return edges_of(brush, law, state, along_it, depth[at], way.z() / way.head<2>().norm());
    };
    for (Index i = 0; i < n; ++i) {
        const bool reached = i > 0 && dragged[i - 1];
        if (dragged[i]) leaving[i] = edges_at(i, i);
        if (reached) reaching[i] = edges_at(i, i - 1);
        if (!dragged[i] || !reached || corner_between(reaching[i], leaving[i]) > kMaxBendRad) continue;
        for (int side : {0, 1}) {
            const Vector2d mean = bisector(reaching[i].direction[side], leaving[i].direction[side]);
            reaching[i].direction[side] = leaving[i].direction[side] = mean;
        }
    }
}

Vector3d TracedPass::at(double s, Index near) const {
    Index i = near;
    while (i > 0 && along[i] > s) --i;
    while (i + 2 < tcp.rows() && along[i + 1] < s) ++i;
    const double step = along[i + 1] - along[i], t = step > 0.0 ? (s - along[i]) / step : 0.0;
    return pose(i) + t * (pose(i + 1) - pose(i));
}

}  // namespace brushsvg
