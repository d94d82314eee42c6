#include <optional>

#include "bindings.hpp"
#include "brushsvg/medial_axis.hpp"

void bind_medial_axis(py::module_& m) {
    using namespace brushsvg;
    py::class_<AxisBranch> type(m, "AxisBranch", R"(A stretch of the medial axis between two nodes.

start, end: indices of the nodes.
line: (k, 3), places on the axis: x, y, distance to the outline [mm].
part: rings of the part of the shape nearest to the branch.)");
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
        R"(Return the medial axis of a shape: its nodes and the branches between them.

nodes: (n, 4): x, y, distance to the outline [mm], and the largest corner dropped at the node, in squares of the
    distance.
branches: a list of AxisBranch, each with start and end (indices of nodes), line (k, 3) and part (rings).

rings: a shape as `fill` returns it.
least_share: the least area that a branch must add to the disc from which it starts, in squares of the disc's radius.
least_limb: a branch also stays if the part beyond some place on the branch adds least_share to the disc at this place.
    The part must also add least_limb to the disc from which the branch starts. None: equal to least_share.)");
}
