// Paint a shape that is wider than the brush: one stroke, and the strokes that the search adds to it.
// Run: 03_wide_shapes BRUSH.json. It prints how the paint overlaps the shape.
#include <brushsvg/brushsvg.hpp>
#include <brushsvg/io/brush_json.hpp>
#include <cstdio>
#include <fstream>
#include <sstream>

using namespace brushsvg;

static double overlap_of(const std::vector<Pass>& passes, const Rings& shape, const Brush& brush) {
    Rings painted;
    for (const Pass& each : passes)
        for (const Ring& ring : outline(simulate(each, brush), brush)) painted.push_back(ring);
    return overlap(unite(painted), shape);
}

int main(int count, char** words) try {
    if (count != 2) return std::fprintf(stderr, "03_wide_shapes BRUSH.json\n"), 2;
    std::stringstream text;
    text << std::ifstream(words[1]).rdbuf();
    const Brush brush = io::read_brush(text.str());
    const double widest_mm = brush.half_width_range_mm()[1];

    Rings bar(1, Ring(4, 2));  // 80 x 16 mm, counter-clockwise
    bar[0] << 20, 20, 100, 20, 100, 36, 20, 36;
    WideLine middle(2, 3);
    middle << 20 + widest_mm, 28, widest_mm, 100 - widest_mm, 28, widest_mm;
    PaintedShape shape{bar, {stroke_along("bar", middle)}, {}};
    shape.passes = {compensate(shape.strokes[0], brush).pass};

    std::printf("widest line of %s: %.1f mm, the bar: 16 mm\n", brush.name.c_str(), 2 * widest_mm);
    std::printf("1 stroke: overlap %.3f\n", overlap_of(shape.passes, bar, brush));
    const SearchedShape found = search_strokes({shape}, brush, {}, false).front();
    for (const AddedStroke& each : found.added) shape.passes.push_back(compensate(each.stroke, brush).pass);
    std::printf("%zu strokes: overlap %.3f\n", shape.passes.size(), overlap_of(shape.passes, bar, brush));
    return 0;
} catch (const Error& refused) {
    return std::fprintf(stderr, "%s: %s\n", refused.where().c_str(), refused.what()), 1;
}
