#pragma once

#include <array>
#include <string>

#include "base/format_text.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg {

/// Throws Error for a number outside a range, and for NaN. `what`: name of the number in the message.
inline void require_within(double value, const std::array<double, 2>& range, const std::string& what,
                           const std::string& where = "") {
    if (value >= range[0] && value <= range[1]) return;
    throw Error("out-of-range",
                what + format_text(" is %.4g, outside the range [%.4g, %.4g]", value, range[0], range[1]), where, value,
                range);
}

}  // namespace brushsvg
