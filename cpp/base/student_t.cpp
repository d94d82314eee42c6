#include "brushsvg/student_t.hpp"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

constexpr double kUpperEnd = 0.975;     // quantile at the upper end of an interval with 2.5 % on either side
constexpr double kLeastFreedom = 0.01;  // with less, an interval would be longer than any number

void require_freedom(double degrees) {
    if (!(degrees >= kLeastFreedom))
        throw Error("out-of-range", "the degrees of freedom are less than 0.01 or no number", "", degrees);
}

}  // namespace

double deviations_of_95(std::optional<double> degrees_of_freedom) {
    if (!degrees_of_freedom) return boost::math::quantile(boost::math::normal(), kUpperEnd);
    require_freedom(*degrees_of_freedom);
    return boost::math::quantile(boost::math::students_t(*degrees_of_freedom), kUpperEnd);
}

double as_normal(double t, double degrees_of_freedom) {
    require_freedom(degrees_of_freedom);
    if (std::isnan(t)) return t;
    constexpr double inf = std::numeric_limits<double>::infinity();
    if (std::isinf(t)) return inf;
    const boost::math::students_t student(degrees_of_freedom);
    const double beyond = boost::math::cdf(boost::math::complement(student, std::abs(t)));
    if (!(beyond > std::numeric_limits<double>::min())) return inf;
    return boost::math::quantile(boost::math::complement(boost::math::normal(), beyond));
}

}  // namespace brushsvg
