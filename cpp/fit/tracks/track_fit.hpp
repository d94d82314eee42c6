#pragma once

#include <array>
#include <vector>

#include "brushsvg/plan.hpp"
#include "brushsvg/profile.hpp"
#include "brushsvg/ring.hpp"

// The lag r(d) from strokes along which the patch was seen while the TCP went a known way. Lengths in mm.
namespace brushsvg::fit {

/// One stroke: where the TCP went, and where the patch was seen at some places of that way.
struct Track {
    Poses poses_mm;            ///< z = -depth; straight moves
    std::vector<double> pose;  ///< of each sample: index into the poses, fractional in between; ascending
    Ring seen_mm;              ///< (n, 2)
    double heading_rad = std::numeric_limits<double>::quiet_NaN();  ///< at the first pose, dragged; nan: set down there
};

/// Which displacement of a stroke is an unknown of its own.
enum class Displaced { no, along, both };  ///< along: in the direction of its first motion

struct TrackOptions {
    std::array<double, 2> range_mm{0.0, 10.0};  ///< depths on which the law must be positive
    std::vector<double> lever_mm;  ///< what was seen is e(d) ahead of the centre of friction: its coefficients
    bool free_heading = false;     ///< each stroke's heading at its first pose is an unknown, for strokes that have one
    Displaced displaced = Displaced::no;
    int most_iterations = 50;
};

struct TrackFit {
    Profile lag;                                  ///< with half_interval_95 and rmse_mm
    std::vector<std::vector<double>> covariance;  ///< of its coefficients
    std::vector<double> heading_rad;              ///< per stroke, as found or given
    Ring displacement_mm;                         ///< per stroke
    std::vector<double> residual_mm;              ///< x, y of every sample: predicted minus seen
    int degrees_of_freedom = 0;
    int iterations = 0;
    bool converged = false;
};

/// Least squares through the closed form (article (7)), with automatic derivatives; what belongs to one stroke alone
/// is eliminated stroke by stroke. `start`: coefficients to begin from; their number is that of the law.
///
/// Covariance: s^2 of the normal matrix's inverse, samples taken as independent. Throws Error: numbers that are not
/// finite, samples outside their stroke, a start that is not positive, unknowns that the samples leave open.
TrackFit fit_tracks(const std::vector<Track>& tracks, const std::vector<double>& start, const TrackOptions& options);

}  // namespace brushsvg::fit
