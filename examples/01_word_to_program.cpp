// A stroke becomes a compensated plan: where the tool must go, and how close the paint comes.
#include <brushsvg/brushsvg.hpp>
#include <cstdio>

using namespace brushsvg;

int main() {
    Brush brush;  // three numbers known of a brush: it trails 5 mm, and is 0.84 mm wide for every mm it is pressed
    brush.name = "by hand";
    brush.depth_range_mm = {0.0, 10.0};
    brush.lag.coefficients = {5.0};
    brush.tip_gap.coefficients = {0.0, 0.5};
    brush.tip_to_widest.coefficients = {0.0, 0.8};
    brush.half_width.coefficients = {0.0, 0.42};
    Ring outline(4, 2);  // at 5 mm: tip, right, front, left
    outline << 0, 0, 4, -2.1, 6, 0, 4, 2.1;
    brush.footprints.dragged = {{5.0, outline}};
    check(brush);

    Stroke stroke;
    stroke.id = "wave";
    stroke.middle_mm.resize(1, 8);
    stroke.middle_mm << 20, 40, 40, 75, 60, 5, 90, 40;
    stroke.half_width = {{0.0, 0.8}, {0.5, 1.8}, {1.0, 0.8}};

    const CompensatedPass done = compensate(stroke, brush);
    const Rings painted = brushsvg::outline(simulate(done.pass, brush), brush);
    std::printf("%ld poses, at most %.3f mm off the line, overlap with the drawing %.3f\n",
                long(done.pass.poses_mm.rows()), done.tracking_error.largest_mm,
                overlap(painted, wanted_outline(stroke)));
    return done.tracking_error.within_tolerance ? 0 : 1;
}
