#include "bindings.hpp"
#include "brushsvg/paint_loads.hpp"

void bind_paint_loads(py::module_& m) {
    using namespace brushsvg;
    m.def(
        "split_into_loads",
        [](const Pass& pass, const Brush& brush, double first_mm, double every_mm, double backtrack_mm) {
            const ReleasedGil release;
            return split_into_loads(pass, brush, {first_mm, every_mm, backtrack_mm});
        },
        py::arg("a_pass"), py::arg("brush"), py::arg("first_mm"), py::arg("every_mm"), py::arg("backtrack_mm") = 5.0,
        R"(Split a pass into parts, between which the brush is lifted to fetch paint.

The parts are called stroke, stroke+2, ...

first_mm: path of the TCP for which the paint on the brush still lasts.
every_mm: path of the TCP for which the paint lasts after each refill.
backtrack_mm: how far back in the mark of the previous part each part begins, so that no gap shows.

Raises Error if the paint does not last for more than twice the backtrack.)");
}
