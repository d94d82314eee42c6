#include "bindings.hpp"
#include "brushsvg/simplify_pass.hpp"

void bind_simplify_pass(py::module_& m) {
    using namespace brushsvg;
    m.def("simplify_pass", &simplify_pass, py::arg("pass_"), py::arg("brush"), py::arg("tolerance_mm") = 0.05,
          py::call_guard<ReleasedGil>(),
          R"(Simplify a pass: return a pass with fewer poses.

The middle and the edges of the mark stay within the tolerance [mm] of where they were.)");
}
