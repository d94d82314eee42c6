#pragma once

#include <array>
#include <vector>

#include "brushsvg/lag.hpp"
#include "brushsvg/plan.hpp"
#include "brushsvg/ring.hpp"

// Where a machine takes the tool that was told to go elsewhere. Inside fit_marks.
namespace brushsvg::fit {

constexpr int kMachine = 9;  // numbers of a machine, in the order of MachineAt

/// First of each number of a machine: of two, x and then y.
struct MachineAt {
    static constexpr int lean = 0, scale = 2, skew = 4, tilt = 5, backlash = 7;
};

/// What a machine does at one place of a fit. by: scale as what it is more than 1. travel: for each pose the direction
/// from which x and y came there, -1, 0 or 1.
struct MachineHere {
    std::array<double, kMachine> by;
    Eigen::Vector2d centre;
    const Ring& travel;
};

/// The TCP's way as such a machine runs what was told, on any scalar.
template <class T>
struct RunWay {
    const Poses& poses;
    const std::vector<Arc>& arcs;
    const MachineHere& machine;
    T deeper_mm;
    std::array<T, kMachine> by;

    Eigen::Index count() const { return poses.rows(); }
    Eigen::Vector2d from_centre(Eigen::Index i) const {
        return poses.row(i).template head<2>().transpose() - machine.centre;
    }
    T depth(Eigen::Index i) const {
        const Eigen::Vector2d at = from_centre(i);
        return T(deeper_mm - poses(i, 2) + by[MachineAt::tilt] * at.x() + by[MachineAt::tilt + 1] * at.y());
    }
    Vec2<T> tcp(Eigen::Index i) const {
        const Eigen::Vector2d at = from_centre(i), behind = 0.5 * machine.travel.row(i).transpose();
        const T d = depth(i);
        return {T(poses(i, 0) + by[MachineAt::scale] * at.x() + by[MachineAt::skew] * at.y() + by[MachineAt::lean] * d -
                  by[MachineAt::backlash] * behind.x()),
                T(poses(i, 1) + by[MachineAt::scale + 1] * at.y() + by[MachineAt::lean + 1] * d -
                  by[MachineAt::backlash + 1] * behind.y())};
    }
    T turn(const Arc&, Eigen::Index) const { return T(0.0); }  // it has none: circles are no circles
};

}  // namespace brushsvg::fit
