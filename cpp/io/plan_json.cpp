#include "plan_json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "json_document.hpp"
#include "json_fields.hpp"
#include "json_text.hpp"

namespace brushsvg::io {
namespace {

constexpr const char* kFormat = "brushsvg/plan";
constexpr int kTiltVersion = 2;  // the version with the tilt of the brush; other plans are written without it
const std::set<std::string> kPlanKeys{"format", "version", "brush", "brush_sha256", "sheet_mm", "passes"};
const std::set<std::string> kPassKeys{"stroke", "poses_mm", "arcs", "speed_mm_s", "layer",
                                      "colour", "settings", "load", "tool_axes"};

/// Throws Error for a pass that cannot be read or written. `path`: key path of the pass; `slack_mm`: height above the
/// paper that still counts as on the paper.
void require_valid_pass(const Pass& pass, const std::string& path, double slack_mm) {
    const auto where = [&](Eigen::Index i) { return path + ".poses_mm[" + std::to_string(i) + "]"; };
    if (pass.poses_mm.rows() == 0)
        throw Error("pass-empty", "stroke " + pass.stroke.name() + " has no poses", path + ".poses_mm");
    for (Eigen::Index i = 0; i < pass.poses_mm.rows(); ++i) {
        const auto sentence = [&](const std::string& fault) {
            return "pose " + std::to_string(i) + " of stroke " + pass.stroke.name() + " " + fault;
        };
        if (!pass.poses_mm.row(i).allFinite()) throw Error("not-finite", sentence("is not finite"), where(i));
        const double largest_mm = pass.poses_mm.row(i).cwiseAbs().maxCoeff();
        if (largest_mm > kMaxCoordinateMm) {
            throw Error(
                "geometry-out-of-range",
                sentence("has a coordinate of " + describe(largest_mm) + " mm, outside the range [-1e6, 1e6] mm"),
                where(i), largest_mm, std::array<double, 2>{-kMaxCoordinateMm, kMaxCoordinateMm});
        }
        const double z_mm = pass.poses_mm(i, 2);
        if (z_mm > slack_mm) {
            throw Error("above-paper",
                        sentence("has z = " + describe(z_mm) + " mm, but inside a pass z must be 0 or below"), where(i),
                        z_mm, std::array<double, 2>{-std::numeric_limits<double>::infinity(), 0.0});
        }
    }
    if (!(pass.speed_mm_s > 0.0 && pass.speed_mm_s <= kMaxCoordinateMm)) {
        throw Error("out-of-range",
                    "speed_mm_s of stroke " + pass.stroke.name() + " must be " +
                        (pass.speed_mm_s > kMaxCoordinateMm ? "at most 1e6" : "greater than 0") + ", not " +
                        describe(pass.speed_mm_s),
                    path + ".speed_mm_s", pass.speed_mm_s);
    }
    if (pass.load < 0) {
        throw Error("out-of-range",
                    "load of stroke " + pass.stroke.name() + " must be at least 0, not " + std::to_string(pass.load),
                    path + ".load", pass.load);
    }
    for (std::size_t k = 0; k < pass.arcs.size(); ++k) check_arc(pass, k, path + ".arcs[" + std::to_string(k) + "]");
    check_tool_axes(pass, path + ".tool_axes");
}

/// Reads an arc [first pose, last pose, x and y of the centre, 1 or -1].
Arc read_arc(const Field& field) {
    const std::vector<double> row = numbers(field);
    if (row.size() != 5) {
        field.refuse("wrong-type",
                     "an arc must be five numbers [first pose, last pose, centre x, centre y, 1 or -1], not " +
                         std::to_string(row.size()));
    }
    for (const int k : {0, 1, 4}) {
        if (row[k] == std::floor(row[k]) && std::abs(row[k]) <= 1e9) continue;
        throw Error("wrong-type",
                    "pose numbers and the direction of an arc must be whole numbers, not " + describe(row[k]),
                    field.path + "[" + std::to_string(k) + "]", row[k]);
    }
    return {static_cast<std::int64_t>(row[0]),
            static_cast<std::int64_t>(row[1]),
            {row[2], row[3]},
            static_cast<int>(row[4])};
}

void read_into(std::optional<std::string>& value, const Field& field) { value = text(field); }
void read_into(std::optional<int>& value, const Field& field) { value = whole(field); }
void read_into(std::optional<bool>& value, const Field& field) { value = boolean_value(field); }
void read_into(std::optional<double>& value, const Field& field) { value = number(field); }

Settings read_settings(Field field) {
    Fields fields(std::move(field));
    Settings settings;
    each_setting(settings, [&](const char* key, auto& value) {
        if (const auto found = fields.find(key)) read_into(value, *found);
    });
    settings.extra = fields.extra();
    return settings;
}

/// Appends the settings, with unknown keys after the known ones.
void append_settings(std::string& out, const Settings& settings, const std::string& path) {
    Json json = Json::object();
    std::set<std::string> own_keys;
    each_setting(settings, [&](const char* key, const auto& value) {
        own_keys.insert(key);
        if (value) json[key] = *value;
    });
    for (const auto& [key, value] : json.items())
        if (value.is_number()) refuse_not_finite(value.get<double>(), path + "." + key);
    json.update(parse_object(settings.extra, path + ".extra", own_keys));
    append_json(out, json, path);
}

Pass read_pass(Field field, std::size_t index, const std::vector<PassRows>& tables, int version) {
    const std::string path = field.path;
    Fields fields(std::move(field));
    Pass pass;
    pass.stroke = text(fields.take("stroke"));
    pass.poses_mm = tables[0].rows_of_pass<Poses>(index, fields.take("poses_mm"), "three numbers [x, y, z]");
    if (auto axes = fields.find("tool_axes")) {
        if (version < kTiltVersion)
            axes->refuse("version-unknown", "tool_axes of stroke " + pass.stroke.name() + " needs version 2 of " +
                                                kFormat + ", but the file has version 1");
        pass.tool_axes = tables[1].rows_of_pass<Poses>(index, *axes, "three numbers [x, y, z]");
    }
    if (auto arcs = fields.find("arcs"))
        for (const Field& arc : members(std::move(*arcs))) pass.arcs.push_back(read_arc(arc));
    if (const auto speed = fields.find("speed_mm_s")) pass.speed_mm_s = number(*speed);
    if (const auto layer = fields.find("layer")) pass.layer = text(*layer);
    if (const auto colour = fields.find("colour")) pass.colour = text(*colour);
    if (auto settings = fields.find("settings")) pass.settings = read_settings(std::move(*settings));
    if (const auto load = fields.find("load")) pass.load = whole(*load);
    pass.extra = fields.extra();
    require_valid_pass(pass, path, 0.0);
    return pass;
}

void append_pass(std::string& out, const Pass& pass, const std::string& path) {
    require_valid_pass(pass, path, 0.5e-7);  // heights that are written as 0
    out += "    {\"stroke\": ";
    append_string(out, pass.stroke.name(), path + ".stroke");
    out += ", \"speed_mm_s\": ";
    append_exact(out, pass.speed_mm_s, "speed_mm_s");
    out += ", \"layer\": ";
    append_string(out, pass.layer, path + ".layer");
    out += ", \"colour\": ";
    append_string(out, pass.colour, path + ".colour");
    out += ", \"settings\": ";
    append_settings(out, pass.settings, path + ".settings");
    if (!pass.arcs.empty()) {
        out += ",\n     \"arcs\": ";
        append_array(out, pass.arcs.size(), 7, [&](std::size_t k) {
            const Arc& arc = pass.arcs[k];
            out += '[' + std::to_string(arc.first) + ", " + std::to_string(arc.last) + ", ";
            append_rounded(out, arc.centre_mm.x(), "arcs");
            out += ", ";
            append_rounded(out, arc.centre_mm.y(), "arcs");
            out += ", " + std::to_string(arc.direction) + ']';
        });
    }
    append_extra(out, parse_object(pass.extra, path + ".extra", kPassKeys), 5);
    if (pass.load != 0) out += ",\n     \"load\": " + std::to_string(pass.load);
    out += ",\n     \"poses_mm\": ";
    append_rows(out, pass.poses_mm, 7, "poses_mm");
    if (pass.tool_axes.rows() > 0) {
        out += ",\n     \"tool_axes\": ";
        append_rows(out, pass.tool_axes, 7, "tool_axes");
    }
    out += '}';
}

}  // namespace

Plan read_plan(const std::string& text) {
    std::vector<PassRows> tables{{"poses_mm", 3, {}}, {"tool_axes", 3, {}}};
    auto [fields, version] = parse_versions(text, kFormat, kTiltVersion, &tables);
    Plan plan;
    plan.brush = io::text(fields.take("brush"));
    if (const auto digest = fields.find("brush_sha256")) plan.brush_sha256 = io::text(*digest);
    plan.sheet_mm = pair(fields.take("sheet_mm"));
    check_sheet(plan.sheet_mm);
    for (Field& pass : members(fields.take("passes"))) {
        plan.passes.push_back(read_pass(std::move(pass), plan.passes.size(), tables, version));
    }
    plan.extra = fields.extra();
    return plan;
}

std::string write_plan(const Plan& plan) {
    const bool tilts =
        std::any_of(plan.passes.begin(), plan.passes.end(), [](const Pass& pass) { return pass.tool_axes.rows() > 0; });
    std::string out = std::string("{\n  \"format\": \"") + kFormat +
                      "\",\n  \"version\": " + std::to_string(tilts ? kTiltVersion : 1) + ",\n  \"brush\": ";
    append_string(out, plan.brush, "brush");
    out += ",\n  \"brush_sha256\": ";
    append_string(out, plan.brush_sha256, "brush_sha256");
    check_sheet(plan.sheet_mm);
    out += ",\n  \"sheet_mm\": ";
    append_numbers(out, {plan.sheet_mm[0], plan.sheet_mm[1]}, 4, "sheet_mm");
    append_extra(out, parse_object(plan.extra, "extra", kPlanKeys), 2);
    out += ",\n  \"passes\": [";
    for (std::size_t i = 0; i < plan.passes.size(); ++i) {
        out += i == 0 ? "\n" : ",\n";
        append_pass(out, plan.passes[i], "passes[" + std::to_string(i) + "]");
    }
    out += plan.passes.empty() ? "]\n}\n" : "\n  ]\n}\n";
    return out;
}

}  // namespace brushsvg::io
