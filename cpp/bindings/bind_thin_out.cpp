#include "bindings.hpp"
#include "brushsvg/thin_out.hpp"

void bind_thin_out(py::module_& m) {
    using namespace brushsvg;
    m.def("thin_out", &thin_out, py::arg("pass_"), py::arg("brush"), py::arg("tolerance_mm") = 0.05,
          py::call_guard<Unlocked>(),
          R"(Simplify a pass: return a pass with fewer poses.

The middle and the edges of the mark stay within the tolerance [mm] of where they were.)");
}
