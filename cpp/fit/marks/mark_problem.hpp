#pragma once

#include <vector>

#include "mark_loss.hpp"
#include "mark_model.hpp"

namespace brushsvg::fit {

/// The whole least-squares problem at one place: unknowns that all marks share, and a displacement for each mark.
class MarkProblem {
 public:
    /// coarse: as in MarkModel.
    MarkProblem(const std::vector<PaintedMark>& marks, const MarkOptions& options, double coarse = 1.0);

    /// To these laws; the footprint's shape and the height as known beforehand, no displacements.
    void begin(const MarkLaws& laws);
    /// The footprint's shape stays as it is, and the machine, too, where that is held.
    void hold_shape(bool hold, bool hold_machine);
    /// Marks of which a part is far off may have been matched with the wrong edge, the near one of a stroke that is
    /// displaced by its width: they are moved to where that part is near, if that costs less.
    void find_displaced();
    /// Points at which the prediction is hardly wider than its edges err have no say from now on. At a pointed
    /// end noise never leaves the paint narrower than nothing: it draws the end out, and the paper seems nearer.
    void leave_slim_aside();
    /// Half the loss of each mark; infinite where there is no prediction.
    VectorXd losses() const;
    /// Half the loss of all marks.
    double loss() const;
    /// Throws Error where these laws, which the caller chose, predict no mark for a stroke.
    void require_prediction() const;
    /// tolerance: ends when a step lowers the loss by less than this share of it. Whether it ended so.
    bool solve(int most_iterations, double tolerance);
    /// Laws depart from their numbers by no more than is expected: each of these rows makes a standard normal number of
    /// the shared unknowns.
    void expect(const MatrixXd& rows);
    bool is_departing() const { return departs_; }
    /// Adds the information of the priors, over every shared unknown and then both displacements of every mark.
    void add_known(MatrixXd& to) const;
    /// Gradient of the priors over the same unknowns.
    VectorXd known_gradient() const;

    MarkModel model;
    Weighing weighing;
    VectorXd shared;
    std::vector<Eigen::Vector2d> own;
    std::vector<VectorXd> says;  ///< of every mark: 1 for each point that has a say, 0 for the others
    int iterations = 0;

 private:
    /// Half the loss of one mark at a displacement, without its prior; infinite where there is no prediction.
    double loss_of(Index mark, const Eigen::Vector2d& displacement) const;

    double displacement_mm_;
    std::vector<Prior> priors_;
    MatrixXd law_rows_;  ///< of LawPrior, over the shared unknowns; none where nothing is known
    VectorXd law_mean_;
    std::vector<bool> held_;
    bool departs_ = false;
};

}  // namespace brushsvg::fit
