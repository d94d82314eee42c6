#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "brushsvg/lag.hpp"
#include "brushsvg/plan.hpp"
#include "brushsvg/ring.hpp"

// Computes the path that a machine runs for a commanded one. Internal to fit_marks.
namespace brushsvg::fit {

constexpr int kMachineErrors = 15;  // number of a machine's errors, in the order of MachineIndex

/// First index of each error of a machine: x and then y, and for the field three numbers of x and then three of y.
struct MachineIndex {
    static constexpr int lean = 0, scale = 2, skew = 4, tilt = 5, backlash = 7, field = 9;
};

/// The box of all commanded places, where a field over the sheet is known.
struct FieldBox {
    Eigen::Vector2d middle{0.0, 0.0}, reach{1.0, 1.0};  ///< reach: half its sides [mm]
    /// Returns u^2, u v, v^2 of a place, where u and v go from -1 to 1 over the box.
    Eigen::Vector3d terms(const Eigen::Vector2d& place) const {
        const Eigen::Vector2d uv = (place - middle).cwiseQuotient(reach);
        return {uv.x() * uv.x(), uv.x() * uv.y(), uv.y() * uv.y()};
    }
};

/// The machine at the current state of a fit. by: its errors, with scale as its difference from 1. approach: direction
/// of the last motion in x and in y before the first pose, -1, 0 or 1.
struct MachineState {
    std::array<double, kMachineErrors> by;
    Eigen::Vector2d centre, approach;
    const FieldBox& box;
    bool has_field;  ///< a field is requested; its derivatives need a third of the time
};

/// Returns how far each axis is behind its command at each pose. An axis that reverses does not move for its whole
/// backlash. With a negative backlash, it is ahead of its command by the same distance.
template <class T>
std::vector<Vec2<T>> backlash_offsets(const Poses& poses, const MachineState& machine,
                                      const std::array<T, kMachineErrors>& by) {
    constexpr double kMinAxisMoveMm = 1e-6;
    std::vector<Vec2<T>> out(std::size_t(poses.rows()));
    for (int axis = 0; axis < 2; ++axis) {
        const T half = 0.5 * by[std::size_t(MachineIndex::backlash + axis)];
        const double way = half < T(0.0) ? -1.0 : 1.0;
        const T most = way * half;
        T behind = machine.approach[axis] * most;
        for (Eigen::Index i = 0; i < poses.rows(); ++i) {
            const double step = i ? poses(i, axis) - poses(i - 1, axis) : 0.0;
            if (std::abs(step) > kMinAxisMoveMm) behind += step;
            if (behind > most)
                behind = most;
            else if (behind < -most)
                behind = -most;
            out[std::size_t(i)][axis] = way * behind;
        }
    }
    return out;
}

/// The TCP's path as a machine with errors runs the command, for any scalar type.
template <class T>
struct RealisedPath {
    const Poses& poses;
    const std::vector<Arc>& arcs;
    const MachineState& machine;
    T deeper_mm;
    std::array<T, kMachineErrors> by;
    std::vector<Vec2<T>> behind;

    Eigen::Index count() const { return poses.rows(); }
    Eigen::Vector2d from_centre(Eigen::Index i) const {
        return poses.row(i).template head<2>().transpose() - machine.centre;
    }
    T depth(Eigen::Index i) const {
        const Eigen::Vector2d at = from_centre(i);
        return T(deeper_mm - poses(i, 2) + by[MachineIndex::tilt] * at.x() + by[MachineIndex::tilt + 1] * at.y());
    }
    Vec2<T> tcp(Eigen::Index i) const {
        const Eigen::Vector2d at = from_centre(i);
        const Vec2<T>& late = behind[std::size_t(i)];
        const T d = depth(i);
        Vec2<T> out{T(poses(i, 0) + by[MachineIndex::scale] * at.x() + by[MachineIndex::skew] * at.y() +
                      by[MachineIndex::lean] * d - late[0]),
                    T(poses(i, 1) + by[MachineIndex::scale + 1] * at.y() + by[MachineIndex::lean + 1] * d - late[1])};
        if (!machine.has_field) return out;
        const Eigen::Vector3d terms = machine.box.terms(poses.row(i).template head<2>().transpose());
        for (int axis = 0; axis < 2; ++axis)
            for (int k = 0; k < 3; ++k) out[axis] += by[std::size_t(MachineIndex::field + 3 * axis + k)] * terms[k];
        return out;
    }
    T turn(const Arc&, Eigen::Index) const { return T(0.0); }  // there are no arcs, because circles do not stay circles
};

}  // namespace brushsvg::fit
