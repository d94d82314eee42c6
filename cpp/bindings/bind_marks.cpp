#include <pybind11/numpy.h>

#include "bindings.hpp"
#include "brushsvg/marks.hpp"

namespace {

template <class T>
auto column(std::vector<T> brushsvg::PassMarks::* member) {
    return [member](const brushsvg::PassMarks& marks) {
        const auto& values = marks.*member;
        return frozen(py::array_t<T>(py::ssize_t(values.size()), values.data()));
    };
}

}  // namespace

void bind_marks(py::module_& m) {
    using namespace brushsvg;
    py::class_<PassMarks>(m, "PassMarks", "What the patch does during one pass; parallel rows (mm, rad), read only.")
        .def(py::init<>())
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
                                   return frozen(out);
                               })
        .def_property_readonly("pull", column(&PassMarks::pull))
        .def_property("outline_mm", frozen_copy(&PassMarks::outline_mm),
                      [](PassMarks& p, Rings rings) { p.outline_mm = std::move(rings); });
    py::class_<Marks>(m, "Marks",
                      R"(What is painted: marks.json as a value.

passes: a tuple with a PassMarks per stroke; outline_mm: a tuple of rings [(n, 2) mm] of all paint together, filled by trace_outlines, outer
ones counter-clockwise, holes clockwise, unclosed.)")
        .def(py::init<>())
        .def_property("passes", parts(&Marks::passes), replace(&Marks::passes))
        .def_property("outline_mm", frozen_copy(&Marks::outline_mm),
                      [](Marks& marks, Rings rings) { marks.outline_mm = std::move(rings); });
}
