#include <pybind11/numpy.h>

#include "bindings.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/simulate.hpp"

namespace {

template <class T>
auto column(std::vector<T> brushsvg::PassMarks::* member) {
    return [member](const brushsvg::PassMarks& marks) {
        const auto& values = marks.*member;
        return as_typed<py::array_t<T>>(freeze(py::array_t<T>(py::ssize_t(values.size()), values.data())));
    };
}

}  // namespace

void bind_marks(py::module_& m) {
    using namespace brushsvg;
    py::class_<PassMarks> one(m, "PassMarks",
                              R"(The motion of the contact patch in one pass, as parallel rows [mm, rad].

The rows are read-only.

pose: index of the plan's pose, with fractions between two poses. contact_mm[pose_rows] is the contact at each pose.
lean_mm_per_mm: (n, 2), sideways distance of a tilted brush's axis for each mm up; empty for an upright brush.

A pass that ends on the paper has rows after the last pose, where the brush is lifted on the spot. There the patch
moves, because the bristles straighten. In the rows before the first pose, the brush is set down.)");
    one.def(py::init<>())
        .def_readwrite("stroke", &PassMarks::stroke)
        .def_property_readonly("pose", column(&PassMarks::pose))
        .def_property_readonly("tcp_mm", [](const PassMarks& p) -> const Ring& { return p.tcp_mm; })
        .def_property_readonly("contact_mm", [](const PassMarks& p) -> const Ring& { return p.contact_mm; })
        .def_property_readonly("heading_rad", column(&PassMarks::heading_rad))
        .def_property_readonly("depth_mm", column(&PassMarks::depth_mm))
        .def_property_readonly("taut",
                               [](const PassMarks& p) {
                                   py::array_t<bool> out(py::ssize_t(p.taut.size()));
                                   std::copy(p.taut.begin(), p.taut.end(), out.mutable_data());
                                   return as_typed<py::array_t<bool>>(freeze(out));
                               })
        .def_property_readonly("pull", column(&PassMarks::pull))
        .def_property_readonly("lean_mm_per_mm", [](const PassMarks& p) -> const Ring& { return p.lean_mm_per_mm; })
        .def_property_readonly("width_share", column(&PassMarks::width_share),
                               "Width as a share of a freshly dipped brush's width; empty: 1 in all rows.")
        .def_property_readonly(
            "pose_rows",
            [](const PassMarks& p) {
                const std::vector<std::size_t> rows = pose_rows(p);
                py::array_t<py::ssize_t> out(py::ssize_t(rows.size()));
                std::copy(rows.begin(), rows.end(), out.mutable_data());
                return as_typed<py::array_t<py::ssize_t>>(freeze(out));
            },
            "Index of the row of each pose.")
        .def_property("outline_mm", frozen_copy(&PassMarks::outline_mm),
                      [](PassMarks& p, Rings rings) { p.outline_mm = std::move(rings); })
        .def("__repr__", [](const PassMarks& p) {
            double deepest = 0.0;
            for (const double depth : p.depth_mm) deepest = std::max(deepest, depth);
            return "<PassMarks " + quoted(p.stroke) + ": " + format_count(p.pose.size(), "row") + ", at most " +
                   format_number(deepest) + " mm deep, " + format_count(p.outline_mm.size(), "ring") + ">";
        });
    add_value_semantics(one);
    py::class_<Marks> marks(m, "Marks",
                            R"(The marks that are painted: marks.json as a value.

passes: a tuple with one PassMarks per stroke.
outline_mm: a tuple of unclosed rings [(n, 2) mm] around all paint together, filled in by trace_outlines. Outer rings
    are counter-clockwise, holes are clockwise.)");
    marks.def(py::init<>())
        .def_property("passes", parts(&Marks::passes), replace(&Marks::passes))
        .def_property("outline_mm", frozen_copy(&Marks::outline_mm),
                      [](Marks& marks, Rings rings) { marks.outline_mm = std::move(rings); })
        .def("__repr__", [](const Marks& m) {
            double area_mm2 = 0.0;
            for (const Ring& ring : m.outline_mm) area_mm2 += signed_area(ring);
            return "<Marks of " + format_count(m.passes.size(), "pass") + ": " +
                   (m.outline_mm.empty() ? "no outline>"
                                         : format_count(m.outline_mm.size(), "ring") + ", " + format_number(area_mm2) +
                                               " mm^2 painted>");
        });
    add_value_semantics(marks);
}
