#include "bindings.hpp"
#include "brushsvg/curve_fit.hpp"

void bind_curve_fit(py::module_& m) {
    using namespace brushsvg;
    m.def(
        "fit_curve",
        [](const WideLine& line, double tolerance_mm, bool closed) {
            const FittedLine fitted = fit_curve(line, tolerance_mm, closed);
            std::vector<std::pair<double, double>> knots;
            for (const WidthKnot& k : fitted.half_width) knots.emplace_back(k.at, k.half_width_mm);
            return std::make_pair(fitted.middle_mm, knots);
        },
        py::arg("line"), py::arg("tolerance_mm"), py::arg("closed") = false,
        R"(Few cubics (n, 8) along the points (k, 3) of x, y, half width [mm], and the half widths along them
[(fraction of arc length, mm)], within the tolerance.)");
}
