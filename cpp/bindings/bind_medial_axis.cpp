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
                   format_count(std::size_t(b.line.rows()), "point") + ">";
        });
    add_fixed_value_semantics(type);
    m.def(
        "medial_axis",
        [](const Rings& rings, double min_share, std::optional<double> min_limb_share) {
            MedialAxis axis;
            {
                const ReleasedGil unlocked;
                axis = medial_axis(rings, min_share, min_limb_share.value_or(min_share));
            }
            Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> nodes(Eigen::Index(axis.nodes.size()), 4);
            for (std::size_t i = 0; i < axis.nodes.size(); ++i) {
                const AxisNode& n = axis.nodes[i];
                nodes.row(Eigen::Index(i)) << n.x, n.y, n.radius_mm, n.corner;
            }
            return std::make_pair(nodes, std::move(axis.branches));
        },
        py::arg("rings"), py::arg("min_share"), py::arg("min_limb_share") = py::none(),
        R"(Return the medial axis of a shape: its nodes and the branches between them.

nodes: (n, 4): x, y, distance to the outline [mm], and the largest corner dropped at the node, in squares of the
    distance.
branches: a list of AxisBranch, each with start and end (indices of nodes), line (k, 3) and part (rings).

rings: a shape as `fill` returns it.
min_share: the least area that a branch must add to the disc from which it starts, in squares of the disc's radius.
min_limb_share: a branch also stays if the part beyond some place on the branch adds min_share to the disc at this
    place. The part must also add min_limb_share to the disc from which the branch starts. None: equal to min_share.)");
}
