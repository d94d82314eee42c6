#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <string>
#include <vector>

#include "base/parallel.hpp"
#include "mark_fit.hpp"
#include "swept_footprints.hpp"

// Distances of painted edges from predicted ones, with their derivatives. Inside fit_marks.
namespace brushsvg::fit {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Where each unknown stands that all marks share. The lag stands as control values on [0, deepest] [mm], the tip gap
/// as what each power adds at the deepest [mm], the half width as the steps from one control value to the next [mm],
/// the ratios of the footprint as factors of the Legendre polynomials over [0, deepest].
struct Layout {
    int lag, gap, half;
    int widest_terms, front_terms;
    int machine_numbers;  ///< kMachine or none
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
    /// coarse: so many times as far apart as they should be are the instants at which the brush is looked at.
    MarkModel(const std::vector<PaintedMark>& marks, const MarkOptions& options, double coarse = 1.0);

    static Layout layout_of(const MarkOptions& options);
    const Layout& layout() const { return layout_; }
    Index marks() const { return Index(painted_.size()); }
    double spacing_mm() const { return spacing_; }  ///< between points of an outline
    const std::string& stroke(Index mark) const { return painted_[std::size_t(mark)].stroke; }
    Index points(Index mark) const { return painted_[std::size_t(mark)].point_mm.rows(); }
    Index ring_begin(Index mark, std::size_t ring) const { return painted_[std::size_t(mark)].rings[ring]; }
    std::size_t rings(Index mark) const { return painted_[std::size_t(mark)].rings.size() - 1; }
    /// How deep a mark's stroke is pressed [mm].
    double deepest(Index mark) const { return -painted_[std::size_t(mark)].poses_mm.col(2).minCoeff(); }
    std::array<double, 2> centre_mm() const { return {centre_.x(), centre_.y()}; }

    /// The shared unknowns of laws, at any place; at their least values or above; and back.
    VectorXd unbounded(const MarkLaws& laws) const;
    VectorXd unknowns(const MarkLaws& laws) const { return unbounded(laws).cwiseMax(least()); }
    MarkLaws laws(const VectorXd& shared) const;
    /// d(what MarkFit::covariance is about) / d(shared unknowns).
    MatrixXd to_coefficients() const;
    /// Rows over the shared unknowns: by how much each law departs [mm] from one of so many numbers, as factors of
    /// polynomials that these do not hold, of which each is 1 at the deepest.
    MatrixXd departures(const Layout& from) const;
    /// Least value of each shared unknown; the lag stays above 0, the half width rises.
    VectorXd least() const;
    /// What the machine is at these unknowns.
    Machine machine(const VectorXd& shared) const;
    /// A mark's poses as commanded, as the machine ran them.
    Poses run(Index mark, const VectorXd& shared) const;

    /// From now on there are no derivatives by the machine's numbers, or there are.
    void hold_machine(bool hold) { is_machine_held_ = hold; }
    /// From now on derivatives say little of what the machine does to the heading of a loose brush on a short lever.
    void doubt_headings() { headings_doubted_ = true; }

    /// work(mark) for every mark, on all processors. Throws Error where these marks have taken so many looks that no
    /// brush paints them: it names the one that took most.
    template <class Work>
    void for_each(Work&& work) const {
        on_all_processors(0, painted_.size(), [&](std::size_t mark) { work(Index(mark)); });
        refuse_endless();
    }

    /// The looks that another model of the same marks took count on here.
    void go_on_counting(const MarkModel& other) { looks_ = other.looks_; }

    /// Distance [mm] of every point of a mark from the predicted edge; derivatives by the shared unknowns and by the
    /// mark's displacement on request. Outside it is that from the nearest footprint and what it sweeps to its
    /// neighbours. Inside it is negative: how far it is out of all footprints, square to the edge that the painted
    /// edge's normal points to, and not how deep it is in one of them, of which slim footprints would make little.
    /// False where there is no prediction.
    bool distances(Index mark, const double* shared, const double* displacement, VectorXd& distance_mm,
                   RowMajor* by_shared, RowMajor* by_displacement) const;
    /// How far it is [mm] from the predicted edge at every point of a mark across to the other one; 0 beyond a tip.
    VectorXd widths(Index mark, const double* shared, const double* displacement) const;
    /// The points of a mark in the frame of the plan.
    Ring placed(Index mark, const double* shared, const double* displacement) const;

 private:
    struct Painted {
        std::string stroke;
        Poses poses_mm;  ///< from above the paper and back there
        std::vector<Arc> arcs;
        Eigen::Vector2d came{0.0, 0.0};  ///< as in MachineHere
        std::vector<double> at;
        Ring point_mm, outward;    ///< of the paint, unit vectors
        std::vector<Index> rings;  ///< where each begins, and the end
    };
    void refuse_endless() const;
    MachineHere machine_here(const Painted& painted, const VectorXd& shared) const;
    std::array<double, kMachine> machine_numbers(const VectorXd& shared) const;
    /// Derivatives of a distance by the laws' unknowns and the height.
    void by_laws(const Instant& now, const InstantBy& by, const NearestEdge& edge, const Eigen::Vector2d& normal,
                 Eigen::Ref<Eigen::RowVectorXd> out) const;

    /// rate times the derivatives of a ratio by its unknowns.
    void ratio_by(double depth, double ratio, double rate, Eigen::Ref<Eigen::RowVectorXd> out) const;

    std::vector<Painted> painted_;
    mutable std::vector<std::uint64_t> looks_;  ///< of each mark, at instants of its pass: what was spent on it
    Layout layout_;
    double deepest_, coarse_, spacing_;
    bool round_tail_, is_bent_, headings_doubted_ = false, is_machine_held_ = false;
    MatrixXd lag_powers_, half_powers_;  ///< coefficients of the laws from their unknowns
    Eigen::Vector2d centre_;
    FieldBox box_;
};

}  // namespace brushsvg::fit
