#include "bindings.hpp"
#include "brushsvg/footprint.hpp"

void bind_footprint(py::module_& m) {
    using namespace brushsvg;
    py::class_<Footprint> one(m, "Footprint",
                              R"(The outline of the contact patch at one depth.

depth_mm: the depth [mm].
outline_mm: the outline (n, 2) [mm], a simple, unclosed, counter-clockwise ring. Its first point is the tip at (0, 0),
    and x points towards the TCP.)");
    one.def(py::init([](double depth_mm, const Ring& outline_mm) { return Footprint{depth_mm, outline_mm}; }),
            py::arg("depth_mm"), py::arg("outline_mm"))
        .def_readonly("depth_mm", &Footprint::depth_mm)
        .def_readonly("outline_mm", &Footprint::outline_mm)
        .def("__repr__", [](const Footprint& f) {
            std::string size;
            if (f.outline_mm.rows() > 0) {
                const Eigen::RowVector2d span = f.outline_mm.colwise().maxCoeff() - f.outline_mm.colwise().minCoeff();
                size = ", " + format_number(span.x()) + " mm long and " + format_number(span.y()) + " mm wide";
            }
            return "<Footprint at depth " + format_number(f.depth_mm) +
                   " mm: " + format_count(std::size_t(f.outline_mm.rows()), "point") + size + ">";
        });
    add_fixed_value_semantics(one);
    py::class_<FootprintTable> table(m, "FootprintTable",
                                     R"(The outlines of a brush at several depths, in tuples, with ascending depths.

dragged: outlines while the brush is drawn along.
pressed: outlines of a brush pressed straight down; () if they equal dragged.

All outlines have the same number of points. At other depths, the outlines are blended point by point.)");
    table
        .def(py::init([](std::vector<Footprint> dragged, std::vector<Footprint> pressed) {
                 return FootprintTable{std::move(dragged), std::move(pressed)};
             }),
             py::arg("dragged") = std::vector<Footprint>{}, py::arg("pressed") = std::vector<Footprint>{})
        .def_property_readonly("dragged", parts(&FootprintTable::dragged))
        .def_property_readonly("pressed", parts(&FootprintTable::pressed))
        .def("__repr__", [](const FootprintTable& t) {
            std::string depths;
            if (!t.dragged.empty())
                depths = " at depths " + format_number(t.dragged.front().depth_mm) + " to " +
                         format_number(t.dragged.back().depth_mm) + " mm";
            return "<FootprintTable: " + std::to_string(t.dragged.size()) + " dragged" + depths + ", " +
                   std::to_string(t.pressed.size()) + " pressed>";
        });
    add_fixed_value_semantics(table);
    m.def("footprint_at", &footprint_at, py::arg("table"), py::arg("depth_mm"), py::arg("pull") = 1.0,
          R"(Return the outline (n, 2) [mm] at a depth [mm], with the tip at the origin.

pull: r'/r, which blends the pressed (0) and the dragged outline (1).)");
}
