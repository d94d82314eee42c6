#pragma once

#include <optional>

namespace [[gnu::visibility("default")]] brushsvg {

/// Return half of a 95 % interval, in standard deviations.
///
/// It is the quantile of Student's t if the standard deviation was itself estimated, with `degrees_of_freedom` spare
/// values. If that number is not known, it is the quantile of the normal distribution.
double interval_factor_95(std::optional<double> degrees_of_freedom);

/// Return the size of a normal value that is as unlikely as a value of Student's t.
///
/// Infinite if no number is that unlikely.
double normal_equivalent(double t, double degrees_of_freedom);

}  // namespace brushsvg
