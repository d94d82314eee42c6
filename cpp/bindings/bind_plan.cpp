#include "bindings.hpp"
#include "brushsvg/plan.hpp"

namespace {

/// Sets a member of which Python may hold views: they stay good until their owner goes, and show what was there before.
template <class T>
void replace(const py::object& owner, T& member, T value) {
    auto* before = new T(std::move(member));
    py::detail::keep_alive_impl(owner, py::capsule(before, [](void* p) { delete static_cast<T*>(p); }));
    member = std::move(value);
}

}  // namespace

void bind_plan(py::module_& m) {
    using namespace brushsvg;
    py::class_<Arc>(m, "Arc",
                    R"(Poses first to last lie on a circle about centre_mm (x, y), at constant depth.

direction: 1 counter-clockwise, -1 clockwise; neighbouring poses are less than 180 degrees apart on it.)")
        .def(py::init([](std::int64_t first, std::int64_t last, const Eigen::Vector2d& centre_mm, int direction) {
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
    py::class_<Pass>(m, "Pass", R"(One stroke's motion.

poses_mm: (n, 3) x, y, z [mm], straight moves in between, depth linear along each; read-only and not copied when read,
to be replaced as a whole. arcs: a tuple of Arc, ascending: these poses are followed on the true circle, whose chords
the straight moves are. speed_mm_s; layer, colour; settings, extra: JSON objects as text.)")
        .def(py::init([](std::string stroke, Poses poses_mm, double speed_mm_s, std::string layer, std::string colour,
                         std::string settings, std::string extra, std::vector<Arc> arcs) {
                 return Pass{std::move(stroke), std::move(poses_mm), std::move(arcs),     speed_mm_s,
                             std::move(layer),  std::move(colour),   std::move(settings), std::move(extra)};
             }),
             py::arg("stroke") = "", py::arg("poses_mm") = Poses(0, 3), py::arg("speed_mm_s") = 20.0,
             py::arg("layer") = "", py::arg("colour") = "", py::arg("settings") = "{}", py::arg("extra") = "{}",
             py::arg("arcs") = std::vector<Arc>{})
        .def_readwrite("stroke", &Pass::stroke)
        .def_property(
            "poses_mm", [](const Pass& p) -> const Poses& { return p.poses_mm; },
            [](const py::object& self, Poses poses) { replace(self, self.cast<Pass&>().poses_mm, std::move(poses)); })
        .def_property(
            "arcs", [](const Pass& p) { return py::tuple(py::cast(p.arcs)); },
            [](Pass& p, std::vector<Arc> arcs) { p.arcs = std::move(arcs); })
        .def_readwrite("speed_mm_s", &Pass::speed_mm_s)
        .def_readwrite("layer", &Pass::layer)
        .def_readwrite("colour", &Pass::colour)
        .def_readwrite("settings", &Pass::settings)
        .def_readwrite("extra", &Pass::extra);
    py::class_<Plan>(m, "Plan",
                     R"(TCP poses for every stroke, in the frame of the paper: plan.json as a value.

brush, brush_sha256: what it was made for; sheet_mm: (w, h); passes: one Pass per stroke, in painting order; extra:
unknown keys of the file, as JSON.)")
        .def(py::init([](std::string brush, std::string brush_sha256, std::array<double, 2> sheet_mm,
                         std::vector<Pass> passes, std::string extra) {
                 return Plan{std::move(brush), std::move(brush_sha256), sheet_mm, std::move(passes), std::move(extra)};
             }),
             py::arg("brush") = "", py::arg("brush_sha256") = "", py::arg("sheet_mm") = std::array<double, 2>{0.0, 0.0},
             py::arg("passes") = std::vector<Pass>{}, py::arg("extra") = "{}")
        .def_readwrite("brush", &Plan::brush)
        .def_readwrite("brush_sha256", &Plan::brush_sha256)
        .def_readwrite("sheet_mm", &Plan::sheet_mm)
        .def_property(
            "passes", [](const Plan& p) -> const std::vector<Pass>& { return p.passes; },
            [](const py::object& self, std::vector<Pass> passes) {
                replace(self, self.cast<Plan&>().passes, std::move(passes));
            })
        .def_readwrite("extra", &Plan::extra);
}
