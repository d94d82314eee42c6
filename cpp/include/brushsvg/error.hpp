#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace [[gnu::visibility("default")]] brushsvg {

/// A refusal in one full sentence. `code` says of what kind it is (docs/reference/diagnostics.md), `where` names the
/// element (a stroke id, a key of a file), `value` and `range` carry the offending number and what is allowed, where
/// there are such.
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

/// Something the user should know that stops nothing: of what kind it is, which element, and one sentence.
struct Warning {
    std::string code;
    std::string where;
    std::string sentence;
};

}  // namespace brushsvg
