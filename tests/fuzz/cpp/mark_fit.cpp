// A brush from painted marks: finite laws, a width that never falls, a symmetric covariance, the same each time.
#include "mark_fit.hpp"

#include "brushsvg/coverage.hpp"
#include "brushsvg/simulate.hpp"
#include "fuzzed_input.hpp"

using namespace brushsvg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in(data, size);
    return fuzz::refusing([&] {
        fit::MarkOptions options;
        options.spacing_mm = in.coarse(2.0, 5.0);
        options.max_iterations = in.integer(0, 4);
        options.lag_terms = in.integer(1, 3);
        options.half_width_terms = in.integer(1, 3);
        options.departing = in.chance(4);
        options.round_tail = in.chance(2);
        if (in.chance(4)) options.lean_mm_per_mm = 0.1;
        if (in.chance(4)) options.axes = 0.01;
        if (in.chance(4)) options.backlash_mm = 0.1;
        if (in.chance(16)) options.deepest_mm = in.wild(0.01);
        const Brush brush = fuzz::brush_from(in);
        std::vector<fit::PaintedMark> marks;
        const int count = in.integer(1, 3);
        for (int i = 0; i < count; ++i) {
            const Pass pass = fuzz::pass_from(in, brush, 5);
            fit::PaintedMark mark{
                "s" + std::to_string(i), pass.poses_mm, outline(simulate(pass, brush, 0.2), brush), {}};
            const double noise = in.coarse(0.0, 0.5);
            for (Ring& ring : mark.outline_mm)
                for (Eigen::Index k = 0; k < ring.rows() && noise > 0.0 && !in.is_over(); ++k)
                    ring(k, k % 2) += in.coarse(-noise, noise);
            marks.push_back(mark);
        }
        const auto all = [](const fit::MarkFit& found) {
            std::vector<double> values = found.laws.lag;
            values.insert(values.end(), found.laws.tip_gap.begin(), found.laws.tip_gap.end());
            values.insert(values.end(), found.laws.half_width.begin(), found.laws.half_width.end());
            values.insert(values.end(), {found.laws.widest_per_half, found.laws.front_per_half, found.height_mm,
                                         found.turn_rad, found.shift_mm[0], found.shift_mm[1], found.noise_mm});
            return values;
        };
        const fit::MarkFit found = fit::fit_marks(marks, std::nullopt, options);
        fuzz::require(fuzz::are_finite(all(found)), "laws are finite");
        const std::size_t n = found.covariance.size();
        for (std::size_t i = 0; i < n; ++i) {
            fuzz::require(found.covariance[i].size() == n && fuzz::are_finite(found.covariance[i]),
                          "the covariance is finite and square");
            fuzz::require(found.covariance[i][i] >= 0.0, "a variance is not negative", found.covariance[i][i]);
        }
        const Profile half_width = fuzz::law(found.laws.half_width);
        double before = 0.0;
        for (int i = 1; i <= 50; ++i) {
            const double now = half_width(options.deepest_mm * i / 50);
            fuzz::require(now >= before - 1e-6, "the width never falls", now - before);
            before = now;
        }
        fuzz::require(all(fit::fit_marks(marks, std::nullopt, options)) == all(found),
                      "the same marks, the same brush");
    });
}
