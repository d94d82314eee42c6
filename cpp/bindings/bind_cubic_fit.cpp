#include "bindings.hpp"
#include "brushsvg/cubic_fit.hpp"

void bind_cubic_fit(py::module_& m) {
    using namespace brushsvg;
    m.def(
        "fit_cubics",
        [](const WideLine& line, double tolerance_mm, bool closed) {
            const FittedLine fitted = fit_cubics(line, tolerance_mm, closed);
            std::vector<std::pair<double, double>> knots;
            for (const WidthKnot& k : fitted.half_width) knots.emplace_back(k.at, k.half_width_mm);
            return std::make_pair(fitted.middle_mm, knots);
        },
        py::arg("line"), py::arg("tolerance_mm"), py::arg("closed") = false,
        R"(Fit few cubics and half widths to a line of points, within a tolerance.

Returns the cubics (n, 8) [mm] and the half widths along them [(fraction of arc length, mm)].

line: points (k, 3): x, y, half width [mm].
tolerance_mm: largest distance from the points.
closed: whether the last point repeats the first one.)");
}
