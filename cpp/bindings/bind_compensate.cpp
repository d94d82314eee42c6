#include "bindings.hpp"
#include "brushsvg/compensate.hpp"
#include "brushsvg/error.hpp"

namespace {

brushsvg::Compensation method_from(const std::string& name) {
    if (name == "none") return brushsvg::Compensation::none;
    if (name == "constant") return brushsvg::Compensation::constant;
    if (name == "closed") return brushsvg::Compensation::closed;
    throw brushsvg::Error("compensation is none, constant or closed, not \"" + name + "\"");
}

struct Compensated {
    brushsvg::Plan plan;
    std::vector<brushsvg::Miss> misses;
    std::vector<std::pair<std::string, std::string>> warnings;
};

}  // namespace

void bind_compensate(py::module_& m) {
    using namespace brushsvg;
    py::class_<Miss>(m, "Miss",
                     R"(Distance of the widest point from the middle line [mm], from the first taut row to the last.

largest_mm, where at_mm (x, y) it is; mean_mm over the length painted; within_tolerance; has_turn_in_place: at a corner
too sharp for the lever.)")
        .def_readonly("largest_mm", &Miss::largest_mm)
        .def_readonly("at_mm", &Miss::at_mm)
        .def_readonly("mean_mm", &Miss::mean_mm)
        .def_readonly("within_tolerance", &Miss::within_tolerance)
        .def_readonly("has_turn_in_place", &Miss::has_turn_in_place);
    py::class_<Compensated>(m, "Compensated", "A plan, what each pass still misses, and warnings [(stroke, sentence)].")
        .def_readonly("plan", &Compensated::plan)
        .def_readonly("misses", &Compensated::misses)
        .def_readonly("warnings", &Compensated::warnings);
    m.def(
        "compensate",
        [](const std::vector<Stroke>& strokes, const Brush& brush, const std::array<double, 2>& sheet_mm,
           const std::string& method, double tolerance_mm, std::optional<double> lag_mm, double speed_mm_s,
           const py::object& progress, bool few_poses) {
            const CompensateOptions options{method_from(method), tolerance_mm, lag_mm, speed_mm_s, few_poses};
            Compensated out;
            out.plan.brush = brush.name;
            out.plan.brush_sha256 = brush.sha256;
            out.plan.sheet_mm = sheet_mm;
            if (!brush.width_follows_depth())
                out.warnings.emplace_back("", "brush " + brush.name + " has one width: drawn widths are ignored");
            in_chunks(strokes.size(), 16, progress, [&](std::size_t i) {
                CompensatedPass one = compensate(strokes[i], brush, options);
                out.plan.passes.push_back(std::move(one.pass));
                out.misses.push_back(one.miss);
                for (auto& w : one.warnings) out.warnings.emplace_back(w.where, w.sentence);
            });
            return out;
        },
        py::arg("strokes"), py::arg("brush"), py::arg("sheet_mm"), py::arg("method") = "closed",
        py::arg("tolerance_mm") = 0.05, py::arg("lag_mm") = py::none(), py::arg("speed_mm_s") = 20.0,
        py::arg("progress") = py::none(), py::arg("few_poses") = true,
        R"(Where the TCP must go for the paint to land on the strokes' middle lines: a Compensated.

sheet_mm: (w, h), kept in the plan. method: "none", the TCP on the line; "constant", ahead by lag_mm (None: the lag at
each stroke's median depth); "closed", the inverse of the brush's law. tolerance_mm: how far the widest point of the
mark may be off the middle line once the brush is taut, between poses too; each pass is simulated and its miss
returned. speed_mm_s: of painting, at most the brush's. progress: called with (strokes done, strokes). few_poses: closed
only, no more poses than the tolerance asks for.

Error, naming the stroke, for widths or depths out of the brush's reach.)");
    m.def("miss_of", &miss_of, py::arg("pass_"), py::arg("stroke"), py::arg("brush"), py::arg("tolerance_mm") = 0.05,
          "Miss of one pass against the stroke it should paint, by simulating it.");
}
