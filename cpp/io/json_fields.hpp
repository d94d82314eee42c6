#pragma once

// Private to brushsvg::io: reads values of a JSON document with the required types, and with their key paths.

#include <array>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "brushsvg/error.hpp"
#include "brushsvg/marks.hpp"

namespace brushsvg::io {

using Json = nlohmann::ordered_json;  // keeps the order of unknown keys

/// A value and its key path in the file, such as "lag.coefficients".
struct Field {
    Json value;
    std::string path;

    [[noreturn]] void refuse(const char* code, const std::string& sentence) const { throw Error(code, sentence, path); }
    /// Returns the name of the value for messages, such as "coefficients".
    std::string name() const { return path.empty() ? "the file" : path.substr(path.find_last_of('.') + 1); }
};

inline std::string describe(const Json& value) {
    switch (value.type()) {
        case Json::value_t::null:
            return "null";
        case Json::value_t::boolean:
            return value.get<bool>() ? "true" : "false";
        case Json::value_t::string:
            return "a string";
        case Json::value_t::array:
            return "an array";
        case Json::value_t::object:
            return "an object";
        default:
            return value.dump();
    }
}

inline double number(const Field& field) {
    if (!field.value.is_number())
        field.refuse("wrong-type", field.name() + " must be a number, not " + describe(field.value));
    return field.value.get<double>();
}

inline int whole(const Field& field) {
    const double value = number(field);
    if (value != std::floor(value) || std::abs(value) > 1e9)
        throw Error("wrong-type", field.name() + " must be a whole number, not " + describe(field.value), field.path,
                    value);
    return static_cast<int>(value);
}

inline double positive(const Field& field) {
    const double value = number(field);
    if (!(value > 0.0)) {
        throw Error("out-of-range", field.name() + " must be greater than 0, not " + describe(field.value), field.path,
                    value);
    }
    return value;
}

inline std::string text(const Field& field) {
    if (!field.value.is_string())
        field.refuse("wrong-type", field.name() + " must be a string, not " + describe(field.value));
    return field.value.get<std::string>();
}

inline bool boolean_value(const Field& field) {
    if (!field.value.is_boolean()) {
        field.refuse("wrong-type", field.name() + " must be true or false, not " + describe(field.value));
    }
    return field.value.get<bool>();
}

/// Returns the members of an array as fields, with the index in their paths.
inline std::vector<Field> members(Field field) {
    if (!field.value.is_array())
        field.refuse("wrong-type", field.name() + " must be an array, not " + describe(field.value));
    std::vector<Field> fields;
    fields.reserve(field.value.size());
    for (std::size_t i = 0; i < field.value.size(); ++i) {
        fields.push_back({std::move(field.value[i]), field.path + "[" + std::to_string(i) + "]"});
    }
    return fields;
}

inline void require_numbers(const Json& row, const std::string& path) {
    for (std::size_t i = 0; i < row.size(); ++i) {
        if (row[i].is_number()) continue;
        const Field fault{row[i], path + "[" + std::to_string(i) + "]"};
        number(fault);
    }
}

inline std::vector<double> numbers(const Field& field) {
    if (!field.value.is_array()) {
        field.refuse("wrong-type", field.name() + " must be an array of numbers, not " + describe(field.value));
    }
    require_numbers(field.value, field.path);
    return field.value.get<std::vector<double>>();
}

inline std::array<double, 2> pair(const Field& field) {
    const std::vector<double> values = numbers(field);
    if (values.size() != 2) {
        field.refuse("wrong-type", field.name() + " must contain two numbers, not " + std::to_string(values.size()));
    }
    return {values[0], values[1]};
}

/// Reads an interval [least, greatest].
inline std::array<double, 2> interval(const Field& field) {
    const std::array<double, 2> ends = pair(field);
    if (ends[0] > ends[1]) field.refuse("not-ascending", field.name() + " must contain the smaller number first");
    return ends;
}

/// Largest coordinate [mm]. Greater ones are damaged data; squares of smaller ones can be added without overflow.
inline constexpr double kMaxFileCoordinateMm = 1e6;

inline void require_coordinates(const Ring& ring, const std::string& path) {
    for (Eigen::Index i = 0; i < ring.rows(); ++i)
        for (const double mm : {ring(i, 0), ring(i, 1)})
            if (!(std::abs(mm) <= kMaxFileCoordinateMm))
                throw Error("geometry-out-of-range",
                            "a coordinate of " + Json(mm).dump() + " mm is outside the range [-1e6, 1e6] mm",
                            path + "[" + std::to_string(i) + "]", mm,
                            std::array<double, 2>{-kMaxFileCoordinateMm, kMaxFileCoordinateMm});
}

/// Reads points [[x, y], ...].
inline Ring points(const Field& field) {
    if (!field.value.is_array()) {
        field.refuse("wrong-type", field.name() + " must be an array of points [x, y], not " + describe(field.value));
    }
    Ring ring(static_cast<Eigen::Index>(field.value.size()), 2);
    for (std::size_t i = 0; i < field.value.size(); ++i) {
        const Json& point = field.value[i];
        const auto path = [&] { return field.path + "[" + std::to_string(i) + "]"; };
        if (!point.is_array() || point.size() != 2) {
            throw Error("wrong-type", "a point must be two numbers [x, y], not " + describe(point), path());
        }
        if (!point[0].is_number() || !point[1].is_number()) require_numbers(point, path());
        ring.row(static_cast<Eigen::Index>(i)) << point[0].get<double>(), point[1].get<double>();
    }
    require_coordinates(ring, field.path);
    return ring;
}

/// An object whose known keys are removed one by one, so that the unknown keys remain.
class Fields {
 public:
    explicit Fields(Field object) : object_(std::move(object)) {
        if (!object_.value.is_object()) {
            object_.refuse("wrong-type", object_.name() + " must be an object, not " + describe(object_.value));
        }
    }

    std::optional<Field> find(const std::string& key) {
        const auto found = object_.value.find(key);
        if (found == object_.value.end()) return std::nullopt;
        Field field{std::move(*found), path_of(key)};
        object_.value.erase(found);
        return field;
    }

    Field take(const std::string& key) {
        std::optional<Field> field = find(key);
        if (!field) throw Error("key-missing", "the key " + key + " is missing", path_of(key));
        return std::move(*field);
    }

    Json& unknown_keys() { return object_.value; }
    std::string extra() const { return object_.value.dump(); }

 private:
    std::string path_of(const std::string& key) const { return object_.path.empty() ? key : object_.path + "." + key; }
    Field object_;
};

}  // namespace brushsvg::io
