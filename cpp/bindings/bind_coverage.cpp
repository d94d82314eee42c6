#include "bindings.hpp"
#include "brushsvg/coverage.hpp"

void bind_coverage(py::module_& m) {
    using namespace brushsvg;
    const auto unlocked = py::call_guard<ReleasedGil>();
    m.def(
        "coverage",
        [](const Marks& marks, const Brush& brush, const std::array<double, 4>& w, double px_per_mm) {
            return coverage(marks, brush, Window{w[0], w[1], w[2], w[3]}, px_per_mm);
        },
        py::arg("marks"), py::arg("brush"), py::arg("window_mm"), py::arg("px_per_mm"), unlocked,
        R"(Return the painted fraction of each pixel, as float32 with row 0 at the top.

window_mm: (x, y, width, height) [mm] of the part of the paper.)");
    m.def(
        "coverage",
        [](const Rings& rings, const std::array<double, 4>& w, double px_per_mm) {
            return coverage(rings, Window{w[0], w[1], w[2], w[3]}, px_per_mm);
        },
        py::arg("rings"), py::arg("window_mm"), py::arg("px_per_mm"), unlocked,
        R"(Return the fraction of each pixel that filled rings cover, as float32.

The rings are filled by the non-zero winding rule. Row 0 is at the top.

window_mm: (x, y, width, height) [mm] of the part of the paper.)");
    m.def(
        "trace_outlines",
        [](Marks& marks, const Brush& brush, const py::object& progress) {
            Rings all;
            run_in_chunks(marks.passes.size(), 4, progress, [&](std::size_t i) {
                marks.passes[i].outline_mm = outline(marks.passes[i], brush);
                all.insert(all.end(), marks.passes[i].outline_mm.begin(), marks.passes[i].outline_mm.end());
            });
            const ReleasedGil unlocked;
            marks.outline_mm = marks.passes.size() == 1 ? all : unite(all);
        },
        py::arg("marks"), py::arg("brush"), py::arg("progress") = py::none(),
        "Fill in outline_mm of each pass, and outline_mm of all marks together.");
    m.def("painted_bounds", &painted_bounds, py::arg("pass_marks"), py::arg("brush"), unlocked,
          "Return left, bottom, right and top [mm] of all that one pass paints.");
}
