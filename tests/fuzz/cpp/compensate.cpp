// A plan for any stroke: within the brush's depths, finite, the same each time, and its tracking error is that of the
// simulation.
#include "brushsvg/compensate.hpp"

#include "brushsvg/simulate.hpp"
#include "fuzzed_input.hpp"
#include "plan_json.hpp"

using namespace brushsvg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in(data, size);
    return fuzz::refusing([&] {
        CompensateOptions options;
        options.method = Compensation(in.chance(4) ? in.integer(0, 1) : 2);
        options.tolerance_mm = in.coarse(0.03, 0.5);
        options.start = Terminal(in.integer(0, 3));
        options.end = Terminal(in.integer(0, 3));
        options.few_poses = !in.chance(4);
        const bool twice = in.chance(4);
        const Brush brush = fuzz::brush_from(in);
        const Stroke stroke = fuzz::stroke_from(in, brush, 3);
        const CompensatedPass made = compensate(stroke, brush, options);
        const Poses& poses = made.pass.poses_mm;
        fuzz::require(poses.rows() > 0 && poses.allFinite(), "poses are finite");
        fuzz::require(poses.col(2).maxCoeff() <= 0.0, "no pose is above the paper", poses.col(2).maxCoeff());
        fuzz::require(-poses.col(2).minCoeff() <= brush.depth_range_mm[1] + 1e-9, "no pose is deeper than the brush");
        fuzz::require(std::isfinite(made.tracking_error.largest_mm) &&
                          made.tracking_error.mean_mm <= made.tracking_error.largest_mm + 1e-9,
                      "the tracking error is finite", made.tracking_error.mean_mm);
        Stroke drawn = stroke;
        drawn.settings = made.pass.settings;  // a point that the options chose is judged as a point
        const TrackingError seen = tracking_error_of(made.pass, drawn, brush, options.tolerance_mm);
        fuzz::require(std::abs(seen.largest_mm - made.tracking_error.largest_mm) <= 1e-9,
                      "the reported tracking error is that of the simulation",
                      seen.largest_mm - made.tracking_error.largest_mm);
        fuzz::require(made.tracking_error.within_tolerance == (made.tracking_error.largest_mm <= options.tolerance_mm),
                      "the verdict agrees with the number");
        Plan plan;
        plan.sheet_mm = {100.0, 100.0};
        plan.passes.push_back(made.pass);
        const Plan read = io::read_plan(io::write_plan(plan));
        fuzz::require(read.passes[0].poses_mm.rows() == poses.rows() &&
                          (read.passes[0].poses_mm - poses).cwiseAbs().maxCoeff() < 1e-6,
                      "a plan that is written reads back the same");
        if (!twice) return;
        const CompensatedPass again = compensate(stroke, brush, options);
        fuzz::require(again.pass.poses_mm == poses && again.tracking_error.largest_mm == made.tracking_error.largest_mm,
                      "the same stroke has the same plan");
    });
}
