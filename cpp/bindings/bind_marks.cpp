#include <pybind11/numpy.h>

#include "bindings.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/simulate.hpp"

namespace {

template <class T>
auto column(std::vector<T> brushsvg::PassMarks::* member) {
    return [member](const brushsvg::PassMarks& marks) {
        const auto& values = marks.*member;
        return as_typed<py::array_t<T>>(frozen(py::array_t<T>(py::ssize_t(values.size()), values.data())));
    };
}

}  // namespace

void bind_marks(py::module_& m) {
    using namespace brushsvg;
    py::class_<PassMarks> one(m, "PassMarks",
                              R"(What the patch does during one pass; parallel rows (mm, rad), read only.

pose: the index of the plan's pose, with fractions in between. contact_mm[pose_rows] is the contact at each pose. Rows after
the last pose's are the lift on the spot of a pass that ends on the paper (the patch moves as the bristles straighten), rows
before the first pose's the brush being set down.

lean_mm_per_mm (n, 2): how far the axis of a tilted brush goes sideways for each mm up; empty for one that is upright.)");
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
                                   return as_typed<py::array_t<bool>>(frozen(out));
                               })
        .def_property_readonly("pull", column(&PassMarks::pull))
        .def_property_readonly("lean_mm_per_mm", [](const PassMarks& p) -> const Ring& { return p.lean_mm_per_mm; })
        .def_property_readonly("width_share", column(&PassMarks::width_share),
                               "By how much narrower the brush paints than freshly dipped; empty: it does not.")
        .def_property_readonly(
            "pose_rows",
            [](const PassMarks& p) {
                const std::vector<std::size_t> rows = pose_rows(p);
                py::array_t<py::ssize_t> out(py::ssize_t(rows.size()));
                std::copy(rows.begin(), rows.end(), out.mutable_data());
                return as_typed<py::array_t<py::ssize_t>>(frozen(out));
            },
            "For each pose of the pass the index of its row.")
        .def_property("outline_mm", frozen_copy(&PassMarks::outline_mm),
                      [](PassMarks& p, Rings rings) { p.outline_mm = std::move(rings); })
        .def("__repr__", [](const PassMarks& p) {
            double deepest = 0.0;
            for (const double depth : p.depth_mm) deepest = std::max(deepest, depth);
            return "<PassMarks " + quoted(p.stroke) + ": " + counted(p.pose.size(), "row") + ", at most " +
                   in_digits(deepest) + " mm deep, " + counted(p.outline_mm.size(), "ring") + ">";
        });
    as_value(one);
    py::class_<Marks> marks(m, "Marks",
                            R"(What is painted: marks.json as a value.

passes: a tuple with a PassMarks per stroke; outline_mm: a tuple of rings [(n, 2) mm] of all paint together, filled by trace_outlines, outer
ones counter-clockwise, holes clockwise, unclosed.)");
    marks.def(py::init<>())
        .def_property("passes", parts(&Marks::passes), replace(&Marks::passes))
        .def_property("outline_mm", frozen_copy(&Marks::outline_mm),
                      [](Marks& marks, Rings rings) { marks.outline_mm = std::move(rings); })
        .def("__repr__", [](const Marks& m) {
            double area_mm2 = 0.0;
            for (const Ring& ring : m.outline_mm) area_mm2 += signed_area(ring);
            return "<Marks of " + counted(m.passes.size(), "pass") + ": " +
                   (m.outline_mm.empty()
                        ? "no outline>"
                        : counted(m.outline_mm.size(), "ring") + ", " + in_digits(area_mm2) + " mm^2 painted>");
        });
    as_value(marks);
}
