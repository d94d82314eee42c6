#include "mark_model.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "bernstein.hpp"
#include "brushsvg/error.hpp"
#include "no_brush.hpp"

namespace brushsvg::fit {
namespace {

// Steps between footprints along the path and in depth. The edge of a union of discs 0.5 mm wide then has scallops of
// 0.01 mm, of wider discs smaller ones.
constexpr double kMaxStepMm = 0.2, kMaxPressStepMm = 0.15;
constexpr double kStartHeightMm = 5.0;    // added to the greatest depth: the brush starts above any error of the height
constexpr double kMinRingAreaMm2 = 0.2;   // smaller rings are specks
constexpr double kMinFieldReachMm = 5.0;  // of a field: over a shorter distance, a smooth field is constant
// Limits of the number of evaluated instants in a fit, in total and per place and point. Marks of a brush need two to
// ten thousand. Marks that no brush paints needed millions, and minutes, because huge footprints overlap.
constexpr double kMaxEvaluations = 2e7, kMaxEvaluationsPerItem = 3e4;
// Limit for one mark. A sheet of fifty strokes needs about this number. A stroke with 9 m of jumps back and forth
// needed ten times this number, and a minute.
constexpr double kMaxEvaluationsPerMark = 2e8;

/// Adds moves from above the paper down to the first pose and from the last pose up again, as a robot moves.
Poses add_approach_and_retreat(const Poses& poses, double above_mm) {
    Poses out(poses.rows() + 2, 3);
    out.middleRows(1, poses.rows()) = poses;
    out.row(0) = poses.row(0);
    out.row(out.rows() - 1) = poses.row(poses.rows() - 1);
    out(0, 2) = out(out.rows() - 1, 2) = above_mm;
    return out;
}

/// Replaces arcs by chords, because a machine with errors does not make circles of circles.
void replace_arcs_by_chords(Poses& poses, std::vector<Arc>& arcs) {
    constexpr double kMaxChordTurnRad = 0.02;
    std::vector<double> xyz;
    const auto put = [&](const Eigen::RowVector3d& p) { xyz.insert(xyz.end(), {p.x(), p.y(), p.z()}); };
    auto arc = arcs.begin();
    for (Index i = 0; i < poses.rows(); ++i) {
        put(poses.row(i));
        while (arc != arcs.end() && arc->last <= i) ++arc;
        if (arc == arcs.end() || arc->first > i) continue;
        const Eigen::Vector2d a = poses.row(i).head<2>().transpose(), b = poses.row(i + 1).head<2>().transpose();
        const Eigen::Vector2d centre(arc->centre_mm[0], arc->centre_mm[1]);
        const double turn = turn_between(*arc, a, b);
        const int parts = int(std::ceil(std::abs(turn) / kMaxChordTurnRad));
        for (int k = 1; k < parts; ++k) {
            const double share = double(k) / parts;
            const Eigen::Vector2d on = centre + Eigen::Rotation2Dd(turn * share) * (a - centre);
            put({on.x(), on.y(), poses(i, 2) + share * (poses(i + 1, 2) - poses(i, 2))});
        }
    }
    poses = Eigen::Map<const Poses>(xyz.data(), Index(xyz.size() / 3), 3);
    arcs.clear();
}

/// Returns the direction from which x and y came to the first pose, from the end of the mark before; 0 for the first
/// mark, for which it is unknown.
Eigen::Vector2d approach_direction(const Poses& poses, const PaintedMark* before) {
    constexpr double kMinAxisMoveMm = 1e-6;
    Eigen::Vector2d out(0.0, 0.0);
    for (int axis = 0; axis < 2 && before; ++axis) {
        const double by = poses(0, axis) - before->poses_mm(before->poses_mm.rows() - 1, axis);
        if (std::abs(by) > kMinAxisMoveMm) out[axis] = std::copysign(1.0, by);
    }
    return out;
}

/// Adds poses where an axis reverses: there it does not move for its backlash, and then moves as commanded.
Poses add_poses_at_reversals(const Poses& poses, Eigen::Vector2d approach) {
    constexpr std::array<double, 7> kReversalStepsMm{0.05, 0.1, 0.2, 0.3, 0.45, 0.7, 1.0};
    std::vector<double> xyz(poses.data(), poses.data() + 3);
    for (Index i = 0; i + 1 < poses.rows(); ++i) {
        const Eigen::RowVector3d by = poses.row(i + 1) - poses.row(i);
        std::vector<double> shares;
        for (int axis = 0; axis < 2; ++axis) {
            const double step = std::abs(by[axis]), way = std::copysign(1.0, by[axis]);
            if (!(step > kReversalStepsMm.front()) || way == approach[axis]) continue;
            for (const double mm : kReversalStepsMm)
                if (mm < step) shares.push_back(mm / step);
        }
        for (int axis = 0; axis < 2; ++axis)
            if (std::abs(by[axis]) > kReversalStepsMm.front()) approach[axis] = std::copysign(1.0, by[axis]);
        shares.push_back(1.0);
        std::sort(shares.begin(), shares.end());
        for (const double share : shares) {
            const Eigen::RowVector3d at = poses.row(i) + share * by;
            xyz.insert(xyz.end(), {at.x(), at.y(), at.z()});
        }
    }
    return Eigen::Map<const Poses>(xyz.data(), Index(xyz.size() / 3), 3);
}

/// Returns a law with `terms` coefficients: padded with 0, or the nearest law on [0, deepest] if c has more. first: its
/// least power.
VectorXd with_term_count(const std::vector<double>& c, Index terms, Index first, double deepest) {
    constexpr int kDepthSamples = 41;
    const Index size = Index(c.size());
    VectorXd out = VectorXd::Zero(terms);
    for (Index i = 0; i < std::min(terms, size); ++i) out[i] = c[std::size_t(i)];
    if (size <= terms) return out;
    MatrixXd powers(kDepthSamples, terms - first);
    VectorXd value = VectorXd::Zero(kDepthSamples);
    for (int k = 0; k < kDepthSamples; ++k) {
        const double d = deepest * (k + 1) / kDepthSamples;
        for (Index i = first; i < terms; ++i) powers(k, i - first) = std::pow(d, double(i));
        for (Index i = size; i-- > 0;) value[k] = value[k] * d + c[std::size_t(i)];
    }
    out.tail(terms - first) = powers.colPivHouseholderQr().solve(value);
    return out;
}

bool has_machine_errors(const MarkOptions& options) {
    return options.lean_mm_per_mm > 0.0 || options.axes > 0.0 || options.tilt_mm_per_mm > 0.0 ||
           options.backlash_mm > 0.0 || options.field_mm > 0.0;
}

std::vector<double> sample_places(const Poses& poses, double coarse) {
    std::vector<double> out{0.0};
    for (Index i = 0; i + 1 < poses.rows(); ++i) {
        const Eigen::RowVector3d by = poses.row(i + 1) - poses.row(i);
        const double most = std::max(by.head<2>().norm() / kMaxStepMm, std::abs(by[2]) / kMaxPressStepMm);
        const int parts = std::max(1, int(std::ceil(most / coarse)));
        for (int k = 1; k <= parts; ++k) out.push_back(double(i) + double(k) / parts);
    }
    return out;
}

/// Returns the box of all places to which the TCP was commanded.
FieldBox commanded_box(const std::vector<PaintedMark>& marks) {
    Eigen::Vector2d low(INFINITY, INFINITY), high = -low;
    for (const PaintedMark& mark : marks) {
        low = low.cwiseMin(mark.poses_mm.leftCols<2>().colwise().minCoeff().transpose());
        high = high.cwiseMax(mark.poses_mm.leftCols<2>().colwise().maxCoeff().transpose());
    }
    return {0.5 * (low + high), (0.5 * (high - low)).cwiseMax(kMinFieldReachMm)};
}

/// Adds points at equal distances along a closed outline, about `spacing` apart.
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

/// Computes unit normals to the right of a closed row of points, from the neighbours of each point.
void add_normals(const Ring& points, Index begin, Index end, Ring& normals) {
    const Index n = end - begin;
    for (Index k = 0; k < n; ++k) {
        const Eigen::RowVector2d along = points.row(begin + (k + 1) % n) - points.row(begin + (k + n - 1) % n);
        const double length = std::max(1e-12, along.norm());
        normals.row(begin + k) << along.y() / length, -along.x() / length;
    }
}

}  // namespace

Layout MarkModel::make_layout(const MarkOptions& options) {
    return {options.lag_terms,    options.tip_gap_terms, options.half_width_terms,
            options.widest_terms, options.front_terms,   has_machine_errors(options) ? kMachineErrors : 0};
}

MarkModel::MarkModel(const std::vector<PaintedMark>& marks, const MarkOptions& options, double coarse)
    : layout_(make_layout(options)),
      deepest_(options.deepest_mm),
      coarse_(coarse),
      spacing_(options.spacing_mm),
      round_tail_(options.round_tail),
      has_field_(options.field_mm > 0.0) {
    lag_powers_ = powers_from_controls(layout_.lag - 1, 0.0, deepest_);
    const MatrixXd whole = powers_from_controls(layout_.half, 0.0, deepest_);
    const MatrixXd sums = MatrixXd::Ones(layout_.half, layout_.half).triangularView<Eigen::Lower>();
    half_powers_ = whole.rightCols(layout_.half) * sums;
    centre_.setZero();
    Index poses = 0;
    for (const PaintedMark& mark : marks) {
        Painted painted{mark.stroke, add_approach_and_retreat(mark.poses_mm, kStartHeightMm + deepest_),
                        mark.arcs,   {0.0, 0.0},
                        {},          {},
                        {},          {0}};
        for (Arc& arc : painted.arcs) {  // arcs count from the first pose, which is the second one here
            ++arc.first;
            ++arc.last;
        }
        if (layout_.machine_numbers > 0) {
            replace_arcs_by_chords(painted.poses_mm, painted.arcs);
            painted.approach = approach_direction(painted.poses_mm, &mark == &marks.front() ? nullptr : &mark - 1);
            if (options.backlash_mm > 0.0)
                painted.poses_mm = add_poses_at_reversals(painted.poses_mm, painted.approach);
        }
        painted.at = sample_places(painted.poses_mm, coarse_);
        std::vector<double> xy;
        for (const Ring& ring : mark.outline_mm) {
            if (std::abs(signed_area(ring)) < kMinRingAreaMm2) continue;
            add_points(ring, options.spacing_mm, xy);
            painted.rings.push_back(Index(xy.size() / 2));
        }
        painted.point_mm = Eigen::Map<const Ring>(xy.data(), Index(xy.size() / 2), 2);
        painted.outward.resize(painted.point_mm.rows(), 2);
        for (std::size_t r = 0; r + 1 < painted.rings.size(); ++r)
            add_normals(painted.point_mm, painted.rings[r], painted.rings[r + 1], painted.outward);
        painted_.push_back(std::move(painted));
        centre_ += mark.poses_mm.leftCols<2>().colwise().sum().transpose();
        poses += mark.poses_mm.rows();
    }
    centre_ /= double(std::max<Index>(1, poses));
    box_ = commanded_box(marks);
    evaluations_.assign(painted_.size(), 0);
}

void MarkModel::require_bounded_work() const {
    double looks = 0.0, most = kMaxEvaluations, worst = 0.0;
    std::size_t which = 0;
    for (std::size_t i = 0; i < painted_.size(); ++i) {
        const double size = double(painted_[i].at.size()) + double(painted_[i].point_mm.rows());
        looks += double(evaluations_[i]);
        most += kMaxEvaluationsPerItem * size;
        if (double(evaluations_[i]) <= worst * size) continue;
        worst = double(evaluations_[i]) / size;
        which = i;
    }
    if (looks > most) throw no_brush_error(painted_[which].stroke);
    for (std::size_t i = 0; i < painted_.size(); ++i)
        if (double(evaluations_[i]) > kMaxEvaluationsPerMark)
            throw Error("fit-failed",
                        "the stroke is so long and crosses itself so often that its mark cannot be fitted: leave it "
                        "out",
                        painted_[i].stroke);
}

VectorXd MarkModel::unlimited_unknowns(const MarkLaws& laws) const {
    VectorXd x = VectorXd::Zero(layout_.size());
    x.head(layout_.lag) = lag_powers_.colPivHouseholderQr().solve(with_term_count(laws.lag, layout_.lag, 0, deepest_));
    const VectorXd gap = with_term_count(laws.tip_gap, layout_.gap + 1, 1, deepest_);
    for (int k = 0; k < layout_.gap; ++k) x[layout_.gap_at() + k] = gap[k + 1] * std::pow(deepest_, k + 1);
    x.segment(layout_.half_at(), layout_.half) =
        half_powers_.bottomRows(layout_.half)
            .colPivHouseholderQr()
            .solve(with_term_count(laws.half_width, layout_.half + 1, 1, deepest_).tail(layout_.half));
    for (const auto& [by_depth, mean, first, terms] :
         {std::tuple{&laws.widest_by_depth, laws.widest_per_half, layout_.widest(), layout_.widest_terms},
          std::tuple{&laws.front_by_depth, laws.front_per_half, layout_.front(), layout_.front_terms}}) {
        if (!by_depth->empty())
            x.segment(first, terms) = powers_from_legendre(terms - 1, deepest_)
                                          .colPivHouseholderQr()
                                          .solve(with_term_count(*by_depth, terms, 0, deepest_));
        x[first] = mean;
    }
    return x;
}

VectorXd MarkModel::lower_bounds() const {
    VectorXd out = VectorXd::Constant(layout_.size(), -1e6);
    out.head(layout_.lag).setConstant(kMinLagMm);
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
    for (const auto& [first, terms] :
         {std::pair{layout_.widest(), layout_.widest_terms}, std::pair{layout_.front(), layout_.front_terms}})
        out.block(first, first, terms, terms) = powers_from_legendre(terms - 1, deepest_);
    return out;
}

MatrixXd MarkModel::departure_rows(const Layout& from) const {
    const MatrixXd to = to_coefficients();
    std::vector<Eigen::RowVectorXd> rows;
    const auto put = [&](int first, int terms, int known, double size) {
        const MatrixXd block = powers_from_legendre(terms - 1, deepest_)
                                   .colPivHouseholderQr()
                                   .solve(MatrixXd(size * to.block(first, first, terms, terms)));
        for (int k = known; k < terms; ++k) {
            rows.emplace_back(Eigen::RowVectorXd::Zero(layout_.size()));
            rows.back().segment(first, terms) = block.row(k);
        }
    };
    put(0, layout_.lag, from.lag, 1.0);
    put(layout_.gap_at(), layout_.gap, from.gap,
        deepest_);  // both laws go through 0, so that their slope by depth is used
    put(layout_.half_at(), layout_.half, from.half, deepest_);
    put(layout_.widest(), layout_.widest_terms, from.widest_terms, 1.0);
    put(layout_.front(), layout_.front_terms, from.front_terms, 1.0);
    MatrixXd out(Index(rows.size()), layout_.size());
    for (std::size_t i = 0; i < rows.size(); ++i) out.row(Index(i)) = rows[i];
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
    const auto by_depth = [&](int first, int terms) {
        return terms > 1 ? std::vector<double>(c.data() + first, c.data() + first + terms) : std::vector<double>{};
    };
    out.widest_by_depth = by_depth(layout_.widest(), layout_.widest_terms);
    out.front_by_depth = by_depth(layout_.front(), layout_.front_terms);
    out.round_tail = round_tail_;
    return out;
}

std::array<double, kMachineErrors> MarkModel::machine_numbers(const VectorXd& shared) const {
    std::array<double, kMachineErrors> out{};
    for (int i = 0; i < layout_.machine_numbers; ++i) out[std::size_t(i)] = shared[layout_.machine() + i];
    return out;
}

Machine MarkModel::machine(const VectorXd& shared) const {
    const std::array<double, kMachineErrors> by = machine_numbers(shared);
    const auto two = [&](int first, double more) {
        return std::array<double, 2>{by[std::size_t(first)] + more, by[std::size_t(first + 1)] + more};
    };
    const auto three = [&](int first) {
        return std::array<double, 3>{by[std::size_t(first)], by[std::size_t(first + 1)], by[std::size_t(first + 2)]};
    };
    return {two(MachineIndex::lean, 0.0),
            two(MachineIndex::scale, 1.0),
            by[MachineIndex::skew],
            two(MachineIndex::tilt, 0.0),
            two(MachineIndex::backlash, 0.0),
            {three(MachineIndex::field), three(MachineIndex::field + 3)},
            {box_.middle.x(), box_.middle.y()},
            {box_.reach.x(), box_.reach.y()}};
}

MachineState MarkModel::machine_state(const Painted& painted, const VectorXd& shared) const {
    return {machine_numbers(shared), centre_, painted.approach, box_, has_field_};
}

Poses MarkModel::realised_path(Index mark, const VectorXd& shared) const {
    const Painted& painted = painted_[std::size_t(mark)];
    Poses out = painted.poses_mm;
    if (layout_.machine_numbers > 0) {
        const MachineState machine = machine_state(painted, shared);
        const RealisedPath<double> way{painted.poses_mm, painted.arcs,
                                       machine,          0.0,
                                       machine.by,       backlash_offsets(painted.poses_mm, machine, machine.by)};
        for (Index i = 0; i < out.rows(); ++i) out.row(i) << way.tcp(i).transpose(), -way.depth(i);
    }
    return out.middleRows(1, out.rows() - 2);
}

}  // namespace brushsvg::fit
