// Call brushsvg from your own application: brush and strokes in memory, progress, cancel, and errors as sentences.
// It needs brushsvg::core alone, and writes no file.
#include <brushsvg/brushsvg.hpp>
#include <cstdio>

using namespace brushsvg;

static CompensatedPass paint_wave(double half_width_mm, const Brush& brush) {
    WideLine points(3, 3);  // x, y and half width [mm]
    points << 20, 40, half_width_mm, 55, 60, half_width_mm, 90, 40, half_width_mm;
    return compensate(stroke_along("wave", points, 0.1), brush);
}

int main() {
    Brush brush;  // it trails 5 mm behind the tool, and paints 0.84 mm of width for each mm of depth
    brush.name = "mine";
    brush.depth_range_mm = {0.0, 10.0};
    brush.lag.coefficients = {5.0};
    brush.tip_gap.coefficients = {0.0, 0.5};
    brush.tip_to_widest.coefficients = {0.0, 0.8};
    brush.half_width.coefficients = {0.0, 0.42};
    Ring outline(4, 2);
    outline << 0, 0, 4, -2.1, 6, 0, 4, 2.1;  // at 5 mm: tip, right, front, left
    brush.footprints.dragged = {{5.0, outline}};
    check(brush);
    try {
        paint_wave(20.0, brush);  // wider than the brush
    } catch (const Error& refused) {
        std::printf("refused (%s): %s: %s\n", refused.code().c_str(), refused.where().c_str(), refused.what());
    }
    // brushsvg asks several times a second whether to give up. Here the 10th answer is yes; yours depends on a button.
    const CancelWhen cancel([asked = 0]() mutable { return ++asked >= 10; });
    long count = 0;
    try {
        for (; count < 10'000'000; ++count) {
            paint_wave(1.0 + 0.001 * double(count % 1000), brush);
            if (count % 100 == 99) std::printf("%ld strokes\n", count + 1);
        }
    } catch (const Cancelled&) {
        std::printf("cancelled after %ld strokes\n", count);
    }
}
