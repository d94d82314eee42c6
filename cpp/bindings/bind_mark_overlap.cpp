#include "bindings.hpp"
#include "brushsvg/mark_overlap.hpp"

void bind_mark_overlap(py::module_& m) {
    using namespace brushsvg;
    py::class_<CommonArea> type(m, "CommonArea", R"(The areas that paint and target mark have in common and together.

common_mm2: area of the intersection [mm^2].
together_mm2: area of the union [mm^2].
overlap: common_mm2 / together_mm2; 1 if both are 0.)");
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
        R"(Return the CommonArea of passes of marks and the strokes they should paint.

The areas are counted in pixels.)");
    m.def("common_areas", &common_areas, py::arg("painted"), py::arg("wanted"), py::arg("groups"), py::arg("brush"),
          py::call_guard<Unlocked>(),
          R"(Return a CommonArea for each group of strokes and their passes.

groups: lists of indices, as touching() returns them.)");
    m.def(
        "wanted_coverage",
        [](const std::vector<Stroke>& wanted, const std::array<double, 4>& w, double px_per_mm) {
            return wanted_coverage(wanted, Window{w[0], w[1], w[2], w[3]}, px_per_mm);
        },
        py::arg("wanted"), py::arg("window_mm"), py::arg("px_per_mm"), py::call_guard<Unlocked>(),
        R"(Return the fraction of each pixel that the strokes should cover, as float32.

Row 0 is at the top.

window_mm: (x, y, width, height) [mm] of the part of the paper.)");
    m.def("touching", &touching, py::arg("wanted"), py::call_guard<Unlocked>(),
          R"(Group the strokes whose target marks touch: one list per letter.

Each list contains the indices of the strokes. A stroke that touches no other stroke is not listed.)");
}
