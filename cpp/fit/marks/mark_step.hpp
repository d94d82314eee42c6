#pragma once

#include <Eigen/Dense>
#include <vector>

// One step towards less loss. Inside fit_marks.
namespace brushsvg::fit {

/// Half the loss beside a place, to second order, over unknowns that all marks share and two of each mark's own.
struct LossNear {
    /// Slopes and second derivatives that a mark adds for its own unknowns, and those mixed with the shared ones.
    struct Own {
        Eigen::Vector2d slope;
        Eigen::Matrix2d bend;
        Eigen::Matrix<double, Eigen::Dynamic, 2> mixed;
    };
    double loss = 0.0;
    Eigen::VectorXd slope;
    Eigen::MatrixXd bend;
    std::vector<Own> own;
};

/// By how much to move all unknowns, and by how much the loss is to fall.
struct MarkStep {
    Eigen::VectorXd shared;
    std::vector<Eigen::Vector2d> own;
    double gain = 0.0;
};

/// To the least of that loss, with second derivatives 1 + damping times as large in each unknown: the larger, the
/// shorter the step. Nothing goes below its least value; what is held stays.
MarkStep step_to_least(const LossNear& near, const Eigen::VectorXd& shared, const Eigen::VectorXd& least,
                       const std::vector<bool>& held, double damping);

}  // namespace brushsvg::fit
