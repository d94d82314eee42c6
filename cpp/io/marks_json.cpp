#include "marks_json.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "brushsvg/plan.hpp"
#include "json_document.hpp"
#include "json_fields.hpp"
#include "json_text.hpp"

namespace brushsvg::io {
namespace {

constexpr const char* kFormat = "brushsvg/marks";
constexpr int kLeanVersion = 2;  // the version with the lean of a tilted brush; other marks are written without it

/// Throws Error unless the rows of a pass are parallel. `path`: key path of the pass.
void require_parallel(const PassMarks& pass, const std::string& path) {
    const auto require = [&](const char* key, std::size_t rows) {
        if (rows == pass.pose.size()) return;
        throw Error("sizes-differ",
                    std::string(key) + " of stroke " + pass.stroke + " has " + std::to_string(rows) +
                        " rows, but pose has " + std::to_string(pass.pose.size()),
                    path + "." + key);
    };
    require("contact_mm", static_cast<std::size_t>(pass.contact_mm.rows()));
    require("heading_rad", pass.heading_rad.size());
    require("depth_mm", pass.depth_mm.size());
    require("taut", pass.taut.size());
    if (pass.lean_mm_per_mm.rows() > 0) require("lean_mm_per_mm", static_cast<std::size_t>(pass.lean_mm_per_mm.rows()));
    if (!pass.width_share.empty()) require("width_share", pass.width_share.size());
}

void require_within(const std::vector<double>& values, const std::string& path, double least, double greatest) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!(values[i] >= least && values[i] <= greatest))
            throw Error("out-of-range",
                        "the number " + describe(values[i]) + " is outside the range [" + describe(least) + ", " +
                            describe(greatest) + "]",
                        path + "[" + std::to_string(i) + "]", values[i], std::array<double, 2>{least, greatest});
}

/// Throws Error where the brush leans by more than a plan permits.
void require_lean(const PassMarks& pass, const std::string& path) {
    static const double most = std::tan((kMaxTiltDeg + kTiltRoundingDeg) * std::acos(-1.0) / 180.0);
    for (Eigen::Index i = 0; i < pass.lean_mm_per_mm.rows(); ++i) {
        const double lean = pass.lean_mm_per_mm.row(i).norm();
        if (!(lean <= most + 1e-6))  // values are written with seven decimals
            throw Error("out-of-range",
                        "row " + std::to_string(i) + " of stroke " + pass.stroke + " leans by " + describe(lean) +
                            " mm per mm, outside the range [0, " + describe(most) + "]",
                        path + "[" + std::to_string(i) + "]", lean, std::array<double, 2>{0.0, most});
    }
}

Rings read_rings(Fields& fields) {
    Rings rings;
    if (auto field = fields.find("outline_mm")) {
        for (const Field& ring : members(std::move(*field))) rings.push_back(points(ring));
    }
    return rings;
}

PassMarks read_pass(Field field, std::size_t index, const std::vector<PassRows>& tables, int version) {
    const std::string path = field.path;
    Fields fields(std::move(field));
    PassMarks pass;
    pass.stroke = text(fields.take("stroke"));
    pass.pose = numbers(fields.take("pose"));
    pass.contact_mm = tables[0].rows_of_pass<Ring>(index, fields.take("contact_mm"), "two numbers [x, y]");
    pass.heading_rad = numbers(fields.take("heading_rad"));
    pass.depth_mm = numbers(fields.take("depth_mm"));
    for (const Field& value : members(fields.take("taut"))) pass.taut.push_back(boolean_value(value) ? 1 : 0);
    if (const auto lean = fields.find("lean_mm_per_mm")) {
        if (version < kLeanVersion)
            lean->refuse("version-unknown", "lean_mm_per_mm of stroke " + pass.stroke + " needs version 2 of " +
                                                kFormat + "; the file says version 1");
        pass.lean_mm_per_mm = tables[1].rows_of_pass<Ring>(index, *lean, "two numbers [x, y]");
    }
    if (const auto share = fields.find("width_share")) pass.width_share = numbers(*share);
    pass.outline_mm = read_rings(fields);
    pass.pull.assign(pass.pose.size(), 1.0);
    require_parallel(pass, path);
    require_coordinates(pass.contact_mm, path + ".contact_mm");
    require_lean(pass, path + ".lean_mm_per_mm");
    require_within(pass.pose, path + ".pose", 0.0, 1e9);
    require_within(pass.heading_rad, path + ".heading_rad", -kMaxFileCoordinateMm, kMaxFileCoordinateMm);
    require_within(pass.depth_mm, path + ".depth_mm", -kMaxFileCoordinateMm, kMaxFileCoordinateMm);
    require_within(pass.width_share, path + ".width_share", 0.0, 1.0);
    return pass;
}

void append_column(std::string& out, const char* key, const std::vector<double>& values) {
    out += std::string(",\n     \"") + key + "\": ";
    append_array(out, values.size(), 7, [&](std::size_t i) { append_rounded(out, values[i], key); });
}

void append_rings(std::string& out, const Rings& rings, std::size_t indent) {
    out += '[';
    for (std::size_t i = 0; i < rings.size(); ++i) {
        out += (i == 0 ? "\n" : ",\n") + std::string(indent, ' ');
        append_rows(out, rings[i], indent + 2, "outline_mm");
    }
    out += ']';
}

void append_pass(std::string& out, const PassMarks& pass, const std::string& path) {
    require_parallel(pass, path);
    out += "    {\"stroke\": ";
    append_string(out, pass.stroke, path + ".stroke");
    append_column(out, "pose", pass.pose);
    out += ",\n     \"contact_mm\": ";
    append_rows(out, pass.contact_mm, 7, "contact_mm");
    append_column(out, "heading_rad", pass.heading_rad);
    append_column(out, "depth_mm", pass.depth_mm);
    out += ",\n     \"taut\": ";
    append_array(out, pass.taut.size(), 7, [&](std::size_t i) { out += pass.taut[i] != 0 ? "true" : "false"; });
    if (pass.lean_mm_per_mm.rows() > 0) {
        out += ",\n     \"lean_mm_per_mm\": ";
        append_rows(out, pass.lean_mm_per_mm, 7, "lean_mm_per_mm");
    }
    if (!pass.width_share.empty()) append_column(out, "width_share", pass.width_share);
    out += ",\n     \"outline_mm\": ";
    append_rings(out, pass.outline_mm, 7);
    out += '}';
}

}  // namespace

Marks read_marks(const std::string& text) {
    std::vector<PassRows> tables{{"contact_mm", 2, {}}, {"lean_mm_per_mm", 2, {}}};
    auto [fields, version] = parse_versions(text, kFormat, kLeanVersion, &tables);
    Marks marks;
    marks.outline_mm = read_rings(fields);
    for (Field& pass : members(fields.take("passes"))) {
        marks.passes.push_back(read_pass(std::move(pass), marks.passes.size(), tables, version));
    }
    return marks;
}

std::string write_marks(const Marks& marks) {
    const bool leans = std::any_of(marks.passes.begin(), marks.passes.end(),
                                   [](const PassMarks& pass) { return pass.lean_mm_per_mm.rows() > 0; });
    std::string out = std::string("{\n  \"format\": \"") + kFormat +
                      "\",\n  \"version\": " + std::to_string(leans ? kLeanVersion : 1) + ",\n  \"outline_mm\": ";
    append_rings(out, marks.outline_mm, 4);
    out += ",\n  \"passes\": [";
    for (std::size_t i = 0; i < marks.passes.size(); ++i) {
        out += i == 0 ? "\n" : ",\n";
        append_pass(out, marks.passes[i], "passes[" + std::to_string(i) + "]");
    }
    out += marks.passes.empty() ? "]\n}\n" : "\n  ]\n}\n";
    return out;
}

}  // namespace brushsvg::io
