#include "bindings.hpp"
#include "brushsvg/mark_overlap.hpp"

void bind_mark_overlap(py::module_& m) {
    using namespace brushsvg;
    py::class_<CommonArea> type(m, "CommonArea", "Areas [mm^2] of paint and target mark.");
    type.def(py::init([](double common_mm2, double together_mm2) { return CommonArea{common_mm2, together_mm2}; }),
             py::arg("common_mm2"), py::arg("together_mm2"))
        .def_readonly("common_mm2", &CommonArea::common_mm2)
        .def_readonly("together_mm2", &CommonArea::together_mm2)
        .def_property_readonly("overlap", &CommonArea::overlap)
        .def("__repr__", [](const CommonArea& a) {
            return "<CommonArea: " + in_digits(a.common_mm2) + " of " + in_digits(a.together_mm2) + " mm^2>";
        });
    as_fixed_value(type);
    m.def(
        "common_area",
        [](const std::vector<PassMarks>& painted, const std::vector<Stroke>& wanted, const Brush& brush) {
            return common_area(painted, wanted, brush);
        },
        py::arg("painted"), py::arg("wanted"), py::arg("brush"), py::call_guard<Unlocked>(),
        "What passes of marks and the strokes they should be have in common, counted in pixels: a CommonArea.");
    m.def("common_areas", &common_areas, py::arg("painted"), py::arg("wanted"), py::arg("groups"), py::arg("brush"),
          py::call_guard<Unlocked>(),
          "The same of each of some groups, lists of numbers as touching() gives them: a CommonArea each.");
    m.def(
        "wanted_coverage",
        [](const std::vector<Stroke>& wanted, const std::array<double, 4>& w, double px_per_mm) {
            return wanted_coverage(wanted, Window{w[0], w[1], w[2], w[3]}, px_per_mm);
        },
        py::arg("wanted"), py::arg("window_mm"), py::arg("px_per_mm"), py::call_guard<Unlocked>(),
        "What strokes should cover of every pixel, float32, row 0 at the top; window = (x, y, width, height) [mm].");
    m.def("touching", &touching, py::arg("wanted"), py::call_guard<Unlocked>(),
          "Numbers of strokes whose target marks touch, a list per letter; those that stand alone are not named.");
}
