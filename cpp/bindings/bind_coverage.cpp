#include "bindings.hpp"
#include "brushsvg/coverage.hpp"

void bind_coverage(py::module_& m) {
    using namespace brushsvg;
    const auto unlocked = py::call_guard<Unlocked>();
    m.def(
        "coverage",
        [](const Marks& marks, const Brush& brush, const std::array<double, 4>& w, double px_per_mm) {
            return coverage(marks, brush, Window{w[0], w[1], w[2], w[3]}, px_per_mm);
        },
        py::arg("marks"), py::arg("brush"), py::arg("window_mm"), py::arg("px_per_mm"), unlocked,
        "Painted fraction of every pixel, float32, row 0 at the top; window = (x, y, width, height) [mm].");
    m.def(
        "coverage",
        [](const Rings& rings, const std::array<double, 4>& w, double px_per_mm) {
            return coverage(rings, Window{w[0], w[1], w[2], w[3]}, px_per_mm);
        },
        py::arg("rings"), py::arg("window_mm"), py::arg("px_per_mm"), unlocked,
        "The same for filled rings, non-zero winding.");
    m.def(
        "trace_outlines",
        [](Marks& marks, const Brush& brush, const py::object& progress) {
            Rings all;
            in_chunks(marks.passes.size(), 4, progress, [&](std::size_t i) {
                marks.passes[i].outline_mm = outline(marks.passes[i], brush);
                all.insert(all.end(), marks.passes[i].outline_mm.begin(), marks.passes[i].outline_mm.end());
            });
            const Unlocked unlocked;
            marks.outline_mm = marks.passes.size() == 1 ? all : unite(all);
        },
        py::arg("marks"), py::arg("brush"), py::arg("progress") = py::none(),
        "Fills outline_mm of every pass and of the whole.");
    m.def("painted_bounds", &painted_bounds, py::arg("pass_marks"), py::arg("brush"), unlocked,
          "Left, bottom, right, top [mm] of everything one pass paints.");
}
