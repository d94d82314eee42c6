#include "bindings.hpp"
#include "brushsvg/paint_loads.hpp"

void bind_paint_loads(py::module_& m) {
    using namespace brushsvg;
    m.def(
        "interrupted",
        [](const Pass& pass, const Brush& brush, double first_mm, double every_mm, double backtrack_mm) {
            const Unlocked release;
            return interrupted(pass, brush, {first_mm, every_mm, backtrack_mm});
        },
        py::arg("a_pass"), py::arg("brush"), py::arg("first_mm"), py::arg("every_mm"), py::arg("backtrack_mm") = 5.0,
        R"(A pass in parts, between which the brush is lifted to fetch paint.

first_mm: path of the TCP that the paint on the brush still lasts; every_mm: that it lasts after each visit; each part
begins backtrack_mm back in the mark of the one before, so that no gap shows. Parts are named stroke, stroke+2, ...
Error for a paint that lasts no more than twice the backtrack.)");
}
