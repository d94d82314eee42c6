// Refined plans: no worse than the closed form by the report's own measure, within the brush's depths.
#include "refine.hpp"

#include "brushsvg/mark_overlap.hpp"
#include "brushsvg/simulate.hpp"
#include "fuzzed_input.hpp"

using namespace brushsvg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in(data, size);
    return fuzz::refusing([&] {
        fit::RefineOptions options;
        options.iterations = in.integer(0, 3);
        options.tolerance_mm = in.coarse(0.05, 0.5);
        options.start = Terminal(in.integer(0, 1));
        if (in.chance(3)) options.sheet_mm = {100.0, 100.0};
        const Brush brush = fuzz::brush_from(in);
        Stroke stroke = fuzz::stroke_from(in, brush, 2);
        const fit::RefinedPass made = fit::refine(stroke, brush, options);
        const Poses& poses = made.plan.pass.poses_mm;
        fuzz::require(poses.rows() > 0 && poses.allFinite(), "poses are finite");
        fuzz::require(poses.col(2).maxCoeff() <= 0.0, "no pose is above the paper");
        fuzz::require(-poses.col(2).minCoeff() <= brush.depth_range_mm[1] + 1e-9, "no pose is deeper than the brush");
        fuzz::require(made.overlap >= 0.0 && made.overlap <= 1.0 + 1e-9 && made.overlap_closed >= 0.0 &&
                          made.overlap_closed <= 1.0 + 1e-9,
                      "an overlap is a share", made.overlap);
        fuzz::require(std::isfinite(made.plan.tracking_error.largest_mm), "the tracking error is finite");
        if (!made.is_improved) return;
        const TrackingError seen = tracking_error_of(made.plan.pass, stroke, brush, options.tolerance_mm);
        fuzz::require(std::abs(seen.largest_mm - made.plan.tracking_error.largest_mm) <= 1e-9,
                      "the reported tracking error is that of the simulation");
        CompensateOptions closed_form;
        closed_form.tolerance_mm = options.tolerance_mm;
        closed_form.start = options.start;
        const auto reported = [&](const Pass& pass) {
            return common_area({simulate(pass, brush)}, {stroke}, brush).overlap();
        };
        const double won = reported(made.plan.pass) - reported(compensate(stroke, brush, closed_form).pass);
        fuzz::require(won > -0.005, "a plan that is called better overlaps no less", won);
    });
}
