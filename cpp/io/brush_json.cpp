#include "brush_json.hpp"

#include <limits>
#include <set>
#include <utility>

#include "json_document.hpp"
#include "json_fields.hpp"
#include "json_text.hpp"

namespace brushsvg::io {
namespace {

constexpr const char* kFormat = "brushsvg/brush";
constexpr double kMaxDegreesOfFreedom = 1e9;  // Student's t is normal long before this limit
const std::set<std::string> kBrushKeys{
    "format",        "version",    "name",       "kind",           "depth_range_mm", "lag",  "tip_gap",
    "tip_to_widest", "half_width", "covariance", "max_speed_mm_s", "paint_depth_mm", "paint"};
const std::set<std::string> kProfileKeys{"coefficients", "calibrated_mm", "source",
                                         "assumed",      "floor",         "half_interval_95",
                                         "rmse_mm",      "floor_slope",   "degrees_of_freedom"};

const std::set<std::string> kPaintKeys{"narrows_per_m", "lasts_mm",   "calibrated_mm",     "source",
                                       "assumed",       "covariance", "degrees_of_freedom"};

struct Law {
    const char* key;
    Profile Brush::* profile;
};
constexpr Law kLaws[] = {{"lag", &Brush::lag},
                         {"tip_gap", &Brush::tip_gap},
                         {"tip_to_widest", &Brush::tip_to_widest},
                         {"half_width", &Brush::half_width}};

Profile read_profile(Field field) {
    Fields fields(std::move(field));
    Profile profile;
    const Field coefficients = fields.take("coefficients");
    profile.coefficients = numbers(coefficients);
    if (profile.coefficients.empty()) coefficients.refuse("law-terms", "coefficients must contain at least one number");
    if (const auto floor = fields.find("floor")) profile.floor = number(*floor);
    if (const auto slope = fields.find("floor_slope")) {
        profile.floor_slope = number(*slope);
        if (!std::isfinite(profile.floor))
            slope->refuse("key-missing", "floor_slope has no effect without floor: add floor, or remove floor_slope");
    }
    if (const auto calibrated = fields.find("calibrated_mm")) profile.calibrated_mm = interval(*calibrated);
    if (const auto source = fields.find("source")) profile.source = text(*source);
    if (const auto assumed = fields.find("assumed")) profile.assumed = boolean_value(*assumed);
    if (const auto half = fields.find("half_interval_95")) {
        profile.half_interval_95 = numbers(*half);
        if (profile.half_interval_95.size() != profile.coefficients.size()) {
            half->refuse("sizes-differ",
                         "half_interval_95 must contain " + std::to_string(profile.coefficients.size()) +
                             " numbers, one per coefficient, not " + std::to_string(profile.half_interval_95.size()));
        }
    }
    if (const auto rmse = fields.find("rmse_mm")) profile.rmse_mm = number(*rmse);
    if (const auto freedom = fields.find("degrees_of_freedom")) {
        profile.degrees_of_freedom = number(*freedom);
        if (!(*profile.degrees_of_freedom >= 1.0 && *profile.degrees_of_freedom <= kMaxDegreesOfFreedom))
            throw Error("out-of-range",
                        "degrees_of_freedom must be within [1, 1e9], not " + describe(*profile.degrees_of_freedom),
                        freedom->path, *profile.degrees_of_freedom, std::array<double, 2>{1.0, kMaxDegreesOfFreedom});
    }
    profile.extra = fields.extra();
    return profile;
}

std::vector<std::vector<double>> read_covariance(Field field, std::size_t size) {
    std::vector<std::vector<double>> matrix;
    const std::string path = field.path;
    for (const Field& row : members(std::move(field))) {
        matrix.push_back(numbers(row));
        if (matrix.back().size() != size) {
            row.refuse("covariance-invalid", "a row of covariance must contain " + std::to_string(size) +
                                                 " numbers, one per coefficient, not " +
                                                 std::to_string(matrix.back().size()));
        }
    }
    if (matrix.size() != size) {
        throw Error("covariance-invalid",
                    "covariance must have " + std::to_string(size) + " rows, one per coefficient, not " +
                        std::to_string(matrix.size()),
                    path);
    }
    return matrix;
}

Paint read_paint(Field field) {
    Fields fields(std::move(field));
    Paint paint;
    paint.narrows_per_m = number(fields.take("narrows_per_m"));
    if (const auto lasts = fields.find("lasts_mm")) paint.lasts_mm = number(*lasts);
    if (const auto calibrated = fields.find("calibrated_mm")) paint.calibrated_mm = interval(*calibrated);
    if (const auto source = fields.find("source")) paint.source = text(*source);
    if (const auto assumed = fields.find("assumed")) paint.assumed = boolean_value(*assumed);
    if (auto covariance = fields.find("covariance"))
        for (const Field& row : members(std::move(*covariance))) paint.covariance.push_back(numbers(row));
    if (const auto freedom = fields.find("degrees_of_freedom")) paint.degrees_of_freedom = number(*freedom);
    paint.extra = fields.extra();
    return paint;
}

/// Reads the outlines of one kind. Unknown keys of each outline go to `notes` with its depth.
std::vector<Footprint> read_outlines(Field field, Eigen::Index& vertex_count, Json& notes) {
    std::vector<Footprint> outlines;
    for (Field& member : members(std::move(field))) {
        const std::string path = member.path;
        Fields fields(std::move(member));
        const Field depth = fields.take("depth_mm");
        const Field outline = fields.take("outline_mm");
        Footprint footprint{positive(depth), points(outline)};
        if (!outlines.empty() && footprint.depth_mm <= outlines.back().depth_mm) {
            throw Error("not-ascending",
                        "depth_mm is " + describe(footprint.depth_mm) + ", but must be greater than " +
                            describe(outlines.back().depth_mm) + ": sort the outlines by ascending depth",
                        depth.path, footprint.depth_mm);
        }
        if (footprint.outline_mm.rows() < 3)
            outline.refuse("footprint-invalid", "the outline has " + std::to_string(footprint.outline_mm.rows()) +
                                                    " points, but needs at least 3");
        if (vertex_count == 0) vertex_count = footprint.outline_mm.rows();
        if (footprint.outline_mm.rows() != vertex_count) {
            outline.refuse("footprint-invalid", "the outline has " + std::to_string(footprint.outline_mm.rows()) +
                                                    " points, but the first outline has " +
                                                    std::to_string(vertex_count) +
                                                    ": give all outlines the same number");
        }
        outlines.push_back(std::move(footprint));
        if (!fields.unknown_keys().empty()) {
            Json note{{"depth_mm", outlines.back().depth_mm}};
            note.update(fields.unknown_keys());
            notes.push_back(std::move(note));
        }
    }
    return outlines;
}

FootprintTable read_footprints(Field field, Json& notes) {
    Fields fields(std::move(field));
    FootprintTable table;
    Eigen::Index vertex_count = 0;
    Json dragged_notes = Json::array();
    Json pressed_notes = Json::array();
    table.dragged = read_outlines(fields.take("dragged"), vertex_count, dragged_notes);
    if (table.dragged.empty())
        throw Error("footprint-invalid", "dragged must contain at least one outline", "footprints.dragged");
    if (auto pressed = fields.find("pressed")) {
        table.pressed = read_outlines(std::move(*pressed), vertex_count, pressed_notes);
    }
    notes = fields.unknown_keys();
    if (!dragged_notes.empty()) notes["dragged"] = std::move(dragged_notes);
    if (!pressed_notes.empty()) notes["pressed"] = std::move(pressed_notes);
    return table;
}

void append_profile(std::string& out, const char* key, const Profile& profile) {
    const auto line = [&out](const char* name) { out += std::string(",\n    \"") + name + "\": "; };
    out += std::string(",\n  \"") + key + "\": {\n    \"coefficients\": ";
    append_numbers(out, profile.coefficients, 6, key);
    if (profile.floor != -std::numeric_limits<double>::infinity()) {
        line("floor");
        append_exact(out, profile.floor, key);
        if (profile.floor_slope != 0.0) {
            line("floor_slope");
            append_exact(out, profile.floor_slope, key);
        }
    }
    if (profile.calibrated_mm) {
        line("calibrated_mm");
        append_numbers(out, {(*profile.calibrated_mm)[0], (*profile.calibrated_mm)[1]}, 6, key);
    }
    if (!profile.source.empty()) {
        line("source");
        append_string(out, profile.source, key);
    }
    line("assumed");
    out += profile.assumed ? "true" : "false";
    if (!profile.half_interval_95.empty()) {
        line("half_interval_95");
        append_numbers(out, profile.half_interval_95, 6, key);
    }
    if (profile.rmse_mm) {
        line("rmse_mm");
        append_exact(out, *profile.rmse_mm, key);
    }
    if (profile.degrees_of_freedom) {
        line("degrees_of_freedom");
        append_exact(out, *profile.degrees_of_freedom, key);
    }
    append_extra(out, parse_object(profile.extra, std::string(key) + ".extra", kProfileKeys), 4);
    out += "\n  }";
}

void append_matrix(std::string& out, const std::vector<std::vector<double>>& matrix, const std::string& indent,
                   const char* key) {
    out += '[';
    for (std::size_t i = 0; i < matrix.size(); ++i) {
        out += (i == 0 ? "\n" : ",\n") + indent + "  ";
        append_numbers(out, matrix[i], 6, key);
    }
    out += "\n" + indent + "]";
}

void append_paint(std::string& out, const Paint& paint) {
    const auto line = [&out](const char* name) { out += std::string(",\n    \"") + name + "\": "; };
    out += ",\n  \"paint\": {\n    \"narrows_per_m\": ";
    append_exact(out, paint.narrows_per_m, "narrows_per_m");
    if (paint.lasts_mm) {
        line("lasts_mm");
        append_exact(out, *paint.lasts_mm, "lasts_mm");
    }
    if (paint.calibrated_mm) {
        line("calibrated_mm");
        append_numbers(out, {(*paint.calibrated_mm)[0], (*paint.calibrated_mm)[1]}, 6, "paint");
    }
    if (!paint.source.empty()) {
        line("source");
        append_string(out, paint.source, "paint");
    }
    line("assumed");
    out += paint.assumed ? "true" : "false";
    if (!paint.covariance.empty()) {
        line("covariance");
        append_matrix(out, paint.covariance, "    ", "paint");
    }
    if (paint.degrees_of_freedom) {
        line("degrees_of_freedom");
        append_exact(out, *paint.degrees_of_freedom, "degrees_of_freedom");
    }
    append_extra(out, parse_object(paint.extra, "paint.extra", kPaintKeys), 4);
    out += "\n  }";
}

void append_outlines(std::string& out, const char* key, const std::vector<Footprint>& outlines, const Json& notes) {
    out += std::string("    \"") + key + "\": [";
    for (std::size_t i = 0; i < outlines.size(); ++i) {
        out += i == 0 ? "\n      {\"depth_mm\": " : ",\n      {\"depth_mm\": ";
        append_exact(out, outlines[i].depth_mm, "depth_mm");
        for (const Json& note : notes) {
            if (!note.is_object() || note.value("depth_mm", Json()) != Json(outlines[i].depth_mm)) continue;
            for (const auto& [name, value] : note.items()) {
                if (name != "depth_mm") out += ", " + Json(name).dump() + ": " + value.dump();
            }
        }
        out += ", \"outline_mm\":\n        ";
        append_rows(out, outlines[i].outline_mm, 9, "outline_mm", append_exact);
        out += '}';
    }
    out += outlines.empty() ? "]" : "\n    ]";
}

void append_footprints(std::string& out, const FootprintTable& table, Json notes) {
    const auto take = [&notes](const char* key) {
        Json value = notes.value(key, Json::array());
        notes.erase(key);
        return value;
    };
    const Json dragged = take("dragged");
    const Json pressed = take("pressed");
    out += ",\n  \"footprints\": {\n";
    append_outlines(out, "dragged", table.dragged, dragged);
    out += ",\n";
    append_outlines(out, "pressed", table.pressed, pressed);
    append_extra(out, notes, 4);
    out += "\n  }";
}

}  // namespace

Brush read_brush(const std::string& text) {
    Fields fields = parse_document(text, kFormat);
    Brush brush;
    brush.name = io::text(fields.take("name"));
    if (const auto kind = fields.find("kind")) brush.kind = io::text(*kind);
    brush.depth_range_mm = interval(fields.take("depth_range_mm"));
    std::size_t coefficients = 0;
    for (const Law& law : kLaws) {
        brush.*law.profile = read_profile(fields.take(law.key));
        (brush.*law.profile).depth_range_mm = brush.depth_range_mm;
        coefficients += (brush.*law.profile).coefficients.size();
    }
    if (auto covariance = fields.find("covariance")) {
        brush.covariance = read_covariance(std::move(*covariance), coefficients);
    }
    if (auto paint = fields.find("paint")) brush.paint = read_paint(std::move(*paint));
    Json notes;
    brush.footprints = read_footprints(fields.take("footprints"), notes);
    if (const auto speed = fields.find("max_speed_mm_s")) brush.max_speed_mm_s = positive(*speed);
    if (const auto depth = fields.find("paint_depth_mm")) brush.paint_depth_mm = number(*depth);
    if (!notes.empty()) fields.unknown_keys()["footprints"] = std::move(notes);
    brush.extra = fields.extra();
    return brush;
}

std::string write_brush(const Brush& brush) {
    Json extra = parse_object(brush.extra, "extra", kBrushKeys);
    Json notes = extra.value("footprints", Json::object());
    if (!notes.is_object())
        throw Error("wrong-type", "footprints must be an object, not " + describe(notes), "extra.footprints");
    extra.erase("footprints");

    std::string out = std::string("{\n  \"format\": \"") + kFormat + "\",\n  \"version\": 1,\n  \"name\": ";
    append_string(out, brush.name, "name");
    if (!brush.kind.empty()) {
        out += ",\n  \"kind\": ";
        append_string(out, brush.kind, "kind");
    }
    out += ",\n  \"depth_range_mm\": ";
    append_numbers(out, {brush.depth_range_mm[0], brush.depth_range_mm[1]}, 4, "depth_range_mm");
    out += ",\n  \"max_speed_mm_s\": ";
    append_exact(out, brush.max_speed_mm_s, "max_speed_mm_s");
    out += ",\n  \"paint_depth_mm\": ";
    append_exact(out, brush.paint_depth_mm, "paint_depth_mm");
    append_extra(out, extra, 2);
    for (const Law& law : kLaws) append_profile(out, law.key, brush.*law.profile);
    if (!brush.covariance.empty()) {
        out += ",\n  \"covariance\": ";
        append_matrix(out, brush.covariance, "  ", "covariance");
    }
    if (brush.paint) append_paint(out, *brush.paint);
    append_footprints(out, brush.footprints, std::move(notes));
    out += "\n}\n";
    read_brush(out);  // throws where the text cannot be read back
    return out;
}

}  // namespace brushsvg::io
