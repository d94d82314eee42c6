#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "brushsvg/error.hpp"

namespace brushsvg {

/// Throws Error for a number outside a range, and for NaN. `what`: name of the number in the message.
inline void require_within(double value, const std::array<double, 2>& range, const std::string& what,
                           const std::string& where = "") {
    if (value >= range[0] && value <= range[1]) return;
    char text[80];
    std::snprintf(text, sizeof text, ", %.4g, is outside the range [%.4g, %.4g]", value, range[0], range[1]);
    throw Error("out-of-range", what + text, where, value, range);
}

}  // namespace brushsvg
