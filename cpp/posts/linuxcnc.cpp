#include "linuxcnc.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg::posts {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr double kUnitsPerMm = 1e4;        // units of the last decimal
constexpr double kMinMoveMm = 2.00125e-3;  // shortest move: rounding could turn a shorter one or remove it
// Smallest distance between the ends of a circle. Rounding could make closer ends equal.
constexpr double kMinCircleChordMm = 1e-3;
// Turn of one arc: rounding could make a longer arc empty or a full circle.
constexpr double kArcPartRad = 3.5, kMaxArcRad = 5.0;
constexpr double kMaxOnTheSpotMm = 1e-6;  // sideways: a move with less goes straight up or down
constexpr double kMinSpeedMmS = 1e-6;
constexpr std::size_t kMaxCommentLetters = 118;

template <class... Numbers>
std::string format_text(const char* format, Numbers... numbers) {
    char text[200];
    std::snprintf(text, sizeof text, format, numbers...);
    return text;
}

double rounded(double value) { return std::nearbyint(value * kUnitsPerMm) / kUnitsPerMm + 0.0; }  // -0.0 + 0.0 is 0.0

// The letters U+00C0 to U+017F without their accents.
constexpr char kUnaccented[] =
    "AAAAAA?CEEEEIIII?NOOOOO??UUUUY??aaaaaa?ceeeeiiii?nooooo??uuuuy?yAaAaAaCcCcCcCcDd??EeEeEeEeEeGgGgGgGgHh??IiIiIiIiI?"
    "??JjKk?LlLlLl????NnNnNn???OoOoOo??RrRrRrSsSsSsSsTtTt??UuUuUuUuUuUuWwYyYZzZzZzs";

/// Returns one line of comment in 7-bit characters, without brackets. Accents are removed as in Python, because
/// brushsvg check compares the comments.
std::string comment(const std::string& text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if ((byte & 0xC0) == 0x80) continue;  // a byte after the first one of a letter
        const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0u;
        const unsigned letter = (byte & 0xE0) == 0xC0 ? (byte & 0x1Fu) << 6 | (next & 0x3Fu) : byte;
        if (letter >= 0x300 && letter <= 0x36F) continue;  // a separate accent
        if (byte >= 0xC3 && byte <= 0xC5)
            out += kUnaccented[letter - 0xC0];
        else if (byte > '~' || (byte < ' ' && !std::isspace(byte)))
            out += '?';
        else
            out += byte < ' ' ? ' ' : byte == '(' ? '[' : byte == ')' ? ']' : text[i];
    }
    if (out.size() > kMaxCommentLetters) out.replace(kMaxCommentLetters - 3, std::string::npos, "...");
    return "(" + out + ")\n";
}

std::string format_duration(double seconds) {
    const long all = std::lrint(seconds), minutes = all / 60;
    if (minutes >= 60) return format_text("%ld h %02ld min", minutes / 60, minutes % 60);
    return minutes > 0 ? format_text("%ld min %02ld s", minutes, all % 60) : format_text("%ld s", all);
}

void require(double value, std::array<double, 2> range, const std::string& what, const std::string& unit,
             const std::string& where) {
    if (value >= range[0] && value <= range[1]) return;
    throw Error("out-of-range",
                what + " is " + format_text("%.4g ", value) + unit +
                    format_text(", outside the range [%.4g, %.4g] ", range[0], range[1]) + unit,
                where, value, range);
}

/// Throws Error where the path, including its circles, leaves the range of the machine.
void require_inside(const Pass& pass, const FlatCell& cell, const std::array<double, 2>& sheet_mm) {
    const std::string where = pass.stroke.name();
    const auto require_place_inside = [&](const Vector2d& place) {
        for (int axis = 0; axis < 2; ++axis)
            require(place[axis], {-cell.margin_mm, sheet_mm[std::size_t(axis)] + cell.margin_mm},
                    axis == 0 ? "x of the tool" : "y of the tool", "mm", where);
    };
    for (Index i = 0; i < pass.poses_mm.rows(); ++i) {
        if (!pass.poses_mm.row(i).allFinite())
            throw Error("not-finite", "a pose has a coordinate that is not finite", where);
        require(pass.poses_mm(i, 2), {cell.lowest_mm, 0.0}, "z of the tool while it paints", "mm", where);
        require_place_inside(pass.poses_mm.row(i).head<2>().transpose());
    }
    for (std::size_t k = 0; k < pass.arcs.size(); ++k) {
        check_arc(pass, k, where);
        const Arc& arc = pass.arcs[k];
        for (Index i = arc.first; i < arc.last; ++i) {
            const Vector2d from = pass.poses_mm.row(i).head<2>().transpose(),
                           to = pass.poses_mm.row(i + 1).head<2>().transpose();
            const double radius = (from - arc.centre_mm).norm(), turn = turn_between(arc, from, to);
            for (const Vector2d& way :
                 {Vector2d(radius, 0), Vector2d(0, radius), Vector2d(-radius, 0), Vector2d(0, -radius)}) {
                const double there = turn_between(arc, from, arc.centre_mm + way);
                if (turn > 0.0 ? there > 0.0 && there < turn : there < 0.0 && there > turn)
                    require_place_inside(arc.centre_mm + way);
            }
        }
    }
}

void require_valid_plan(const Plan& plan, const Brush& brush, const FlatCell& cell) {
    check_sheet(plan.sheet_mm);
    require(cell.clearance_mm, {0.01, 1e3}, "the clearance", "mm", "clearance_mm");
    require(cell.safe_mm, {std::max(0.5, cell.clearance_mm), 1e3}, "the safe height", "mm", "safe_mm");
    require(cell.lowest_mm, {-1e3, 0.0}, "the lowest height", "mm", "lowest_mm");
    require(cell.margin_mm, {0.0, 1e5}, "the margin", "mm", "margin_mm");
    require(cell.blending_mm, {0.0, 1e3}, "the blending", "mm", "blending_mm");
    for (const auto& [speed, name] : {std::pair(cell.approach_mm_s, "approach_mm_s"),
                                      {cell.press_mm_s, "press_mm_s"},
                                      {cell.paint_mm_s, "paint_mm_s"},
                                      {cell.travel_mm_s, "travel_mm_s"}})
        require(speed, {kMinSpeedMmS, 1e5}, "the speed", "mm/s", name);
    require(cell.acceleration_mm_s2, {kMinSpeedMmS, 1e6}, "the acceleration", "mm/s^2", "acceleration_mm_s2");
    if (cell.name.empty()) throw Error("name-invalid", "the machine has no name: use the name of its cell", "name");
    if (plan.brush != brush.name)
        throw Error("options-contradict", "the plan was made for brush " + plan.brush + ", not for " + brush.name +
                                              ": use that brush, or make a new plan");
    if (plan.passes.empty()) throw Error("nothing-to-paint", "the plan has no passes, so there is nothing to paint");
    for (const Pass& pass : plan.passes) {
        const std::string where = pass.stroke.name();
        if (pass.poses_mm.rows() == 0) throw Error("pass-empty", "the pass has no poses", where);
        refuse_tilted(pass, "a machine with three axes holds the brush upright");
        require_inside(pass, cell, plan.sheet_mm);
        const double deepest_mm = -pass.poses_mm.col(2).minCoeff();
        require(deepest_mm, {0.0, brush.depth_range_mm[1]}, "the depth", "mm", where);
        if (!(deepest_mm >= 1.0 / kUnitsPerMm))
            throw Error("never-pressed",
                        "the pass never presses the brush onto the paper, so nothing would be painted: lower its poses",
                        where);
        require(pass.speed_mm_s, {kMinSpeedMmS, std::min(cell.paint_mm_s, brush.max_speed_mm_s)}, "the painting speed",
                "mm/s", where);
    }
}

/// Returns the rows of the poses that are written. Poses too close to the one before are left out, except the ends of
/// circles.
std::vector<Index> select_poses(const Poses& written, const std::vector<bool>& must_stay) {
    std::vector<Index> out{0};
    const auto near = [&](Index i) { return (written.row(i) - written.row(out.back())).norm() < kMinMoveMm; };
    for (Index i = 1; i < written.rows(); ++i) {
        if (must_stay[std::size_t(i)])
            while (!must_stay[std::size_t(out.back())] && near(i)) out.pop_back();
        else if (near(i))
            continue;
        out.push_back(i);
    }
    return out;
}

class ProgramText {
 public:
    explicit ProgramText(double acceleration_mm_s2) : acceleration_mm_s2_(acceleration_mm_s2) {}
    std::string all;
    double time_s = 0.0, painted_mm = 0.0;

    void go(const char* word, const Eigen::RowVector3d& to) {
        all += word + coordinates(to) + "\n";
        way_mm_ += here_ ? (to - *here_).norm() : 0.0;
        here_ = to;
    }
    void feed(double mm_s) {  // in steps of 0.1 mm/min, rounded down to keep a limit
        const std::string line = format_text("F%.1f\n", std::max(std::floor(600.0 * mm_s + 1e-6), 1.0) / 10.0);
        if (line != feed_) all += line;
        feed_ = line;
    }
    void circle(int direction, const Eigen::RowVector3d& to, const Vector2d& centre_from_start, double length_mm) {
        all += (direction > 0 ? "G3" : "G2") + coordinates(to) +
               format_text(" I%.4f J%.4f\n", rounded(centre_from_start.x()), rounded(centre_from_start.y()));
        way_mm_ += length_mm;
        here_ = to;
    }
    /// Adds the time of the distance since the last rest, from rest to rest: the speed rises with the acceleration,
    /// stays constant, and falls.
    double rest(double mm_s) {
        const double a = acceleration_mm_s2_, way_mm = way_mm_;
        time_s += way_mm > mm_s * mm_s / a ? way_mm / mm_s + mm_s / a : 2.0 * std::sqrt(way_mm / a);
        way_mm_ = 0.0;
        return way_mm;
    }

 private:
    static std::string coordinates(const Eigen::RowVector3d& to) {
        return format_text(" X%.4f Y%.4f Z%.4f", rounded(to.x()), rounded(to.y()), rounded(to.z()));
    }
    double acceleration_mm_s2_, way_mm_ = 0.0;
    std::optional<Eigen::RowVector3d> here_;
    std::string feed_;
};

/// Returns the pass as it is run: a pass that begins or ends below the paper is set down and lifted there.
Pass set_on_paper(Pass pass) {
    const Poses& poses = pass.poses_mm;
    const Index n = poses.rows(), before = poses(0, 2) < 0.0 ? 1 : 0, after = poses(n - 1, 2) < 0.0 ? 1 : 0;
    Poses all(before + n + after, 3);
    all << poses.topRows(before), poses, poses.bottomRows(after);
    all(0, 2) = all(all.rows() - 1, 2) = 0.0;
    for (Arc& arc : pass.arcs) {
        arc.first += before;
        arc.last += before;
    }
    pass.poses_mm = all;
    return pass;
}

/// Splits an arc of a full turn or more into parts, because after rounding it might be no circle, or lose a turn.
std::vector<Arc> split_full_circle(const Arc& arc, const Poses& written) {
    std::vector<double> turned{0.0};
    for (Index i = arc.first; i < arc.last; ++i)
        turned.push_back(turned.back() + arc.direction * turn_between(arc, written.row(i).head<2>().transpose(),
                                                                      written.row(i + 1).head<2>().transpose()));
    const double all = turned.back();
    std::vector<Arc> parts;
    Arc part = arc;
    if (all >= 2.0 * std::acos(-1.0) ||
        (written.row(arc.last) - written.row(arc.first)).head<2>().norm() < kMinCircleChordMm) {
        const double share = all / std::max(2.0, std::ceil(all / kArcPartRad)) - 1e-6;
        std::size_t first = 0;
        for (std::size_t k = 1; k + 1 < turned.size(); ++k) {
            if (turned[k] - turned[first] < share && turned[k + 1] - turned[first] <= kMaxArcRad) continue;
            part.last = arc.first + std::int64_t(k);
            parts.push_back(part);
            part.first = part.last;
            first = k;
        }
    }
    part.last = arc.last;
    parts.push_back(part);
    return parts;
}

void write_pass(const Pass& planned, const Brush& brush, const FlatCell& cell, ProgramText& text) {
    const Pass pass = set_on_paper(planned);
    const Index last = pass.poses_mm.rows() - 1;
    const Poses written = pass.poses_mm.unaryExpr([](double value) { return rounded(value); });
    const auto apart = [&](Index a, Index b) { return (written.row(a) - written.row(b)).norm(); };
    std::vector<Arc> parts;
    for (const Arc& arc : pass.arcs)
        for (const Arc& part : split_full_circle(arc, written)) parts.push_back(part);
    std::vector<const Arc*> circle_at(std::size_t(last + 1), nullptr);  // circles by their first pose
    std::vector<bool> must_stay(std::size_t(last + 1), false);
    must_stay.front() = must_stay.back() = true;
    Index done = 0;
    for (const Arc& arc : parts) {
        const auto is_tiny = [&](Index a, Index b) { return a != b && apart(a, b) < kMinMoveMm; };
        if (apart(arc.first, arc.last) < kMinCircleChordMm || is_tiny(done, arc.first) || is_tiny(arc.last, last))
            continue;
        circle_at[std::size_t(arc.first)] = &arc;
        must_stay[std::size_t(arc.first)] = must_stay[std::size_t(arc.last)] = true;
        done = arc.last;
    }
    const double press_mm_s = std::min(cell.press_mm_s, pass.speed_mm_s);
    const double approach_mm_s = std::min(cell.approach_mm_s, brush.max_speed_mm_s);
    Eigen::RowVector3d over = pass.poses_mm.row(0);
    over.z() = cell.safe_mm;
    text.go("G0", over);
    text.rest(cell.travel_mm_s);
    text.feed(approach_mm_s);
    over.z() = cell.clearance_mm;
    text.go("G1", over);
    text.rest(approach_mm_s);
    text.feed(press_mm_s);
    text.go("G1", pass.poses_mm.row(0));
    text.rest(press_mm_s);
    double speed_mm_s = 0.0;  // speed of the lines without a rest in between; 0: no such lines
    const auto rest = [&] {
        if (speed_mm_s > 0.0) text.painted_mm += text.rest(speed_mm_s);
        speed_mm_s = 0.0;
    };
    Index here = 0;
    for (const Index i : select_poses(written, must_stay)) {
        checkpoint();
        if (i <= here) continue;
        if (const Arc* arc = circle_at[std::size_t(here)]) {
            if (i < arc->last) continue;
            rest();
            double turned = 0.0;
            for (Index k = here; k < i; ++k)
                turned += std::abs(turn_between(*arc, pass.poses_mm.row(k).head<2>().transpose(),
                                                pass.poses_mm.row(k + 1).head<2>().transpose()));
            const double radius_mm = (pass.poses_mm.row(here).head<2>().transpose() - arc->centre_mm).norm();
            text.feed(pass.speed_mm_s);
            text.circle(arc->direction, pass.poses_mm.row(i), arc->centre_mm - written.row(here).head<2>().transpose(),
                        radius_mm * turned);
            speed_mm_s = pass.speed_mm_s;
            rest();
        } else {
            const Eigen::RowVector3d step = (written.row(i) - written.row(here)).cwiseAbs();
            const bool is_on_the_spot = std::max(step.x(), step.y()) < kMaxOnTheSpotMm && step.z() > kMaxOnTheSpotMm;
            const double target_mm_s = is_on_the_spot ? press_mm_s : pass.speed_mm_s;
            if (target_mm_s != speed_mm_s) rest();
            text.feed(target_mm_s);
            text.go("G1", pass.poses_mm.row(i));
            speed_mm_s = target_mm_s;
        }
        here = i;
    }
    rest();
    over = pass.poses_mm.row(last);
    over.z() = cell.clearance_mm;
    text.feed(press_mm_s);
    text.go("G1", over);
    text.rest(press_mm_s);
    over.z() = cell.safe_mm;
    text.go("G0", over);
    text.rest(cell.travel_mm_s);
}

}  // namespace

std::string linuxcnc(const Plan& plan, const Brush& brush, const FlatCell& cell, const std::string& title) {
    require_valid_plan(plan, brush, cell);
    const std::string count = std::to_string(plan.passes.size());
    ProgramText text(cell.acceleration_mm_s2);
    for (std::size_t i = 0; i < plan.passes.size(); ++i) {
        text.all +=
            "\n" + comment("stroke " + std::to_string(i + 1) + " of " + count + ": " + plan.passes[i].stroke.name());
        write_pass(plan.passes[i], brush, cell, text);
    }
    const std::string path =
        rounded(cell.blending_mm) > 0.0 ? format_text("G64 P%.4f\n", rounded(cell.blending_mm)) : "G61\n";
    return comment("title: " + title) + comment("brush: " + brush.name + ", " + count + " strokes") +
           comment(format_text("sheet: %g x %g mm", plan.sheet_mm[0], plan.sheet_mm[1])) +
           comment("cell: " + cell.name + ", linuxcnc") +
           comment("frame: the sheet's lower left corner, mm; z 0 touches") +
           comment("time: about " + format_duration(text.time_s)) +
           comment(format_text("length: %.0f mm on the paper", text.painted_mm)) + "G21 G90 G94 G17 G40 G80 G91.1\n" +
           path + format_text("G0 Z%.4f\n", rounded(cell.safe_mm)) + text.all + "\nM2\n";
}

}  // namespace brushsvg::posts
