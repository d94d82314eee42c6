// The medial axis of any filled shape: places inside of it, as far from its outline as they say.
#include "brushsvg/medial_axis.hpp"

#include "brushsvg/region.hpp"
#include "fuzzed_input.hpp"

using namespace brushsvg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in(data, size);
    return fuzz::refusing([&] {
        in.choose_grid();
        Rings drawn;
        const int rings = in.integer(1, 4);
        for (int i = 0; i < rings; ++i) {
            Ring ring(in.integer(3, 12), 2);
            for (Eigen::Index k = 0; k < ring.rows(); ++k) ring.row(k) << in.coordinate(), in.coordinate();
            drawn.push_back(ring);
        }
        const double share = in.coarse(0.0, 1.0), limb = in.coarse(0.0, 1.0);
        const bool keeps_limbs = in.chance(2);
        const Rings shape = fill(drawn, in.chance(2) ? FillRule::evenodd : FillRule::nonzero);
        if (shape.empty()) return;
        const MedialAxis axis = keeps_limbs ? medial_axis(shape, share, limb) : medial_axis(shape, share);
        for (const AxisNode& node : axis.nodes)
            fuzz::require(std::isfinite(node.x + node.y + node.radius_mm + node.corner) && node.radius_mm >= 0.0,
                          "nodes are finite");
        for (const AxisBranch& branch : axis.branches) {
            const int count = int(axis.nodes.size());
            fuzz::require(branch.from >= 0 && branch.from < count && branch.to >= 0 && branch.to < count,
                          "a branch ends at nodes");
            fuzz::require(branch.line.allFinite() && branch.line.rows() > 0, "a branch is finite");
            const Ring places = branch.line.leftCols<2>();
            const std::vector<double> clear = clearance(shape, places);
            for (Eigen::Index k = 0; k < places.rows(); ++k)  // kept to 1e-5 mm, cut where edges nearly touch
                fuzz::require(std::abs(clear[std::size_t(k)] - branch.line(k, 2)) <= 1e-3,
                              "a place of the axis is as far from the outline as it says",
                              clear[std::size_t(k)] - branch.line(k, 2));
            for (const Ring& part : branch.part) fuzz::require(part.allFinite(), "parts are finite");
        }
    });
}
