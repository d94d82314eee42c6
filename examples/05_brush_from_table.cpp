// Fit a brush to a table that you measure with a ruler, and write it: 05_brush_from_table BRUSH.json
#include <brushsvg/brushsvg.hpp>
#include <brushsvg/fit/law_fit.hpp>
#include <brushsvg/io/brush_json.hpp>
#include <cstdio>
#include <fstream>

using namespace brushsvg;

int main(int count, char** words) try {
    if (count != 2) return std::fprintf(stderr, "05_brush_from_table BRUSH.json\n"), 2;
    const std::vector<double> depth_mm{1, 2, 3, 4, 5, 6, 7, 8};
    const std::vector<double> lag_mm{4.3, 5.5, 7.4, 8.9, 10.1, 11.5, 12.1, 12.9};  // how far the paint trails
    const std::vector<double> half_width_mm{0.45, 0.8, 1.3, 1.65, 2.1, 2.55, 2.9, 3.4};

    Brush brush;
    brush.name = "mine";
    brush.depth_range_mm = {0.0, 8.0};
    const fit::LawShape any_line, through_zero{brush.depth_range_mm, 1, true};  // straight lines
    brush.lag = fit::fit_law(depth_mm, lag_mm, any_line).law;
    brush.half_width = fit::fit_law(depth_mm, half_width_mm, through_zero).law;
    const double slope = brush.half_width.coefficients.at(1);  // half width [mm] for each mm of depth
    brush.tip_gap.coefficients = {0.0, 1.2 * slope};           // not measured: 1.2 and 1.8 half widths behind the tip
    brush.tip_to_widest.coefficients = {0.0, 1.8 * slope};
    brush.tip_gap.assumed = brush.tip_to_widest.assumed = true;
    Ring outline(4, 2);  // at 8 mm: tip, right, front, left
    outline << 0, 0, 14.4 * slope, -8 * slope, 20 * slope, 0, 14.4 * slope, 8 * slope;
    brush.footprints.dragged = {{8.0, outline}};
    check(brush);

    std::ofstream file(words[1]);
    file << io::write_brush(brush);
    if (!file.flush()) return std::fprintf(stderr, "%s: the file cannot be written\n", words[1]), 1;
    for (const double depth : {2.0, 4.0, 6.0})
        std::printf("depth %.0f mm: lag %.2f mm, width %.2f mm\n", depth, brush.lag(depth),
                    2 * brush.half_width(depth));
    return 0;
} catch (const Error& refused) {
    return std::fprintf(stderr, "%s: %s\n", refused.where().c_str(), refused.what()), 1;
}
