// Paint a stroke that you draw by hand, with a brush from a file, as G-code: 01_first_word BRUSH.json PROGRAM.ngc
#include <brushsvg/brushsvg.hpp>
#include <brushsvg/io/brush_json.hpp>
#include <brushsvg/posts/linuxcnc.hpp>
#include <cstdio>
#include <fstream>
#include <sstream>

using namespace brushsvg;

int main(int count, char** words) try {
    if (count != 3) return std::fprintf(stderr, "01_first_word BRUSH.json PROGRAM.ngc\n"), 2;
    std::stringstream text;
    if (!(text << std::ifstream(words[1]).rdbuf()))
        return std::fprintf(stderr, "%s: the file is empty or cannot be read\n", words[1]), 1;
    const Brush brush = io::read_brush(text.str());
    check(brush);

    WideLine points(4, 3);  // x, y and half width [mm]; the origin is the sheet's lower left corner, y up
    points << 30, 30, 1.0, 50, 40, 1.8, 70, 30, 1.8, 90, 35, 1.0;
    const CompensatedPass done = compensate(stroke_along("wave", points, 0.1), brush);
    for (const Warning& each : done.warnings) std::fprintf(stderr, "%s\n", each.sentence.c_str());

    const Plan plan{brush.name, brush.sha256, {120.0, 60.0}, {done.pass}};
    std::ofstream program(words[2]);
    program << posts::linuxcnc(plan, brush, {}, "wave");
    if (!program.flush()) return std::fprintf(stderr, "%s: the file cannot be written\n", words[2]), 1;
    std::printf("%ld poses, at most %.3f mm off the line\n", long(done.pass.poses_mm.rows()),
                done.tracking_error.largest_mm);
    return 0;
} catch (const Error& refused) {  // where: a key of the brush file, or the stroke
    const std::string where = refused.where().empty() ? "" : refused.where() + ": ";
    return std::fprintf(stderr, "%s: %s%s\n", words[1], where.c_str(), refused.what()), 1;
}
