#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace [[gnu::visibility("default")]] brushsvg {

/// An error with its message in one full sentence.
///
/// `code`: the kind of error (docs/reference/diagnostics.md). `where`: the element, such as a stroke's id or a key of a
/// file. `value`, `range`: the offending number and the allowed range, if there are any.
class Error : public std::runtime_error {
 public:
    Error(std::string code, const std::string& sentence, std::string where = "",
          std::optional<double> value = std::nullopt, std::optional<std::array<double, 2>> range = std::nullopt)
        : std::runtime_error(sentence),
          code_(std::move(code)),
          where_(std::move(where)),
          value_(value),
          range_(range) {}

    const std::string& code() const { return code_; }
    const std::string& where() const { return where_; }
    const std::optional<double>& value() const { return value_; }
    const std::optional<std::array<double, 2>>& range() const { return range_; }

 private:
    std::string code_;
    std::string where_;
    std::optional<double> value_;
    std::optional<std::array<double, 2>> range_;
};

/// A warning: something that the user should know but that stops nothing. It has the fields of Error, with the message
/// in `sentence`.
struct Warning {
    std::string code;
    std::string where;
    std::string sentence;
};

}  // namespace brushsvg
