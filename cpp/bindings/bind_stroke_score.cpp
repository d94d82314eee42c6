#include "bindings.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/stroke_score.hpp"

void bind_stroke_score(py::module_& m) {
    using namespace brushsvg;
    py::class_<WorstPlace> place(m, "WorstPlace", "Where paint and drawing differ most, and by how much.");
    place.def_property_readonly("at_mm", frozen_copy(&WorstPlace::at_mm))
        .def_readonly("is_missing", &WorstPlace::is_missing)
        .def_readonly("area_mm2", &WorstPlace::area_mm2)
        .def("__repr__", [](const WorstPlace& w) {
            return "<WorstPlace at (" + in_digits(w.at_mm[0]) + ", " + in_digits(w.at_mm[1]) +
                   ") mm: " + in_digits(w.area_mm2) + " mm^2 too " + (w.is_missing ? "little>" : "much>");
        });
    as_fixed_value(place);
    py::class_<StrokeScore> type(m, "Verdict",
                                 R"(How well a pass paints its stroke.

overlap: common over joint area; width_error_mm: mean absolute difference of widths across the line, None where none can
be measured; excess_turning: of the mark's outline, in full turns; worst: a WorstPlace.)");
    type.def_readonly("overlap", &StrokeScore::overlap)
        .def_readonly("excess_turning", &StrokeScore::excess_turning)
        .def_readonly("width_error_mm", &StrokeScore::width_error_mm)
        .def_readonly("worst", &StrokeScore::worst)
        .def("__repr__", [](const StrokeScore& s) {
            const std::string width = s.width_error_mm ? in_digits(*s.width_error_mm) + " mm off in width" : "no width";
            return "<Verdict: overlap " + in_digits(s.overlap) + ", " + width + ">";
        });
    as_fixed_value(type);
    m.def(
        "verdicts",
        [](const std::vector<PassMarks>& painted, const std::vector<Stroke>& wanted, const Brush& brush) {
            if (painted.size() != wanted.size())
                throw Error("sizes-differ", "a stroke is needed for each pass of marks");
            std::vector<StrokeScore> found(painted.size());
            in_parallel_chunks(found.size(), 64, py::none(),
                               [&](std::size_t i) { found[i] = stroke_score(painted[i], wanted[i], brush); });
            return found;
        },
        py::arg("painted"), py::arg("wanted"), py::arg("brush"),
        "How well each pass of marks paints the stroke it should be: a Verdict each, on all processors.");
}
