// Paint a sharp corner: as one stroke that turns there, and as the strokes that the search finds.
// Run: 02_corners BRUSH.json. It prints how the paint overlaps the shape.
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
    if (count != 2) return std::fprintf(stderr, "02_corners BRUSH.json\n"), 2;
    std::stringstream text;
    text << std::ifstream(words[1]).rdbuf();
    const Brush brush = io::read_brush(text.str());

    WideLine points(3, 3);  // x, y and half width [mm]; no tolerance: straight lines with a corner between them
    points << 20, 60, 2.0, 45, 15, 2.0, 70, 60, 2.0;
    const Stroke turned = stroke_along("V", points);
    Rings shape(1, Ring(6, 2));  // the letter, with the sharp corners that its designer drew
    shape[0] << 17.7, 60, 45, 10.9, 72.3, 60, 67.7, 60, 45, 19.1, 22.3, 60;

    const PaintedShape as_drawn{shape, {turned}, {compensate(turned, brush).pass}};
    const SearchedShape found = search_strokes({as_drawn}, brush).front();
    std::vector<Pass> passes;
    for (const Stroke& each : found.strokes[0]) passes.push_back(compensate(each, brush).pass);  // itself, or its parts
    for (const AddedStroke& each : found.added) passes.push_back(compensate(each.stroke, brush).pass);
    std::printf("1 stroke: overlap %.3f\n", overlap_of(as_drawn.passes, shape, brush));
    std::printf("%zu strokes: overlap %.3f\n", passes.size(), overlap_of(passes, shape, brush));
    return 0;
} catch (const Error& refused) {
    return std::fprintf(stderr, "%s: %s\n", refused.where().c_str(), refused.what()), 1;
}
