#include "bindings.hpp"
#include "brushsvg/thin_out.hpp"

void bind_thin_out(py::module_& m) {
    using namespace brushsvg;
    m.def("thin_out", &thin_out, py::arg("pass_"), py::arg("brush"), py::arg("tolerance_mm") = 0.05,
          py::call_guard<Unlocked>(),
          "The pass with fewer poses, its mark's middle and edges within the tolerance of where they were.");
}
