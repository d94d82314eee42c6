#include "bindings.hpp"
#include "brushsvg/plan.hpp"

namespace {

/// Return the length [mm] on the paper of the move from a pose to the next one.
double move_length_mm(const brushsvg::Pass& pass, Eigen::Index pose) {
    const Eigen::Vector2d from = pass.poses_mm.row(pose).head<2>(), to = pass.poses_mm.row(pose + 1).head<2>();
    for (const brushsvg::Arc& arc : pass.arcs)
        if (arc.first <= pose && pose < arc.last)
            return std::abs(turn_between(arc, from, to)) * (from - arc.centre_mm).norm();
    return (to - from).norm();
}

}  // namespace

void bind_plan(py::module_& m) {
    using namespace brushsvg;
    py::class_<Arc> arc(m, "Arc",
                        R"(A stretch of a pass on a circle, at constant depth.

first, last: indices of the first and the last pose on the circle.
centre_mm: centre (x, y) of the circle.
direction: 1 counter-clockwise, -1 clockwise.

Neighbouring poses are less than 180 degrees apart on the circle.)");
    arc.def(py::init([](std::int64_t first, std::int64_t last, const Eigen::Vector2d& centre_mm, int direction) {
                return Arc{first, last, centre_mm, direction};
            }),
            py::arg("first"), py::arg("last"), py::arg("centre_mm"), py::arg("direction"))
        .def_readonly("first", &Arc::first)
        .def_readonly("last", &Arc::last)
        .def_property_readonly("centre_mm", [](const Arc& a) { return std::pair(a.centre_mm.x(), a.centre_mm.y()); })
        .def_readonly("direction", &Arc::direction)
        .def("__repr__", [](const Arc& a) {
            return "Arc(" + std::to_string(a.first) + ", " + std::to_string(a.last) + ", (" +
                   std::to_string(a.centre_mm.x()) + ", " + std::to_string(a.centre_mm.y()) + "), " +
                   std::to_string(a.direction) + ")";
        });
    add_fixed_value_semantics(arc);
    py::class_<Pass> one(m, "Pass", R"(The motion for one stroke.

stroke: name of the stroke that the pass paints, made from origin. Set it to a name or to a StrokeId.
origin: a StrokeId.
poses_mm: (n, 3): x, y, z = -depth [mm]. Moves between poses are straight, with linear depth. The array is read-only
    and not copied when you read it. Replace it as a whole.
arcs: a tuple of Arc, ascending. Poses of an arc are followed on the true circle, not on its chords.
speed_mm_s, layer, colour: of the pass.
settings: a Settings. Set it as a whole.
load: number of the load of paint within the stroke, from 1; 0 for a stroke that is not split.
extra: unknown keys of the file, as JSON.
tool_axes: (n, 3): for each pose the unit vector from the tip up along the brush, in the paper frame. The tilt is at
    most 30 degrees. Empty for an upright brush. Like poses_mm, read-only, and replaced as a whole.)");
    one.def(py::init([](StrokeId stroke, Poses poses_mm, double speed_mm_s, std::string layer, std::string colour,
                        Settings settings, std::string extra, std::vector<Arc> arcs, int load, Poses tool_axes) {
                return Pass{std::move(stroke), std::move(poses_mm), std::move(arcs),     speed_mm_s,
                            std::move(layer),  std::move(colour),   std::move(settings), load,
                            std::move(extra),  std::move(tool_axes)};
            }),
            py::arg("stroke") = "", py::arg("poses_mm") = Poses(0, 3), py::arg("speed_mm_s") = 20.0,
            py::arg("layer") = "", py::arg("colour") = "", py::arg("settings") = Settings{}, py::arg("extra") = "{}",
            py::arg("arcs") = std::vector<Arc>{}, py::arg("load") = 0, py::arg("tool_axes") = Poses(0, 3))
        .def_property(
            "stroke", [](const Pass& p) { return p.stroke.name(); },
            [](Pass& p, StrokeId stroke) { p.stroke = std::move(stroke); })
        .def_property_readonly("origin", [](const Pass& p) { return p.stroke; })
        .def_property(
            "poses_mm", [](const Pass& p) -> const Poses& { return p.poses_mm; }, replace(&Pass::poses_mm))
        .def_property(
            "tool_axes", [](const Pass& p) -> const Poses& { return p.tool_axes; }, replace(&Pass::tool_axes))
        .def_property("arcs", frozen_copy(&Pass::arcs),
                      [](Pass& p, std::vector<Arc> arcs) { p.arcs = std::move(arcs); })
        .def_readwrite("speed_mm_s", &Pass::speed_mm_s)
        .def_readwrite("layer", &Pass::layer)
        .def_readwrite("colour", &Pass::colour)
        .def_property(
            "settings", [](const Pass& p) { return p.settings; },
            [](Pass& p, Settings settings) { p.settings = std::move(settings); })
        .def_readwrite("load", &Pass::load)
        .def_readwrite("extra", &Pass::extra)
        .def("__repr__", [](const Pass& p) {
            const Eigen::Index n = p.poses_mm.rows();
            double length = 0.0, deepest = 0.0;
            for (Eigen::Index i = 0; i < n; ++i) {
                if (i > 0) length += move_length_mm(p, i - 1);
                deepest = std::max(deepest, -p.poses_mm(i, 2));
            }
            return "<Pass " + quoted(p.stroke.name()) + ": " + format_count(std::size_t(n), "pose") +
                   (p.arcs.empty() ? "" : ", " + format_count(p.arcs.size(), "arc")) +
                   (is_tilted(p) ? ", tilted" : "") + ", " + format_number(length) + " mm long, at most " +
                   format_number(deepest) + " mm deep, " + format_number(p.speed_mm_s) + " mm/s>";
        });
    add_value_semantics(one);
    py::class_<Plan> plan(m, "Plan",
                          R"(The TCP poses of all strokes, in the paper frame: plan.json as a value.

brush, brush_sha256: name and file hash of the brush for which the plan was made.
sheet_mm: (width, height).
passes: a tuple with one Pass per stroke, in painting order. Set it as a whole.
extra: unknown keys of the file, as JSON.)");
    plan.def(py::init([](std::string brush, std::string brush_sha256, std::array<double, 2> sheet_mm,
                         std::vector<Pass> passes, std::string extra) {
                 return Plan{std::move(brush), std::move(brush_sha256), sheet_mm, std::move(passes), std::move(extra)};
             }),
             py::arg("brush") = "", py::arg("brush_sha256") = "", py::arg("sheet_mm") = std::array<double, 2>{0.0, 0.0},
             py::arg("passes") = std::vector<Pass>{}, py::arg("extra") = "{}")
        .def_readwrite("brush", &Plan::brush)
        .def_readwrite("brush_sha256", &Plan::brush_sha256)
        .def_property("sheet_mm", frozen_copy(&Plan::sheet_mm),
                      [](Plan& p, std::array<double, 2> sheet_mm) { p.sheet_mm = sheet_mm; })
        .def_property("passes", parts(&Plan::passes), replace(&Plan::passes))
        .def_readwrite("extra", &Plan::extra)
        .def("__repr__", [](const Plan& p) {
            std::size_t poses = 0;
            for (const Pass& each : p.passes) poses += std::size_t(each.poses_mm.rows());
            return "<Plan for brush " + quoted(p.brush) + ": " + format_count(p.passes.size(), "pass") + ", " +
                   format_count(poses, "pose") + ", sheet " + format_number(p.sheet_mm[0]) + " x " +
                   format_number(p.sheet_mm[1]) + " mm>";
        });
    add_value_semantics(plan);
    m.def(
        "refuse_tilted",
        [](const std::vector<Pass>& passes, const std::string& upright) {
            for (const Pass& pass : passes) refuse_tilted(pass, upright);
        },
        py::arg("passes"), py::arg("upright"),
        R"(Raise Error for the first pass whose brush is not upright at all poses.

upright: the beginning of the error's sentence, which says what keeps the brush upright. An example is "cell ur5e holds
    the brush upright".)");
}
