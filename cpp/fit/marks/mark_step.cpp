#include "mark_step.hpp"

#include <algorithm>

namespace brushsvg::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The loss over the shared unknowns alone, every mark's own ones being where it is least (Schur's complement).
void without_own(const LossNear& near, MatrixXd& bend, VectorXd& slope) {
    bend = near.bend;
    slope = near.slope;
    for (const LossNear::Own& own : near.own) {
        const Eigen::Matrix2d inverse = own.bend.inverse();
        bend.noalias() -= own.mixed * inverse * own.mixed.transpose();
        slope.noalias() -= own.mixed * (inverse * own.slope);
    }
}

LossNear damped(LossNear near, double damping) {
    near.bend.diagonal() *= 1.0 + damping;
    for (LossNear::Own& own : near.own) own.bend.diagonal() *= 1.0 + damping;
    return near;
}

/// To the least over those of the unknowns that are free, the others moving as told; in units of their own sizes.
VectorXd least_over(const MatrixXd& bend, const VectorXd& slope, const std::vector<bool>& fixed, const VectorXd& told) {
    std::vector<Index> free;
    for (Index i = 0; i < slope.size(); ++i)
        if (!fixed[std::size_t(i)]) free.push_back(i);
    VectorXd out = told;
    if (free.empty()) return out;
    const VectorXd pulled = -(slope + bend * told)(free);
    const MatrixXd among = bend(free, free);
    const VectorXd unit = among.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = unit.asDiagonal() * among * unit.asDiagonal();
    out(free) = unit.asDiagonal() * scaled.ldlt().solve(unit.asDiagonal() * pulled);
    return out;
}

}  // namespace

MarkStep step_to_least(const LossNear& near, const VectorXd& shared, const VectorXd& least,
                       const std::vector<bool>& held, double damping) {
    const LossNear stiff = damped(near, damping);
    MatrixXd bend;
    VectorXd slope;
    without_own(stiff, bend, slope);
    std::vector<bool> fixed = held;
    MarkStep out;
    out.shared = VectorXd::Zero(shared.size());
    VectorXd told = out.shared;
    for (Index round = 0; round <= shared.size(); ++round) {  // each goes to its bound once
        out.shared = least_over(bend, slope, fixed, told);
        bool is_within = true;
        for (Index i = 0; i < shared.size(); ++i) {
            if (fixed[std::size_t(i)] || shared[i] + out.shared[i] >= least[i]) continue;
            fixed[std::size_t(i)] = true;
            told[i] = std::min(0.0, least[i] - shared[i]);
            is_within = false;
        }
        if (is_within) break;
    }
    out.gain = -out.shared.dot(near.slope + 0.5 * near.bend * out.shared);
    for (std::size_t i = 0; i < near.own.size(); ++i) {
        const LossNear::Own& own = near.own[i];
        const Eigen::Vector2d pulled = own.slope + own.mixed.transpose() * out.shared;
        out.own.push_back(-stiff.own[i].bend.inverse() * pulled);
        out.gain -= out.own.back().dot(pulled + 0.5 * own.bend * out.own.back());
    }
    return out;
}

}  // namespace brushsvg::fit
