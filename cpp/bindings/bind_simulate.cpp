#include "bindings.hpp"
#include "brushsvg/narrow.hpp"
#include "brushsvg/simulate.hpp"

void bind_simulate(py::module_& m) {
    using namespace brushsvg;
    m.def(
        "simulate",
        [](const Plan& plan, const Brush& brush, double tolerance_mm, bool for_outlines, const py::object& progress,
           bool may_rise) {
            Marks marks;
            marks.passes.resize(plan.passes.size());
            in_parallel_chunks(plan.passes.size(), 64, progress, [&](std::size_t i) {
                marks.passes[i] = simulate(plan.passes[i], brush, tolerance_mm, for_outlines, may_rise);
            });
            return marks;
        },
        py::arg("plan"), py::arg("brush"), py::arg("tolerance_mm") = 0.02, py::arg("for_outlines") = true,
        py::arg("progress") = py::none(), py::kw_only(), py::arg("may_rise") = false,
        R"(What the brush does along a plan: Marks without outlines (see trace_outlines and coverage).

tolerance_mm: how far the painted area between two rows may be off the hull of both; it has nothing to do with the
tolerance that a plan was made with. for_outlines: False leaves out the rows that only the outline needs: enough for
widest_points. progress: called with (passes done, passes).

z = -depth. A pass that begins or ends below 0 is set down or lifted on the spot, with rows of its own: pose_rows of the
PassMarks finds the poses. may_rise: the passes are motions of a machine that may leave the paper, z > 0; there the brush
hangs free. Error for z > 0 otherwise, for a pass all of which is above the paper, and for a pose deeper than the brush may
be pressed.)");
    m.def("narrow", &narrow, py::arg("marks"), py::arg("paint"), py::arg("dips_mm"), py::call_guard<Unlocked>(),
          R"(Fills width_share of every pass, as paint runs out along them: before trace_outlines and coverage.

dips_mm: for each pass the ways [mm] of the TCP along it at which paint was just fetched, ascending: [0] before it, [] goes
on with the paint of the pass before.)");
    m.def("widest_points", &widest_points, py::arg("pass_marks"), py::arg("brush"), py::call_guard<Unlocked>(),
          "Centre of the widest section at every row (n, 2) [mm].");
}
