#include <string>
#include <string_view>

#include "bindings.hpp"
#include "brush_json.hpp"
#include "marks_json.hpp"
#include "plan_json.hpp"

void bind_io(py::module_& m) {
    const auto unlocked = py::call_guard<ReleasedGil>();
    m.def(
        "read_brush", [](std::string_view text) { return brushsvg::io::read_brush(std::string(text)); },
        py::arg("text"), unlocked, "Read a brush from the text of brush.json. Raises Error, naming the key.");
    m.def("write_brush", &brushsvg::io::write_brush, py::arg("brush"), unlocked, "Return the text of a brush.json.");
    m.def(
        "read_plan", [](std::string_view text) { return brushsvg::io::read_plan(std::string(text)); }, py::arg("text"),
        unlocked, "Read a plan from the text of plan.json. Raises Error, naming the key.");
    m.def("write_plan", &brushsvg::io::write_plan, py::arg("plan"), unlocked, "Return the text of a plan.json.");
    m.def(
        "read_marks", [](std::string_view text) { return brushsvg::io::read_marks(std::string(text)); },
        py::arg("text"), unlocked, "Read marks from the text of marks.json. Raises Error, naming the key.");
    m.def("write_marks", &brushsvg::io::write_marks, py::arg("marks"), unlocked, "Return the text of a marks.json.");
}
