#include <optional>

#include "bindings.hpp"
#include "brushsvg/medial_axis.hpp"

void bind_medial_axis(py::module_& m) {
    using namespace brushsvg;
    py::class_<AxisBranch> type(m, "AxisBranch", "A stretch of the medial axis between two nodes.");
    type.def_readonly("start", &AxisBranch::from)
        .def_readonly("end", &AxisBranch::to)
        .def_property_readonly("line", frozen_copy(&AxisBranch::line))
        .def_property_readonly("part", frozen_copy(&AxisBranch::part))
        .def("__repr__", [](const AxisBranch& b) {
            return "<AxisBranch from node " + std::to_string(b.from) + " to " + std::to_string(b.to) + ": " +
                   counted(std::size_t(b.line.rows()), "point") + ">";
        });
    as_fixed_value(type);
    m.def(
        "medial_axis",
        [](const Rings& rings, double least_share, std::optional<double> least_limb) {
            MedialAxis axis;
            {
                const Unlocked unlocked;
                axis = medial_axis(rings, least_share, least_limb.value_or(least_share));
            }
            Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> nodes(Eigen::Index(axis.nodes.size()), 4);
            for (std::size_t i = 0; i < axis.nodes.size(); ++i) {
                const AxisNode& n = axis.nodes[i];
                nodes.row(Eigen::Index(i)) << n.x, n.y, n.radius_mm, n.corner;
            }
            return std::make_pair(nodes, std::move(axis.branches));
        },
        py::arg("rings"), py::arg("least_share"), py::arg("least_limb") = py::none(),
        R"(Medial axis of a shape: nodes (n, 4) with x, y, distance to the outline [mm] and the largest corner dropped there
[squares of that distance], and branches between them, each with start, end (node numbers), line (k, 3) and part (rings).

rings: as `fill` returns them. least_share: what a branch must add to the disc it leaves, in squares of the radius; it
stays, too, if what is beyond some place on it adds as much to the disc there, and least_limb to the disc it leaves.)");
}
