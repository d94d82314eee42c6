#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <string>
#include <vector>

#include "base/parallel.hpp"
#include "mark_fit.hpp"
#include "swept_footprints.hpp"

// Computes the distances of painted edges from predicted ones, with their derivatives. Internal to fit_marks.
namespace brushsvg::fit {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The indices of the unknowns that all marks share.
///
/// The lag is given by control values on [0, deepest] [mm], the tip gap by the contribution of each power at the
/// deepest [mm], the half width by the steps from one control value to the next [mm], and the ratios of the footprint
/// by factors of the Legendre polynomials over [0, deepest].
struct Layout {
    int lag, gap, half;
    int widest_terms, front_terms;
    int machine_numbers;  ///< kMachineErrors or 0
    int gap_at() const { return lag; }
    int half_at() const { return lag + gap; }
    int widest() const { return half_at() + half; }
    int front() const { return widest() + widest_terms; }
    int height() const { return front() + front_terms; }
    int shift() const { return height() + 1; }
    int turn() const { return height() + 3; }
    int machine() const { return height() + 4; }
    int size() const { return machine() + machine_numbers; }
};

class MarkModel {
 public:
    /// coarse: factor on the distance between instants at which the brush is evaluated.
    MarkModel(const std::vector<PaintedMark>& marks, const MarkOptions& options, double coarse = 1.0);

    static Layout make_layout(const MarkOptions& options);
    const Layout& layout() const { return layout_; }
    Index marks() const { return Index(painted_.size()); }
    double spacing_mm() const { return spacing_; }  ///< between points of an outline
    const std::string& stroke(Index mark) const { return painted_[std::size_t(mark)].stroke; }
    Index points(Index mark) const { return painted_[std::size_t(mark)].point_mm.rows(); }
    Index ring_begin(Index mark, std::size_t ring) const { return painted_[std::size_t(mark)].rings[ring]; }
    std::size_t rings(Index mark) const { return painted_[std::size_t(mark)].rings.size() - 1; }
    /// Greatest depth of a mark's stroke [mm].
    double deepest(Index mark) const { return -painted_[std::size_t(mark)].poses_mm.col(2).minCoeff(); }
    std::array<double, 2> centre_mm() const { return {centre_.x(), centre_.y()}; }

    /// Converts laws to the shared unknowns, with and without the limit to their least values, and back.
    VectorXd unlimited_unknowns(const MarkLaws& laws) const;
    VectorXd unknowns(const MarkLaws& laws) const { return unlimited_unknowns(laws).cwiseMax(lower_bounds()); }
    MarkLaws laws(const VectorXd& shared) const;
    /// Derivatives of the quantities in MarkFit::covariance by the shared unknowns.
    MatrixXd to_coefficients() const;
    /// Departures [mm] of each law from a law with the coefficients of `from`, as rows over the shared unknowns. They
    /// are factors of further polynomials that are each 1 at the deepest.
    MatrixXd departure_rows(const Layout& from) const;
    /// Least value of each shared unknown, so that the lag stays above 0 and the half width rises.
    VectorXd lower_bounds() const;
    /// The machine for these unknowns.
    Machine machine(const VectorXd& shared) const;
    /// The poses of a mark as the machine ran them, from the commanded ones.
    Poses realised_path(Index mark, const VectorXd& shared) const;

    /// Switches the derivatives by the machine's numbers off or on.
    void hold_machine(bool hold) { is_machine_held_ = hold; }
    /// Damps the derivatives of the heading of a loose brush on a short lever by the machine's numbers from now on.
    void damp_loose_headings() { loose_headings_damped_ = true; }

    /// Calls work(mark) for every mark, on all processors. Throws Error where the marks have needed so many evaluations
    /// that no brush paints them, with the mark that needed most.
    template <class Work>
    void for_each(Work&& work) const {
        parallel_for(0, painted_.size(), [&](std::size_t mark) { work(Index(mark)); });
        require_bounded_work();
    }

    /// Takes over the count of evaluations from another model of the same marks.
    void continue_counting_from(const MarkModel& other) { evaluations_ = other.evaluations_; }

    /// Computes the distance [mm] of every point of a mark from the predicted edge, and on request the derivatives by
    /// the shared unknowns and by the mark's displacement.
    ///
    /// Outside, it is the distance from the nearest footprint and the area swept between it and its neighbours. Inside,
    /// it is negative: the way out of all footprints, perpendicular to the edge that the painted edge's normal points
    /// to. The depth inside a single footprint would be small for slim footprints. Returns false where there is no
    /// prediction.
    bool distances(Index mark, const double* shared, const double* displacement, VectorXd& distance_mm,
                   RowMajor* by_shared, RowMajor* by_displacement) const;
    /// Width of the prediction [mm] across from the edge at every point of a mark; 0 beyond a tip.
    VectorXd widths(Index mark, const double* shared, const double* displacement) const;
    /// Returns the points of a mark in the frame of the plan.
    Ring points_in_plan_frame(Index mark, const double* shared, const double* displacement) const;

 private:
    struct Painted {
        std::string stroke;
        Poses poses_mm;  ///< begins and ends above the paper
        std::vector<Arc> arcs;
        Eigen::Vector2d approach{0.0, 0.0};  ///< as in MachineState
        std::vector<double> at;
        Ring point_mm, outward;    ///< points of the paint's outline, and unit normals
        std::vector<Index> rings;  ///< first point of each ring, and the end
    };
    void require_bounded_work() const;
    MachineState machine_state(const Painted& painted, const VectorXd& shared) const;
    std::array<double, kMachineErrors> machine_numbers(const VectorXd& shared) const;
    /// Computes the derivatives of a distance by the unknowns of the laws, the height and the machine.
    void law_derivatives(const Instant& now, const InstantDerivatives& by, const NearestEdge& edge,
                         const Eigen::Vector2d& normal, Eigen::Ref<Eigen::RowVectorXd> out) const;

    /// Computes rate times the derivatives of a ratio by its unknowns.
    void ratio_derivatives(double depth, double ratio, double rate, Eigen::Ref<Eigen::RowVectorXd> out) const;

    std::vector<Painted> painted_;
    mutable std::vector<std::uint64_t> evaluations_;  ///< number of evaluations of instants for each mark
    Layout layout_;
    double deepest_, coarse_, spacing_;
    bool round_tail_, has_field_, loose_headings_damped_ = false, is_machine_held_ = false;
    MatrixXd lag_powers_, half_powers_;  ///< matrices from the laws' unknowns to their coefficients
    Eigen::Vector2d centre_;
    FieldBox box_;
};

}  // namespace brushsvg::fit
