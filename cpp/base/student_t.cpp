#include "brushsvg/student_t.hpp"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "base/format_text.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

constexpr double kUpperQuantile = 0.975;       // quantile at the upper end of an interval with 2.5 % on either side
constexpr double kMinDegreesOfFreedom = 0.01;  // with less, an interval would be longer than any number

void require_degrees_of_freedom(double degrees) {
    if (!(degrees >= kMinDegreesOfFreedom))
        throw Error("out-of-range", format_text("the degrees of freedom are %.4g, but must be at least 0.01", degrees),
                    "", degrees);
}

}  // namespace

double interval_factor_95(std::optional<double> degrees_of_freedom) {
    if (!degrees_of_freedom) return boost::math::quantile(boost::math::normal(), kUpperQuantile);
    require_degrees_of_freedom(*degrees_of_freedom);
    return boost::math::quantile(boost::math::students_t(*degrees_of_freedom), kUpperQuantile);
}

double normal_equivalent(double t, double degrees_of_freedom) {
    require_degrees_of_freedom(degrees_of_freedom);
    if (std::isnan(t)) return t;
    constexpr double inf = std::numeric_limits<double>::infinity();
    if (std::isinf(t)) return inf;
    const boost::math::students_t student(degrees_of_freedom);
    const double tail_probability = boost::math::cdf(boost::math::complement(student, std::abs(t)));
    if (!(tail_probability > std::numeric_limits<double>::min())) return inf;
    return boost::math::quantile(boost::math::complement(boost::math::normal(), tail_probability));
}

}  // namespace brushsvg
