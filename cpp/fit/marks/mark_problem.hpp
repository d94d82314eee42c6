#pragma once

#include <vector>

#include "mark_loss.hpp"
#include "mark_model.hpp"

namespace brushsvg::fit {

/// The whole least-squares problem and its current state: unknowns that all marks share, and a displacement per mark.
class MarkProblem {
 public:
    /// coarse: as in MarkModel.
    MarkProblem(const std::vector<PaintedMark>& marks, const MarkOptions& options, double coarse = 1.0);

    /// Starts at these laws, with the prior means of the footprint's shape and the height, and no displacements.
    void start_at(const MarkLaws& laws);
    /// Holds the footprint's shape constant, and on request the machine as well.
    void hold_shape(bool hold, bool hold_machine);
    /// Corrects marks that were matched with the wrong edge, such as the near edge of a displaced stroke. A mark with
    /// a distant part is moved to where this part is near, if that costs less.
    void correct_displaced_marks();
    /// Leaves out points at which the prediction is hardly wider than the noise of its edges. Noise cannot make the
    /// paint at a pointed end narrower than 0, so that it makes the end longer, and the paper seems nearer.
    void ignore_narrow_points();
    /// Returns half the loss of each mark, infinite where there is no prediction.
    VectorXd losses() const;
    /// Returns half the loss of all marks.
    double loss() const;
    /// Throws Error where the laws, which the caller chose, predict no mark for a stroke.
    void require_prediction() const;
    /// Minimises the loss until a step lowers it by less than `tolerance`, as a share of the loss. Returns whether it
    /// converged.
    bool solve(int max_iterations, double tolerance);
    /// Sets the prior of the departures of laws: each row maps the shared unknowns to a standard normal number.
    void set_departure_prior(const MatrixXd& rows);
    bool is_departing() const { return departs_; }
    /// Adds the information of the priors, over all shared unknowns and then both displacements of every mark.
    void add_prior_information(MatrixXd& to) const;
    /// Returns the gradient of the priors over the same unknowns.
    VectorXd prior_gradient() const;

    MarkModel model;
    Weighing weighing;
    VectorXd shared;
    std::vector<Eigen::Vector2d> displacements_mm;
    std::vector<VectorXd> point_weights;  ///< for every mark: 1 for each point that counts, 0 for the others
    int iterations = 0;

 private:
    /// Returns half the loss of one mark at a displacement, without its prior, infinite where there is no prediction.
    double loss_of(Index mark, const Eigen::Vector2d& displacement) const;

    double displacement_mm_;
    std::vector<Prior> priors_;
    MatrixXd law_prior_rows_;  ///< rows of LawPrior over the shared unknowns; empty where nothing is known
    VectorXd law_prior_mean_;
    std::vector<bool> is_held_;
    bool departs_ = false;
};

}  // namespace brushsvg::fit
