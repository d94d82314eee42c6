#include "bindings.hpp"
#include "brushsvg/footprint.hpp"

void bind_footprint(py::module_& m) {
    using namespace brushsvg;
    py::class_<Footprint>(m, "Footprint",
                          "Contact patch outline (n, 2) [mm] at one depth [mm]; first vertex the tip at (0, 0).")
        .def(py::init([](double depth_mm, const Ring& outline_mm) { return Footprint{depth_mm, outline_mm}; }),
             py::arg("depth_mm"), py::arg("outline_mm"))
        .def_readonly("depth_mm", &Footprint::depth_mm)
        .def_readonly("outline_mm", &Footprint::outline_mm);
    py::class_<FootprintTable>(m, "FootprintTable", "Footprints in tuples, depths ascending; pressed may be empty.")
        .def(py::init([](std::vector<Footprint> dragged, std::vector<Footprint> pressed) {
                 return FootprintTable{std::move(dragged), std::move(pressed)};
             }),
             py::arg("dragged") = std::vector<Footprint>{}, py::arg("pressed") = std::vector<Footprint>{})
        .def_property_readonly("dragged", parts(&FootprintTable::dragged))
        .def_property_readonly("pressed", parts(&FootprintTable::pressed));
    m.def("footprint_at", &footprint_at, py::arg("table"), py::arg("depth_mm"), py::arg("pull") = 1.0,
          "Outline (n, 2) [mm] at a depth [mm], tip at the origin; pull = r'/r blends pressed (0) and dragged (1).");
}
