#pragma once

#include <optional>

namespace [[gnu::visibility("default")]] brushsvg {

/// Half of a 95 % interval in standard deviations: the quantile of Student's t where the deviation was itself found
/// from so many spare values, or of the normal distribution where nobody says from how many.
double deviations_of_95(std::optional<double> degrees_of_freedom);

/// Size of a normal value as unlikely as t with so many degrees of freedom; infinite where no number is so unlikely.
double as_normal(double t, double degrees_of_freedom);

}  // namespace brushsvg
