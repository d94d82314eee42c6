#include "mark_model.hpp"

#include <ceres/jet.h>

#include <cmath>

#include "bernstein.hpp"
#include "drop.hpp"
#include "trace.hpp"

namespace brushsvg::fit {
namespace {

constexpr int kMostTerms = 4;
using Jet = ceres::Jet<double, kMostTerms + 1>;  // the lag's unknowns and the height

// Footprints so close that the union of discs 0.5 mm wide scallops by 0.01 mm, wider ones by less.
constexpr double kStepMm = 0.2, kPressMm = 0.15;
constexpr double kAboveMm = 2.0;       // whence the brush comes: above any error of the paper's height
constexpr double kLeastLagMm = 0.02;   // a pen's; at 0 the law loses its derivatives
constexpr double kLeastHalfMm = 1e-4;  // at touch-down, where a drop without width would have no direction
constexpr double kLeastRingMm2 = 0.2;  // specks

double at(const std::vector<double>& c, double d) {
    double y = 0.0;
    for (std::size_t i = c.size(); i-- > 0;) y = y * d + c[i];
    return y;
}
double slope_at(const std::vector<double>& c, double d) {
    double y = 0.0;
    for (std::size_t i = c.size(); i-- > 1;) y = y * d + double(i) * c[i];
    return y;
}

/// From above the paper down to the first pose and from the last one up again, as a robot moves.
Poses from_above(const Poses& poses) {
    Poses out(poses.rows() + 2, 3);
    out.middleRows(1, poses.rows()) = poses;
    out.row(0) = poses.row(0);
    out.row(out.rows() - 1) = poses.row(poses.rows() - 1);
    out(0, 2) = out(out.rows() - 1, 2) = kAboveMm;
    return out;
}

std::vector<double> close_places(const Poses& poses) {
    std::vector<double> out{0.0};
    for (Index i = 0; i + 1 < poses.rows(); ++i) {
        const Eigen::RowVector3d by = poses.row(i + 1) - poses.row(i);
        const int parts =
            std::max(1, int(std::ceil(std::max(by.head<2>().norm() / kStepMm, std::abs(by[2]) / kPressMm))));
        for (int k = 1; k <= parts; ++k) out.push_back(double(i) + double(k) / parts);
    }
    return out;
}

/// Points at equal distances along a closed outline, about `spacing` apart.
void add_points(const Ring& ring, double spacing, std::vector<double>& xy) {
    std::vector<double> along{0.0};
    for (Index i = 0; i < ring.rows(); ++i)
        along.push_back(along.back() + (ring.row((i + 1) % ring.rows()) - ring.row(i)).norm());
    const int count = std::max(8, int(std::round(along.back() / spacing)));
    std::size_t edge = 0;
    for (int k = 0; k < count; ++k) {
        const double s = along.back() * k / count;
        while (edge + 2 < along.size() && along[edge + 1] < s) ++edge;
        const double length = along[edge + 1] - along[edge], t = length > 0.0 ? (s - along[edge]) / length : 0.0;
        const Eigen::RowVector2d p = ring.row(Index(edge)) * (1.0 - t) + ring.row(Index(edge + 1) % ring.rows()) * t;
        xy.insert(xy.end(), {p.x(), p.y()});
    }
}

}  // namespace

/// The footprint at one instant.
struct MarkModel::Instant {
    Eigen::Vector2d contact, heading;
    double depth, gap, half, half_slope, gap_slope;
    double gone;  ///< no point of the footprint has moved farther than this since the first instant
    Drop drop;
    Eigen::Matrix<double, 2, kMostTerms + 1> contact_by, heading_by;
    double depth_by;  ///< by the height
    bool heading_known;
};

MarkModel::MarkModel(const std::vector<PaintedMark>& marks, const MarkOptions& options)
    : layout_{options.lag_terms, options.tip_gap_terms, options.half_width_terms}, deepest_(options.deepest_mm) {
    lag_powers_ = powers_from_controls(layout_.lag - 1, 0.0, deepest_);
    const MatrixXd whole = powers_from_controls(layout_.half, 0.0, deepest_);
    const MatrixXd sums = MatrixXd::Ones(layout_.half, layout_.half).triangularView<Eigen::Lower>();
    half_powers_ = whole.rightCols(layout_.half) * sums;
    centre_.setZero();
    Index poses = 0;
    for (const PaintedMark& mark : marks) {
        Painted painted{from_above(mark.poses_mm), {}, {}, {0}};
        painted.at = close_places(painted.poses_mm);
        std::vector<double> xy;
        for (const Ring& ring : mark.outline_mm) {
            if (std::abs(signed_area(ring)) < kLeastRingMm2) continue;
            add_points(ring, options.spacing_mm, xy);
            painted.rings.push_back(Index(xy.size() / 2));
        }
        painted.point_mm = Eigen::Map<const Ring>(xy.data(), Index(xy.size() / 2), 2);
        painted_.push_back(std::move(painted));
        centre_ += mark.poses_mm.leftCols<2>().colwise().sum().transpose();
        poses += mark.poses_mm.rows();
    }
    centre_ /= double(std::max<Index>(1, poses));
}

VectorXd MarkModel::unknowns(const MarkLaws& laws) const {
    const auto padded = [](const std::vector<double>& c, Index size) {
        VectorXd out = VectorXd::Zero(size);
        for (Index i = 0; i < std::min(size, Index(c.size())); ++i) out[i] = c[std::size_t(i)];
        return out;
    };
    VectorXd x = VectorXd::Zero(layout_.size());
    x.head(layout_.lag) = lag_powers_.colPivHouseholderQr().solve(padded(laws.lag, layout_.lag));
    const VectorXd gap = padded(laws.tip_gap, layout_.gap + 1);
    for (int k = 0; k < layout_.gap; ++k) x[layout_.gap_at() + k] = gap[k + 1] * std::pow(deepest_, k + 1);
    x.segment(layout_.half_at(), layout_.half) =
        half_powers_.bottomRows(layout_.half)
            .colPivHouseholderQr()
            .solve(padded(laws.half_width, layout_.half + 1).tail(layout_.half));
    x[layout_.widest()] = laws.widest_per_half;
    x[layout_.front()] = laws.front_per_half;
    return x.cwiseMax(least());
}

VectorXd MarkModel::least() const {
    VectorXd out = VectorXd::Constant(layout_.size(), -1e6);
    out.head(layout_.lag).setConstant(kLeastLagMm);
    out.segment(layout_.half_at(), layout_.half).setZero();
    out[layout_.widest()] = out[layout_.front()] = 0.1;
    return out;
}

MatrixXd MarkModel::to_coefficients() const {
    MatrixXd out = MatrixXd::Identity(layout_.size(), layout_.size());
    out.topLeftCorner(layout_.lag, layout_.lag) = lag_powers_;
    for (int k = 0; k < layout_.gap; ++k)
        out(layout_.gap_at() + k, layout_.gap_at() + k) = std::pow(deepest_, -(k + 1));
    out.block(layout_.half_at(), layout_.half_at(), layout_.half, layout_.half) = half_powers_.bottomRows(layout_.half);
    return out;
}

MarkLaws MarkModel::laws(const VectorXd& shared) const {
    const VectorXd c = to_coefficients() * shared;
    MarkLaws out;
    out.lag.assign(c.data(), c.data() + layout_.lag);
    for (auto [law, begin, count] : {std::tuple{&out.tip_gap, layout_.gap_at(), layout_.gap},
                                     std::tuple{&out.half_width, layout_.half_at(), layout_.half}}) {
        law->assign(1, 0.0);
        law->insert(law->end(), c.data() + begin, c.data() + begin + count);
    }
    out.widest_per_half = shared[layout_.widest()];
    out.front_per_half = shared[layout_.front()];
    return out;
}

bool MarkModel::instants(const Painted& mark, const VectorXd& shared, std::vector<Instant>& out) const {
    std::vector<Jet> c(std::size_t(layout_.lag), Jet(0.0));
    std::vector<double> values;
    for (int i = 0; i < layout_.lag; ++i) {
        for (int j = 0; j < layout_.lag; ++j) c[std::size_t(i)] += lag_powers_(i, j) * Jet(shared[j], j);
        values.push_back(c[std::size_t(i)].a);
    }
    const double height = shared[layout_.height()], reach = deepest_ + std::max(0.0, height);
    if (height > kAboveMm || !(values[0] > 0.0) || !real_roots(values, 0.0, reach).empty()) return false;
    const LagLaw<Jet> law = law_of(c, 0.0, reach);
    const MarkLaws laws = this->laws(shared);
    out.clear();
    trace<Jet>(law, mark.poses_mm, Jet(height, kMostTerms), mark.at, nullptr, [&](std::size_t, const Trace<Jet>& row) {
        if (!row.down) return;
        Instant now;
        const double d = std::max(0.0, row.depth.a);
        now.depth = d;
        now.depth_by = row.depth.v[kMostTerms];
        for (int i = 0; i < 2; ++i) {
            now.contact[i] = row.state.contact[i].a;
            now.heading[i] = row.state.heading[i].a;
            now.contact_by.row(i) = row.state.contact[i].v.transpose();
            now.heading_by.row(i) = row.state.heading[i].v.transpose();
        }
        now.heading_known = row.state.heading_known || row.state.taut;
        now.gap = at(laws.tip_gap, d);
        now.gap_slope = slope_at(laws.tip_gap, d);
        now.half = at(laws.half_width, d) + kLeastHalfMm;
        now.half_slope = slope_at(laws.half_width, d);
        out.push_back(now);
    });
    // before the first motion there is no heading: the first one that follows
    for (std::size_t i = 0, first = 0; i < out.size(); ++i) {
        if (!out[i].heading_known) continue;
        for (; first < i; ++first)
            if (!out[first].heading_known) {
                out[first].heading = out[i].heading;
                out[first].heading_by = out[i].heading_by;
            }
        first = i + 1;
    }
    Eigen::Matrix<double, 2, 5> before;
    for (std::size_t i = 0; i < out.size(); ++i) {
        Instant& now = out[i];
        now.drop = {laws.widest_per_half * now.half, now.half, laws.front_per_half * now.half};
        // every point of the drop is a mean of these corners, with the same weights at all instants
        const Eigen::Vector2d left(-now.heading.y(), now.heading.x()), tip = now.contact - now.gap * now.heading;
        const Eigen::Vector2d widest = tip + now.drop.widest * now.heading, side = now.half * left;
        const Eigen::Vector2d front = widest + now.drop.front * now.heading;
        Eigen::Matrix<double, 2, 5> corners;
        corners << tip, widest + side, widest - side, front + side, front - side;
        now.gone = i ? out[i - 1].gone + (corners - before).colwise().norm().maxCoeff() : 0.0;
        before = corners;
    }
    return !out.empty();
}

Ring MarkModel::placed(Index mark, const double* shared, const double* displacement) const {
    const Eigen::Vector2d shift(shared[layout_.shift()], shared[layout_.shift() + 1]);
    const double turn = shared[layout_.turn()];
    Eigen::Matrix2d back;
    back << std::cos(turn), std::sin(turn), -std::sin(turn), std::cos(turn);
    Ring out = painted_[std::size_t(mark)].point_mm;
    for (Index k = 0; k < out.rows(); ++k) {
        const Eigen::Vector2d seen = out.row(k).transpose() - shift - centre_;
        out.row(k) = (centre_ + back * seen - Eigen::Vector2d(displacement[0], displacement[1])).transpose();
    }
    return out;
}

bool MarkModel::distances(Index mark, const double* shared_data, const double* displacement, VectorXd& distance_mm,
                          RowMajor* by_shared, RowMajor* by_displacement) const {
    const Painted& painted = painted_[std::size_t(mark)];
    const VectorXd shared = Eigen::Map<const VectorXd>(shared_data, layout_.size());
    thread_local std::vector<Instant> rows;
    if (!instants(painted, shared, rows)) return false;
    const Ring points = placed(mark, shared_data, displacement);
    const double turn = shared[layout_.turn()], ct = std::cos(turn), st = std::sin(turn);
    Eigen::Matrix2d back, back_by_turn;
    back << ct, st, -st, ct;
    back_by_turn << -st, ct, -ct, -st;
    const double widest = shared[layout_.widest()], front = shared[layout_.front()];
    distance_mm.resize(points.rows());
    std::size_t nearest = 0;
    for (Index k = 0; k < points.rows(); ++k) {
        const Eigen::Vector2d x = points.row(k).transpose();
        const auto edge_of = [&](const Instant& now) {
            const Eigen::Vector2d from_tip = x - now.contact + now.gap * now.heading;
            return nearest_edge(now.drop, from_tip.dot(now.heading),
                                now.heading.x() * from_tip.y() - now.heading.y() * from_tip.x());
        };
        // From the footprint that was nearest to the point before. Between instants a distance changes by no more than
        // the footprint moves: where it is so much too long, so many instants are passed over.
        const std::size_t begin = nearest;
        NearestEdge best = edge_of(rows[begin]);
        const auto look = [&](std::size_t i, double& reaches) {
            const NearestEdge edge = edge_of(rows[i]);
            if (edge.distance < best.distance) {
                best = edge;
                nearest = i;
            }
            reaches = edge.distance - best.distance;
        };
        double spare = 0.0;
        for (std::size_t i = begin + 1, from = begin; i < rows.size(); ++i) {
            if (rows[i].gone - rows[from].gone < spare) continue;
            look(i, spare);
            from = i;
        }
        spare = 0.0;
        for (std::size_t i = begin, from = begin; i-- > 0;) {
            if (rows[from].gone - rows[i].gone < spare) continue;
            look(i, spare);
            from = i;
        }
        distance_mm[k] = best.distance;
        if (!by_shared) continue;
        const Instant& now = rows[nearest];
        const Eigen::Vector2d u = now.heading, left(-u.y(), u.x());
        const Eigen::RowVector2d n = (best.nx * u + best.ny * left).transpose();
        const double nu = best.nx, nl = best.ny, ahead = best.x - now.gap;
        Eigen::Matrix<double, 2, kMostTerms + 1> left_by;
        left_by << -now.heading_by.row(1), now.heading_by.row(0);
        // the edge moves outwards by n dy: the distance falls by it
        const Eigen::Matrix<double, 1, kMostTerms + 1> moved =
            n * (now.contact_by + ahead * now.heading_by + best.y * left_by);
        auto out = by_shared->row(k);
        out.head(layout_.lag) = -moved.head(layout_.lag);
        const double along = best.by_widest * widest + best.by_front * front;  // x and y of the edge per half width
        const double per_half = along * nu + best.by_half * nl;
        double power = 1.0;
        for (int j = 0; j < layout_.gap; ++j) {
            power *= now.depth / deepest_;
            out[layout_.gap_at() + j] = power * nu;
        }
        for (int j = 0; j < layout_.half; ++j) {
            double step = 0.0;
            for (Index i = half_powers_.rows(); i-- > 0;) step = step * now.depth + half_powers_(i, j);
            out[layout_.half_at() + j] = -step * per_half;
        }
        out[layout_.widest()] = -best.by_widest * now.half * nu;
        out[layout_.front()] = -best.by_front * now.half * nu;
        out[layout_.height()] = -moved[kMostTerms] - now.depth_by * (now.half_slope * per_half - now.gap_slope * nu);
        out.segment<2>(layout_.shift()) = -n * back;
        const Eigen::Vector2d seen = painted.point_mm.row(k).transpose() - shared.segment<2>(layout_.shift()) - centre_;
        out[layout_.turn()] = n * back_by_turn * seen;
        if (by_displacement) by_displacement->row(k) = -n;
    }
    return true;
}

}  // namespace brushsvg::fit
