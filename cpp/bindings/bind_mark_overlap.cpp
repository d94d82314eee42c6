#include "bindings.hpp"
#include "brushsvg/mark_overlap.hpp"

void bind_mark_overlap(py::module_& m) {
    using namespace brushsvg;
    py::class_<CommonArea> type(m, "CommonArea", R"(The areas that paint and target mark have in common and together.

intersection_mm2: area of the intersection [mm^2].
union_mm2: area of the union [mm^2].
overlap: intersection_mm2 / union_mm2; 1 if both are 0.)");
    type.def(
            py::init([](double intersection_mm2, double union_mm2) { return CommonArea{intersection_mm2, union_mm2}; }),
            py::arg("intersection_mm2"), py::arg("union_mm2"))
        .def_readonly("intersection_mm2", &CommonArea::intersection_mm2)
        .def_readonly("union_mm2", &CommonArea::union_mm2)
        .def_property_readonly("overlap", &CommonArea::overlap)
        .def("__repr__", [](const CommonArea& a) {
            return "<CommonArea: " + format_number(a.intersection_mm2) + " of " + format_number(a.union_mm2) + " mm^2>";
        });
    add_fixed_value_semantics(type);
    m.def(
        "common_area",
        [](const std::vector<PassMarks>& painted, const std::vector<Stroke>& target, const Brush& brush) {
            return common_area(painted, target, brush);
        },
        py::arg("painted"), py::arg("target"), py::arg("brush"), py::call_guard<ReleasedGil>(),
        R"(Return the CommonArea of passes of marks and the strokes they should paint.

The areas are counted in pixels.)");
    m.def("common_areas", &common_areas, py::arg("painted"), py::arg("target"), py::arg("groups"), py::arg("brush"),
          py::call_guard<ReleasedGil>(),
          R"(Return a CommonArea for each group of strokes and their passes.

groups: lists of indices, as group_touching() returns them.)");
    m.def(
        "target_coverage",
        [](const std::vector<Stroke>& target, const std::array<double, 4>& w, double px_per_mm) {
            return target_coverage(target, Window{w[0], w[1], w[2], w[3]}, px_per_mm);
        },
        py::arg("target"), py::arg("window_mm"), py::arg("px_per_mm"), py::call_guard<ReleasedGil>(),
        R"(Return the fraction of each pixel that the strokes should cover, as float32.

Row 0 is at the top.

window_mm: (x, y, width, height) [mm] of the part of the paper.)");
    m.def("group_touching", &group_touching, py::arg("target"), py::call_guard<ReleasedGil>(),
          R"(Group the strokes whose target marks touch: one list per letter.

Each list contains the indices of the strokes. A stroke that touches no other stroke is not listed.)");
}
