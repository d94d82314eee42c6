#pragma once

#include <Eigen/Core>
#include <vector>

#include "brushsvg/lag.hpp"

// Many strokes through the law at once, one in each lane: other ways of the TCP, other lags, or both.
namespace [[gnu::visibility("default")]] brushsvg {

/// (rows, lanes), lanes beside each other in memory.
using Lanes = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The TCP's ways [mm], row by row: straight lines on which the depth is linear, or arcs. One lane: all lags follow it.
/// Where depth_mm is below 0 the brush is in the air; where the way crosses 0 it is set down or lifted.
struct ManyWays {
    Lanes x_mm, y_mm, depth_mm;
    /// (rows - 1, lanes): by how much the direction turns [rad] from a row to the next, counter-clockwise > 0, by less
    /// than a whole turn: a circular arc at the depth where it begins. 0, or no rows at all: straight lines.
    Lanes turn_rad;
};

/// What the patches do at each row. In the air p is q, and the heading the last there was. Rows from where a brush is
/// set down to its first motion take the heading of that, as those before it where there was none yet; (1, 0) if none
/// comes.
struct ManyStates {
    Lanes contact_x_mm, contact_y_mm;  ///< p
    Lanes heading_x, heading_y;        ///< u, a unit vector
    Eigen::Array<unsigned char, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> taut;
};

/// Each lane as advance() carries one brush from row to row, to 1e-12 mm: with vector instructions, as wide as the
/// machine has them, where all that happens is that patches are dragged along straight lines or rest; one by one where
/// there are events or arcs. lags: one, or one for each lane.
///
/// Throws Error when there is no row or lag, when sizes do not agree, a number is not finite, a place beyond 1e6 mm, a
/// depth beyond a lag's range, or a turn is a whole one.
ManyStates follow_many(const ManyWays& ways, const std::vector<LagLaw<double>>& lags);

/// The same into what an earlier call returned: memory of the same size is used again.
void follow_many(const ManyWays& ways, const std::vector<LagLaw<double>>& lags, ManyStates& out);

}  // namespace brushsvg
