// A plan that is read and written reads back the same, and no pose of it is above the paper.
#include "plan_json.hpp"

#include "fuzzed_input.hpp"

using namespace brushsvg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return fuzz::refusing([&] {
        const Plan plan = io::read_plan(fuzz::text_of(data, size));
        for (const Pass& pass : plan.passes) {
            fuzz::require(pass.poses_mm.allFinite(), "poses are finite");
            if (pass.poses_mm.rows() > 0)
                fuzz::require(pass.poses_mm.col(2).maxCoeff() <= 0.0, "no pose is above the paper");
            for (std::size_t k = 0; k < pass.arcs.size(); ++k) check_arc(pass, k, "read");
        }
        const std::string once = io::write_plan(plan);
        const Plan again = io::read_plan(once);
        fuzz::require(again.passes.size() == plan.passes.size(), "as many passes are read back");
        for (std::size_t i = 0; i < plan.passes.size(); ++i) {
            const Pass &a = plan.passes[i], &b = again.passes[i];
            fuzz::require(a.stroke.name() == b.stroke.name() && a.colour == b.colour && a.layer == b.layer,
                          "names are read back");
            fuzz::require(a.poses_mm.rows() == b.poses_mm.rows() && a.arcs.size() == b.arcs.size(),
                          "as many poses are read back");
            if (a.poses_mm.rows() > 0) {
                const double off = (a.poses_mm - b.poses_mm).cwiseAbs().maxCoeff();
                fuzz::require(off <= 0.51e-7 + 1e-15 * a.poses_mm.cwiseAbs().maxCoeff(),
                              "poses are read back to 1e-7 mm", off);
            }
        }
        fuzz::require(io::write_plan(again) == once, "a plan that was written is written the same again");
    });
}
