// What the brush does along any pass: finite, the same each time, never further from the tool than its lag.
#include "brushsvg/simulate.hpp"

#include "brushsvg/coverage.hpp"
#include "fuzzed_input.hpp"
#include "marks_json.hpp"

using namespace brushsvg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in(data, size);
    return fuzz::refusing([&] {
        const Brush brush = fuzz::brush_from(in);
        const Pass pass = fuzz::pass_from(in, brush, 10);
        const double tolerance = in.coarse(0.01, 0.5);
        const PassMarks marks = simulate(pass, brush, tolerance);
        const Eigen::Index rows = marks.contact_mm.rows();
        fuzz::require(marks.tcp_mm.rows() == rows && Eigen::Index(marks.pose.size()) == rows &&
                          Eigen::Index(marks.heading_rad.size()) == rows &&
                          Eigen::Index(marks.depth_mm.size()) == rows && Eigen::Index(marks.pull.size()) == rows,
                      "rows are parallel");
        fuzz::require(marks.contact_mm.allFinite() && marks.tcp_mm.allFinite() && fuzz::are_finite(marks.heading_rad) &&
                          fuzz::are_finite(marks.depth_mm) && fuzz::are_finite(marks.pull),
                      "rows are finite");
        fuzz::require(pose_rows(marks).size() == std::size_t(pass.poses_mm.rows()), "each pose has its row");
        const double deepest = -pass.poses_mm.col(2).minCoeff();
        const bool is_sound = fuzz::is_sound(brush) && !is_tilted(pass);
        for (Eigen::Index i = 0; i < rows; ++i) {
            const std::size_t k = std::size_t(i);
            if (k > 0) fuzz::require(marks.pose[k] >= marks.pose[k - 1] - 1e-9, "rows go on");
            fuzz::require(marks.depth_mm[k] <= deepest + 1e-9, "no row is deeper than the deepest pose");
            fuzz::require(marks.pull[k] >= 0.0 && marks.pull[k] <= 1.0 + 1e-9, "the pull is a share", marks.pull[k]);
            if (!is_sound || marks.depth_mm[k] < 0.0) continue;
            const double lag = std::max(0.0, brush.lag(marks.depth_mm[k]));
            const double away = (marks.tcp_mm.row(i) - marks.contact_mm.row(i)).norm();
            fuzz::require(away <= lag + 1e-6, "the patch is no further behind than the lag", away - lag);
            if (marks.taut[k]) fuzz::require(away >= lag - 1e-6, "a taut brush is drawn out to its lag", away - lag);
        }
        const PassMarks again = simulate(pass, brush, tolerance);
        fuzz::require(again.contact_mm == marks.contact_mm && again.heading_rad == marks.heading_rad,
                      "the same pass is simulated the same");
        if (is_sound && in.chance(4)) {
            for (const Ring& ring : outline(marks, brush)) fuzz::require(ring.allFinite(), "outlines are finite");
            Marks all;
            all.passes.push_back(marks);
            const std::string once = io::write_marks(all);
            fuzz::require(io::write_marks(io::read_marks(once)) == once, "marks are read back");
        }
    });
}
