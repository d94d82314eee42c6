#pragma once

// Private to brushsvg::io: parses a text to a well-formed JSON document of the right format and version.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "json_fields.hpp"

namespace brushsvg::io {

/// Rows of numbers under passes[i].key, which are removed from the document while it is parsed, because a table of ten
/// million poses as JSON values would need gigabytes. Row k of pass i begins at values[i][k * width].
struct PassRows {
    std::string key;
    std::size_t width;
    std::vector<std::vector<double>> values;

    /// Returns the rows of one pass as a matrix. `left`: the rest of the array after parsing, which are rows of another
    /// shape.
    template <class Matrix>
    Matrix rows_of_pass(std::size_t pass, const Field& left, const std::string& shape) const;
};

/// Follows the parser through the document: tracks the key path, refuses keys that appear twice in one object,
/// and collects the rows of passes.
class ParseObserver {
 public:
    explicit ParseObserver(std::vector<PassRows>* tables) : tables_(tables) {}

    Json parse(const std::string& text) {
        return Json::parse(
            text, [this](int, Json::parse_event_t event, Json& parsed) { return handle_event(event, parsed); });
    }

    std::string path() const {
        std::string path;
        for (const Level& level : levels_) {
            if (level.is_array) {
                path += "[" + std::to_string(level.index) + "]";
            } else if (!level.key.empty()) {
                path += (path.empty() ? "" : ".") + level.key;
            }
        }
        return path;
    }

 private:
    struct Level {
        bool is_array;
        std::size_t index;  ///< index of the current member in an array
        std::string key;    ///< key of the current member in an object
        std::set<std::string> keys;
    };

    /// Handles an event of the parser. Returns false to drop the value just read from the document.
    bool handle_event(Json::parse_event_t event, const Json& parsed) {
        checkpoint();
        using Event = Json::parse_event_t;
        switch (event) {
            case Event::object_start:
            case Event::array_start:
                // Printing nested values is recursive. Our files have at most seven levels.
                if (levels_.size() == 100)
                    throw Error("not-json", "the file is nested deeper than 100 levels", levels_.front().key);
                levels_.push_back({event == Event::array_start, 0, {}, {}});
                return true;
            case Event::key:
                levels_.back().key = parsed.get_ref<const std::string&>();
                if (!levels_.back().keys.insert(levels_.back().key).second) {
                    throw Error("key-twice",
                                "the key " + levels_.back().key + " occurs twice in one object: remove one of them",
                                path());
                }
                return true;
            case Event::object_end:
            case Event::array_end: {
                levels_.pop_back();
                const bool keep = event == Event::object_end || !collect(parsed);
                count();
                return keep;
            }
            case Event::value:
                count();
                return true;
        }
        return true;
    }

    void count() {
        if (!levels_.empty() && levels_.back().is_array) ++levels_.back().index;
    }

    bool collect(const Json& row) {
        if (tables_ == nullptr || levels_.size() != 4 || levels_[0].key != "passes" || !levels_[1].is_array ||
            !levels_[3].is_array) {
            return false;
        }
        const auto rows = std::find_if(tables_->begin(), tables_->end(),
                                       [&](const PassRows& each) { return each.key == levels_[2].key; });
        if (rows == tables_->end()) return false;
        const std::size_t pass = levels_[1].index;
        if (rows->values.size() <= pass) rows->values.resize(pass + 1);
        std::vector<double>& values = rows->values[pass];
        // Rows after a row of a wrong shape stay as well, so that it keeps its number.
        if (row.size() != rows->width || values.size() != levels_[3].index * rows->width) return false;
        for (const Json& value : row) {
            if (!value.is_number()) return false;
        }
        for (const Json& value : row) values.push_back(value.get<double>());
        return true;
    }

    std::vector<PassRows>* tables_;
    std::vector<Level> levels_;
};

template <class Matrix>
Matrix PassRows::rows_of_pass(std::size_t pass, const Field& left, const std::string& shape) const {
    static const std::vector<double> none;
    const std::vector<double>& flat = pass < values.size() ? values[pass] : none;
    const std::size_t count = flat.size() / width;
    if (!left.value.is_array()) {
        left.refuse("wrong-type",
                    left.name() + " must be an array of rows of " + shape + ", not " + describe(left.value));
    }
    if (!left.value.empty()) {
        const Json& fault = left.value[0];
        const std::string path = left.path + "[" + std::to_string(count) + "]";
        if (fault.is_array() && fault.size() == width) require_numbers(fault, path);
        throw Error("wrong-type",
                    "each row of " + left.name() + " must be " + shape + ", not " + describe(fault) +
                        (fault.is_array() ? " of " + std::to_string(fault.size()) : ""),
                    path);
    }
    return Eigen::Map<const Matrix>(flat.data(), static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(width));
}

/// Returns "line 3, column 7" for a byte of the text (counted from 1).
inline std::string line_and_column(const std::string& text, std::size_t byte) {
    std::size_t line = 1;
    std::size_t column = 1;
    for (std::size_t i = 0; i + 1 < byte && i < text.size(); ++i) {
        column = text[i] == '\n' ? 1 : column + 1;
        line += text[i] == '\n' ? 1 : 0;
    }
    return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

/// Returns the reason from the library's message "...syntax error while parsing X - REASON; last read: '...'; expected
/// Y".
inline std::string parse_error_reason(const std::string& message) {
    const std::size_t dash = message.find(" - ");
    std::string reason = dash == std::string::npos ? "it is incomplete" : message.substr(dash + 3);
    return reason.substr(0, reason.find("; last read"));
}

/// A JSON document of one of our formats.
struct Document {
    Fields fields;
    int version;
};

/// Parses a text that must be one JSON object with this format, of version 1 up to the newest one.
inline Document parse_versions(const std::string& text, const std::string& format, int newest,
                               std::vector<PassRows>* tables) {
    ParseObserver observer(tables);
    Json document;
    try {
        document = observer.parse(text);
    } catch (const Json::parse_error& fault) {
        throw Error("not-json",
                    "the file is not valid JSON at " + line_and_column(text, fault.byte) + ": " +
                        parse_error_reason(fault.what()),
                    observer.path());
    } catch (const Json::out_of_range& fault) {  // for example 1e400
        throw Error("not-finite", "the file contains a number that is too large", observer.path());
    }
    Fields fields(Field{std::move(document), ""});
    const Field found = fields.take("format");
    if (io::text(found) != format) {
        found.refuse("format-unknown",
                     "the format of the file is " + found.value.dump() + ", but must be \"" + format + "\"");
    }
    const Field version = fields.take("version");
    const double read = number(version);
    if (!(read >= 1.0 && read <= newest && read == std::floor(read))) {
        throw Error("version-unknown",
                    "version " + version.value.dump() + " of " + format + " cannot be read, only " +
                        (newest == 1 ? "version 1" : "versions 1 to " + std::to_string(newest)) +
                        ": use a newer brushsvg, or write the file again",
                    version.path, read);
    }
    return {std::move(fields), static_cast<int>(read)};
}

/// Parses a text of a format that has only one version.
inline Fields parse_document(const std::string& text, const std::string& format) {
    return parse_versions(text, format, 1, nullptr).fields;
}

/// Parses the JSON object in a value type's `extra` or `settings`, which must not have keys of the writer itself.
inline Json parse_object(const std::string& text, const std::string& path, const std::set<std::string>& own_keys = {}) {
    ParseObserver observer(nullptr);
    Json object;
    try {
        object = observer.parse(text);
    } catch (const Json::exception&) {
        object = nullptr;
    }
    if (!object.is_object())
        throw Error("not-json", Field{nullptr, path}.name() + " must be the text of a JSON object", path);
    for (const auto& [key, value] : object.items()) {
        if (own_keys.count(key) > 0)
            throw Error("key-twice", "the key " + key + " is not an unknown key: set it by its own argument", path);
    }
    return object;
}

}  // namespace brushsvg::io
