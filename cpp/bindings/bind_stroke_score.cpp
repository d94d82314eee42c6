#include "bindings.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/stroke_score.hpp"

void bind_stroke_score(py::module_& m) {
    using namespace brushsvg;
    py::class_<WorstPlace> place(m, "WorstPlace", R"(The place where paint and drawing differ most.

at_mm: the place (x, y).
is_missing: True if paint is missing there, False if there is too much paint.
area_mm2: area of the missing or excess paint.)");
    place.def_property_readonly("at_mm", frozen_copy(&WorstPlace::at_mm))
        .def_readonly("is_missing", &WorstPlace::is_missing)
        .def_readonly("area_mm2", &WorstPlace::area_mm2)
        .def("__repr__", [](const WorstPlace& w) {
            return "<WorstPlace at (" + format_number(w.at_mm[0]) + ", " + format_number(w.at_mm[1]) +
                   ") mm: " + format_number(w.area_mm2) + " mm^2 too " + (w.is_missing ? "little>" : "much>");
        });
    add_fixed_value_semantics(place);
    py::class_<StrokeScore> type(m, "StrokeScore",
                                 R"(A score of how well a pass paints its stroke.

overlap: area of the intersection over area of the union.
width_error_mm: mean absolute difference of the widths across the line; None if no width can be measured.
excess_turning: excess turning of the mark's outline, in full turns.
worst: a WorstPlace.)");
    type.def_readonly("overlap", &StrokeScore::overlap)
        .def_readonly("excess_turning", &StrokeScore::excess_turning)
        .def_readonly("width_error_mm", &StrokeScore::width_error_mm)
        .def_readonly("worst", &StrokeScore::worst)
        .def("__repr__", [](const StrokeScore& s) {
            const std::string width =
                s.width_error_mm ? format_number(*s.width_error_mm) + " mm off in width" : "no width";
            return "<StrokeScore: overlap " + format_number(s.overlap) + ", " + width + ">";
        });
    add_fixed_value_semantics(type);
    m.def(
        "score_strokes",
        [](const std::vector<PassMarks>& painted, const std::vector<Stroke>& target, const Brush& brush) {
            if (painted.size() != target.size())
                throw Error("sizes-differ", "there are " + std::to_string(target.size()) +
                                                " strokes for the marks of " + std::to_string(painted.size()) +
                                                " passes: give one stroke for each pass");
            std::vector<StrokeScore> found(painted.size());
            run_in_parallel_chunks(found.size(), 64, py::none(),
                                   [&](std::size_t i) { found[i] = stroke_score(painted[i], target[i], brush); });
            return found;
        },
        py::arg("painted"), py::arg("target"), py::arg("brush"),
        R"(Score how well each pass of marks paints its stroke.

Returns a StrokeScore for each pass, computed on all processors.)");
}
