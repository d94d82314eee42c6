// A lag fitted to values read with a ruler, and to angles, by the installed brushsvg::fit alone.
#include <brushsvg/fit/angles.hpp>
#include <brushsvg/fit/law_fit.hpp>
#include <cmath>
#include <cstdio>

int main() {
    using namespace brushsvg::fit;
    LawShape shape;
    shape.degree = 1;
    shape.positive = true;
    const LawFit fit = fit_law({1.0, 3.0, 5.0, 7.0}, {4.1, 6.0, 7.9, 10.0}, shape);
    const FromAngles seen = from_angles({std::acos(0.0), {3.0}, {0.705026844}, {}}, Lines::plain);
    std::printf("lag %.2f mm at depth 4 mm, +- %.2f mm per mm; %.3f mm from angles\n", fit.law(4.0),
                fit.law.half_interval_95.at(1), seen.lag_mm);
    return std::abs(fit.law(4.0) - 7.0) < 0.01 && std::abs(seen.lag_mm - 3.0) < 1e-6 ? 0 : 1;
}
