#include "bindings.hpp"
#include "brushsvg/region.hpp"

void bind_region(py::module_& m) {
    using namespace brushsvg;
    const auto unlocked = py::call_guard<py::gil_scoped_release>();
    m.def("unite", &unite, py::arg("rings"), unlocked,
          "Union of shapes: counter-clockwise rings fill, the clockwise rings behind one are its holes.");
    m.def("area", &area, py::arg("rings"), "Area [mm^2], holes (clockwise) taken off.");
    m.def("overlap", &overlap, py::arg("rings_a"), py::arg("rings_b"), unlocked,
          "Area of the intersection over area of the union.");
}
