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
            run_in_parallel_chunks(plan.passes.size(), 64, progress, [&](std::size_t i) {
                marks.passes[i] = simulate(plan.passes[i], brush, tolerance_mm, for_outlines, may_rise);
            });
            return marks;
        },
        py::arg("plan"), py::arg("brush"), py::arg("tolerance_mm") = 0.02, py::arg("for_outlines") = true,
        py::arg("progress") = py::none(), py::kw_only(), py::arg("may_rise") = false,
        R"(Simulate the brush along a plan.

Returns Marks without outlines. To fill in the outlines, use trace_outlines; for a picture, use coverage.

z = -depth. If a pass begins or ends below 0, the brush is set down or lifted on the spot, in rows of its own. To find
the rows of the poses, use pose_rows of the PassMarks.

tolerance_mm: largest distance of the painted area between two rows from the hull of both. This tolerance is independent
    of the tolerance with which the plan was made.
for_outlines: False leaves out the rows that only the outline needs. The other rows are enough for widest_points.
progress: called with (passes done, passes).
may_rise: True if the passes are motions of a machine that may leave the paper (z > 0). There the brush hangs free.

Raises Error for z > 0 without may_rise, and for a pass entirely above the paper. Also raises Error for a pose deeper
than the brush may be pressed.)");
    m.def("narrow", &narrow, py::arg("marks"), py::arg("paint"), py::arg("dips_mm"), py::call_guard<ReleasedGil>(),
          R"(Fill in width_share of each pass, as the paint runs out along the passes.

Call this function before trace_outlines and coverage.

dips_mm: for each pass, the distances [mm] along the TCP's path at which paint was just fetched, ascending. [0]: just
    before the pass. []: the pass continues with the paint of the previous pass.)");
    m.def("widest_points", &widest_points, py::arg("pass_marks"), py::arg("brush"), py::call_guard<ReleasedGil>(),
          "Return the centre of the widest section at each row (n, 2) [mm].");
}
