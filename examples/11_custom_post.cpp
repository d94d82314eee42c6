// Write a plan in a robot language of your own, one command per line: 11_custom_post BRUSH.json > PROGRAM.txt
#include <brushsvg/brushsvg.hpp>
#include <brushsvg/io/brush_json.hpp>
#include <brushsvg/posts/linuxcnc.hpp>
#include <cstdio>
#include <fstream>
#include <sstream>

using namespace brushsvg;

static std::string line(const char* word, double x_mm, double y_mm, double z_mm) {
    char text[99];
    std::snprintf(text, sizeof text, "%s %.3f %.3f %.3f\n", word, x_mm, y_mm, z_mm);
    return text;
}

static std::string my_language(const Plan& plan, const posts::FlatCell& cell) {
    std::string text;
    for (const Pass& pass : plan.passes) {  // passes without arcs: straight lines from pose to pose
        const auto first = pass.poses_mm.row(0), last = pass.poses_mm.row(pass.poses_mm.rows() - 1);
        text += "# " + pass.stroke.name() + "\n" + line("TRAVEL", first(0), first(1), cell.safe_mm);
        for (const auto& pose : pass.poses_mm.rowwise()) text += line("PAINT", pose(0), pose(1), pose(2));
        text += line("TRAVEL", last(0), last(1), cell.safe_mm);
    }
    return text;
}

int main(int count, char** words) try {
    if (count != 2) return std::fprintf(stderr, "11_custom_post BRUSH.json\n"), 2;
    std::stringstream text;
    text << std::ifstream(words[1]).rdbuf();
    const Brush brush = io::read_brush(text.str());
    WideLine points(3, 3);  // x, y and half width [mm]
    points << 20, 60, 1.5, 45, 15, 2.0, 70, 60, 1.5;
    const Plan plan{brush.name, brush.sha256, {90.0, 80.0}, {compensate(stroke_along("V", points), brush).pass}};
    posts::linuxcnc(plan, brush);  // throws Error if a pose, a height or a speed is outside the limits of the cell
    std::fputs(my_language(plan, {}).c_str(), stdout);
    return 0;
} catch (const Error& refused) {
    return std::fprintf(stderr, "%s: %s\n", refused.where().c_str(), refused.what()), 1;
}
