#include "track_fit.hpp"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <string>

#include "base/parallel.hpp"
#include "base/within.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/student_t.hpp"
#include "trace.hpp"

namespace brushsvg::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kDeepestMm = 1000.0;  // deeper is damage, and its powers overflow

/// The law at the point that is being tried, once for all strokes. Unknowns: coefficients in powers of depth / deepest.
template <int N>
class Law {
 public:
    using Jet = ceres::Jet<double, N + 1>;  // the law's N coefficients and the heading at the start
    Law(const std::vector<double>& start, const TrackOptions& options) : options_(options) {
        double power = 1.0;
        for (double c : start) {
            scale.push_back(1.0 / power);
            unknown.push_back(c * power);
            power *= options.range_mm[1];
        }
        lay_down();
    }
    void lay_down() {
        std::vector<Jet> c;
        std::vector<double> values;
        for (std::size_t i = 0; i < unknown.size(); ++i) {
            c.push_back(Jet(unknown[i], int(i)) * scale[i]);
            values.push_back(c.back().a);
        }
        const auto [lo, hi] = options_.range_mm;
        positive = values[0] + lo > 0.0 && real_roots(values, lo, hi).empty();
        jets = law_of(c, lo, hi);
    }
    std::vector<double> unknown, scale;
    bool positive = false;
    LagLaw<Jet> jets;

 private:
    const TrackOptions& options_;
};

template <class T>
T lever_at(const std::vector<double>& c, const T& depth) {
    T e(0.0);
    for (std::size_t i = c.size(); i-- > 0;) e = e * depth + c[i];
    return e;
}

/// Residuals of one stroke: predicted minus seen. Blocks: the law; what is the stroke's own (heading, displacement).
template <int N>
class Stroke : public ceres::CostFunction {
 public:
    using Jet = typename Law<N>::Jet;
    Stroke(const Track& track, const Law<N>& law, const TrackOptions& options)
        : track_(track), law_(law), lever_(options.lever_mm), turns_(options.free_heading && !is_set_down(track)) {
        set_num_residuals(int(2 * track.seen_mm.rows()));
        mutable_parameter_block_sizes()->push_back(int(law.unknown.size()));
        const Eigen::Vector2d first = (track.poses_mm.row(1) - track.poses_mm.row(0)).head<2>().transpose();
        if (options.displaced == Displaced::along)
            moves_ = first.norm() > 0.0 ? MatrixXd(first.normalized()) : MatrixXd(Eigen::Vector2d::UnitX());
        if (options.displaced == Displaced::both) moves_ = Eigen::Matrix2d::Identity();
        if (own()) mutable_parameter_block_sizes()->push_back(own());
    }
    static bool is_set_down(const Track& track) { return std::isnan(track.heading_rad); }
    int own() const { return int(turns_) + int(moves_.cols()); }
    VectorXd own_start() const {
        VectorXd x = VectorXd::Zero(own());
        if (turns_) x[0] = track_.heading_rad;
        return x;
    }
    double heading(const VectorXd& own) const { return turns_ ? own[0] : track_.heading_rad; }
    Eigen::Vector2d displacement(const VectorXd& own) const {
        return moves_.cols() ? Eigen::Vector2d(moves_ * own.tail(moves_.cols())) : Eigen::Vector2d::Zero();
    }

    /// Residuals and derivatives at the law's point and these unknowns of its own.
    void evaluate(const VectorXd& own) {
        residual.resize(num_residuals());
        const Index n = Index(law_.unknown.size());
        by_law.resize(num_residuals(), n);
        by_own.resize(num_residuals(), this->own());
        using std::cos;
        using std::sin;
        const Jet heading = turns_ ? Jet(own[0], N) : Jet(track_.heading_rad);
        const Eigen::Vector2d moved = displacement(own);
        LagState<Jet> begun;
        if (!is_set_down(track_)) {
            begun.heading = Vec2<Jet>(cos(heading), sin(heading));
            begun.contact = track_.poses_mm.row(0).head<2>().transpose().cast<Jet>() -
                            law_.jets.at(Jet(-track_.poses_mm(0, 2))) * begun.heading;
            begun.taut = begun.heading_known = true;
        }
        const std::vector<Arc> arcs;
        const CommandedWay<Jet> way{track_.poses_mm, arcs, Jet(0.0)};
        trace(law_.jets, way, track_.pose, is_set_down(track_) ? nullptr : &begun,
              [&](std::size_t k, const Trace<Jet>& at) {
                  checkpoint();
                  Vec2<Jet> seen = at.state.contact;
                  if (!lever_.empty()) seen += lever_at(lever_, at.depth) * at.state.heading;
                  for (int c = 0; c < 2; ++c) {
                      const Index row = Index(2 * k) + c;
                      residual[row] = seen[c].a + moved[c] - track_.seen_mm(Index(k), c);
                      by_law.row(row) = seen[c].v.head(n).transpose();
                      if (turns_) by_own(row, 0) = seen[c].v[N];
                      by_own.row(row).tail(moves_.cols()) = moves_.row(c);
                  }
              });
    }

    bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
        if (!law_.positive) return false;
        std::copy_n(residual.data(), residual.size(), residuals);
        if (jacobians && jacobians[0]) std::copy_n(by_law.data(), by_law.size(), jacobians[0]);
        if (jacobians && own() && jacobians[1]) std::copy_n(by_own.data(), by_own.size(), jacobians[1]);
        return true;
    }

    VectorXd residual;
    RowMajor by_law, by_own;

 private:
    const Track& track_;
    const Law<N>& law_;
    const std::vector<double>& lever_;
    bool turns_;
    MatrixXd moves_ = MatrixXd(2, 0);
};

/// All strokes at the point that is being tried, on all processors, before Ceres asks for them one by one.
template <int N>
class Strokes : public ceres::EvaluationCallback {
 public:
    Strokes(const std::vector<Track>& tracks, const std::vector<double>& start, const TrackOptions& options)
        : law(start, options) {
        for (const Track& track : tracks) {
            all.push_back(std::make_unique<Stroke<N>>(track, law, options));
            own.push_back(all.back()->own_start());
        }
    }
    /// With slopes at once: nearly all steps are taken, and then they are needed.
    void PrepareForEvaluation(bool = true, bool = true) override {
        if (law.unknown == law_at_ && own == own_at_) return;
        law_at_ = law.unknown;
        own_at_ = own;
        law.lay_down();
        if (law.positive) on_all_processors(0, all.size(), [&](std::size_t i) { all[i]->evaluate(own[i]); });
    }
    /// To the point that was tried last where that is no worse than the solution, which costs so much: with its slopes.
    void settle(double cost) {
        double squares = 0.0;
        for (const auto& one : all) squares += one->residual.squaredNorm();
        if (law.positive && 0.5 * squares <= cost) {
            law.unknown = law_at_;
            own = own_at_;
        }
        PrepareForEvaluation();
    }

    Law<N> law;
    std::vector<std::unique_ptr<Stroke<N>>> all;
    std::vector<VectorXd> own;

 private:
    std::vector<double> law_at_;  ///< where all have been evaluated
    std::vector<VectorXd> own_at_;
};

template <int N>
TrackFit fit(const std::vector<Track>& tracks, const std::vector<double>& start, const TrackOptions& options) {
    Strokes<N> at(tracks, start, options);
    Law<N>& law = at.law;
    const auto& strokes = at.all;
    std::vector<VectorXd>& own = at.own;
    if (!law.positive)
        throw Error("law-zero", "the lag to start from is not above 0 on the whole range of depths", "start");
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.evaluation_callback = &at;
    problem_options.disable_all_safety_checks = true;
    ceres::Problem problem(problem_options);
    ceres::Solver::Options solver;
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    bool eliminates = false;
    for (std::size_t i = 0; i < strokes.size(); ++i) {
        std::vector<double*> blocks{law.unknown.data()};
        if (own[i].size()) {
            blocks.push_back(own[i].data());
            ordering->AddElementToGroup(own[i].data(), 0);
            eliminates = true;
        }
        problem.AddResidualBlock(strokes[i].get(), nullptr, blocks);
    }
    ordering->AddElementToGroup(law.unknown.data(), 1);
    solver.linear_solver_type = eliminates ? ceres::DENSE_SCHUR : ceres::DENSE_NORMAL_CHOLESKY;
    if (eliminates) solver.linear_solver_ordering = ordering;
    solver.logging_type = ceres::SILENT;
    solver.max_num_iterations = options.most_iterations;
    solver.max_num_consecutive_invalid_steps = 20;
    solver.function_tolerance = 1e-9;
    solver.initial_trust_region_radius = 1e6;  // the problem is nearly quadratic; the step is cut where it is not
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) throw Error("fit-failed", "the lag could not be fitted: " + summary.message);

    TrackFit out;
    out.iterations = int(summary.iterations.size());
    out.converged = summary.termination_type == ceres::CONVERGENCE;
    at.settle(summary.final_cost);
    const Index n = Index(law.unknown.size());
    MatrixXd normal = MatrixXd::Zero(n, n);
    double sum = 0.0;
    Index rows_in_all = 0, unknowns = n;
    out.displacement_mm.resize(Index(strokes.size()), 2);
    for (std::size_t i = 0; i < strokes.size(); ++i) {
        const Index m = own[i].size();
        const VectorXd& residual = strokes[i]->residual;
        const RowMajor &by_law = strokes[i]->by_law, &by_own = strokes[i]->by_own;
        normal += by_law.transpose() * by_law;
        if (m) {  // what the stroke's own unknowns take away (Schur complement)
            const MatrixXd between = by_own.transpose() * by_law;
            normal -= between.transpose() * (by_own.transpose() * by_own).ldlt().solve(between);
        }
        sum += residual.squaredNorm();
        rows_in_all += residual.size();
        unknowns += m;
        out.residual_mm.insert(out.residual_mm.end(), residual.data(), residual.data() + residual.size());
        out.heading_rad.push_back(strokes[i]->heading(own[i]));
        out.displacement_mm.row(Index(i)) = strokes[i]->displacement(own[i]).transpose();
    }
    const VectorXd scale = Eigen::Map<const VectorXd>(law.scale.data(), n);
    for (Index i = 0; i < n; ++i) out.lag.coefficients.push_back(law.unknown[std::size_t(i)] * scale[i]);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(normal);
    if (!(eigen.eigenvalues()[0] > 1e-11 * eigen.eigenvalues()[n - 1]))
        throw Error(
            "law-undetermined",
            "the strokes leave the lag open: paint curved strokes at as many depths as the law has coefficients",
            "lag");
    out.degrees_of_freedom = int(rows_in_all - unknowns);
    if (out.degrees_of_freedom < 1) return out;
    out.lag.rmse_mm = std::sqrt(sum / out.degrees_of_freedom);
    out.lag.degrees_of_freedom = out.degrees_of_freedom;
    const double t = deviations_of_95(out.lag.degrees_of_freedom);
    const MatrixXd covariance = sum / out.degrees_of_freedom * scale.asDiagonal() *
                                normal.ldlt().solve(MatrixXd::Identity(n, n)) * scale.asDiagonal();
    for (Index i = 0; i < n; ++i) {
        out.covariance.emplace_back();
        for (Index j = 0; j < n; ++j) out.covariance.back().push_back(covariance(i, j));
        out.lag.half_interval_95.push_back(t * std::sqrt(covariance(i, i)));
    }
    return out;
}

void refuse_what_cannot_be_fitted(const std::vector<Track>& tracks, const std::vector<double>& start,
                                  const TrackOptions& options) {
    if (start.empty() || int(start.size()) > kMaxLawDegree + 1)
        throw Error("law-terms",
                    "a law of " + std::to_string(start.size()) + " coefficients is outside the range [1, 9]", "start");
    const auto [lo, hi] = options.range_mm;
    if (!(lo >= 0.0 && lo < hi && hi <= kDeepestMm))
        throw Error("out-of-range", "the range of depths must rise from 0 or more to 1000 mm or less", "range_mm");
    const std::array<double, 2> any{-kLargestMm, kLargestMm};
    for (double c : start) require_within(c, any, "a coefficient", "start");
    if (int(options.lever_mm.size()) > kMaxLawDegree + 1)
        throw Error("law-terms",
                    "a law of " + std::to_string(options.lever_mm.size()) + " coefficients is outside the range [0, 9]",
                    "lever_mm");
    for (double c : options.lever_mm) require_within(c, any, "a coefficient", "lever_mm");
    require_within(options.most_iterations, {1, 10000}, "the number of iterations", "most_iterations");
    if (tracks.empty()) throw Error("measurement-missing", "there is no stroke");
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        const Track& track = tracks[i];
        const std::string where = "stroke " + std::to_string(i + 1);
        if (track.poses_mm.rows() < 2) throw Error("pass-empty", "a stroke needs two poses or more", where);
        for (const double mm : track.poses_mm.reshaped()) require_within(mm, any, "a coordinate of a pose", where);
        for (const double mm : track.seen_mm.reshaped()) require_within(mm, any, "a coordinate that was seen", where);
        if (!std::isnan(track.heading_rad)) require_within(track.heading_rad, any, "the heading", where);
        const double deepest = -track.poses_mm.col(2).minCoeff();
        if (deepest > hi + 1e-9)
            throw Error("depth-out-of-range", "a pose is deeper than the range of the law", where, deepest,
                        options.range_mm);
        if (track.pose.empty() || Index(track.pose.size()) != track.seen_mm.rows())
            throw Error("sizes-differ", "each place seen needs its pose", where);
        double before = 0.0;
        for (double pose : track.pose) {
            if (!(pose >= before && pose <= double(track.poses_mm.rows() - 1)))
                throw Error("not-ascending", "the poses of what was seen must ascend and be on the stroke", where,
                            pose);
            const Index from = std::min(Index(pose), track.poses_mm.rows() - 2);
            const double z0 = track.poses_mm(from, 2), z1 = track.poses_mm(from + 1, 2);
            if (z0 + (pose - double(from)) * (z1 - z0) > 1e-9)
                throw Error("above-paper", "something was seen where the brush is in the air", where, pose);
            before = pose;
        }
    }
}

}  // namespace

TrackFit fit_tracks(const std::vector<Track>& tracks, const std::vector<double>& start, const TrackOptions& options) {
    refuse_what_cannot_be_fitted(tracks, start, options);
    if (start.size() <= 5) return fit<5>(tracks, start, options);
    return fit<9>(tracks, start, options);
}

}  // namespace brushsvg::fit
