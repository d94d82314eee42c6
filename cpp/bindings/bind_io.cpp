#include "bindings.hpp"
#include "brush_json.hpp"
#include "marks_json.hpp"
#include "plan_json.hpp"

void bind_io(py::module_& m) {
    const auto unlocked = py::call_guard<Unlocked>();
    m.def("read_brush", &brushsvg::io::read_brush, py::arg("text"), unlocked, "brush.json; Error names the key.");
    m.def("write_brush", &brushsvg::io::write_brush, py::arg("brush"), unlocked, "The text of a brush.json.");
    m.def("read_plan", &brushsvg::io::read_plan, py::arg("text"), unlocked, "plan.json; Error names the key.");
    m.def("write_plan", &brushsvg::io::write_plan, py::arg("plan"), unlocked, "The text of a plan.json.");
    m.def("read_marks", &brushsvg::io::read_marks, py::arg("text"), unlocked, "marks.json; Error names the key.");
    m.def("write_marks", &brushsvg::io::write_marks, py::arg("marks"), unlocked, "The text of a marks.json.");
}
