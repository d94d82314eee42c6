#pragma once

// Private to brushsvg::io: writes JSON that people can read and compare, in one string.

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/marks.hpp"
#include "json_fields.hpp"

namespace brushsvg::io {

inline void refuse_not_finite(double value, const std::string& what) {
    if (!std::isfinite(value))
        throw Error("not-finite", what + " is not a finite number and cannot be written", what, value);
}

/// Appends the shortest plain decimal that reads back to the same double, without exponent and without -0.
inline void append_exact(std::string& out, double value, const char* what) {
    refuse_not_finite(value, what);
    std::array<char, 1100> digits;  // the smallest subnormal number has 1077 characters
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value == 0.0 ? 0.0 : value,
                                   std::chars_format::fixed);
    out.append(digits.data(), end.ptr);
}

/// Formats a number for a message.
inline std::string describe(double value) {
    if (!std::isfinite(value)) return "a number that is not finite";
    if (std::abs(value) >= 1e9) {  // up to three hundred digits would not help
        std::array<char, 32> digits;
        char* end =
            std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 6).ptr;
        return std::string(digits.data(), end);
    }
    std::string out;
    append_exact(out, value, "");
    return out;
}

/// Appends a plain decimal rounded to 1e-7, a hundredth of any machine's resolution, so that files stay readable.
inline void append_rounded(std::string& out, double value, const char* what) {
    refuse_not_finite(value, what);
    std::array<char, 330> digits;
    char* end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, 7).ptr;
    while (end[-1] == '0') --end;
    if (end[-1] == '.') --end;
    const bool is_minus_zero = end - digits.data() == 2 && digits[0] == '-' && digits[1] == '0';
    out.append(digits.data() + (is_minus_zero ? 1 : 0), end);
}

inline void append_json(std::string& out, const Json& value, const std::string& path) {
    try {
        out += value.dump();
    } catch (const Json::exception&) {
        throw Error("not-text", "the text is not valid UTF-8", path);
    }
}

inline void append_string(std::string& out, const std::string& text, const std::string& path) {
    append_json(out, Json(text), path);
}

/// Appends "[item, item,\n      item]" with as many items on a line as fit into 110 columns.
template <class Append>
void append_array(std::string& out, std::size_t count, std::size_t indent, Append append_item) {
    out += '[';
    std::size_t line = out.find_last_of('\n') + 1;  // npos + 1 is 0, for the first line
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t gap = out.size() + 1;
        if (i > 0) out += ", ";
        checkpoint();
        append_item(i);
        if (i > 0 && out.size() - line > 110) {
            out[gap] = '\n';
            out.insert(gap + 1, indent, ' ');
            line = gap + 1;
        }
    }
    out += ']';
}

inline void append_numbers(std::string& out, const std::vector<double>& values, std::size_t indent, const char* what) {
    append_array(out, values.size(), indent, [&](std::size_t i) { append_exact(out, values[i], what); });
}

/// Appends [[x, y], ...], exact or rounded, from a matrix with one point per row.
template <class Matrix>
void append_rows(std::string& out, const Matrix& rows, std::size_t indent, const char* what,
                 void (*append)(std::string&, double, const char*) = append_rounded) {
    append_array(out, static_cast<std::size_t>(rows.rows()), indent, [&](std::size_t i) {
        for (Eigen::Index k = 0; k < rows.cols(); ++k) {
            out += k == 0 ? "[" : ", ";
            append(out, rows(static_cast<Eigen::Index>(i), k), what);
        }
        out += ']';
    });
}

/// Appends `, "key": value` for each key of an object, each on its own line.
inline void append_extra(std::string& out, const Json& object, std::size_t indent) {
    for (const auto& [key, value] : object.items()) {
        out += ",\n" + std::string(indent, ' ') + Json(key).dump() + ": " + value.dump();
    }
}

}  // namespace brushsvg::io
