#include "bindings.hpp"
#include "brushsvg/plan.hpp"

void bind_plan(py::module_& m) {
    using namespace brushsvg;
    py::class_<Pass>(m, "Pass", "One stroke's motion: TCP poses (n, 3) x, y, z [mm], straight moves in between.")
        .def(py::init([](std::string stroke, const Poses& poses_mm, double speed_mm_s, std::string layer,
                         std::string colour, std::string settings, std::string extra) {
                 return Pass{std::move(stroke),   poses_mm,        speed_mm_s, std::move(layer), std::move(colour),
                             std::move(settings), std::move(extra)};
             }),
             py::arg("stroke") = "", py::arg("poses_mm") = Poses(0, 3), py::arg("speed_mm_s") = 20.0,
             py::arg("layer") = "", py::arg("colour") = "", py::arg("settings") = "{}", py::arg("extra") = "{}")
        .def_readwrite("stroke", &Pass::stroke)
        .def_property(
            "poses_mm", [](const Pass& p) { return p.poses_mm; },
            [](Pass& p, const Poses& poses) { p.poses_mm = poses; })
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
        .def_readwrite("passes", &Plan::passes)
        .def_readwrite("extra", &Plan::extra);
}
