#pragma once

#include <cstdio>
#include <string>

namespace brushsvg {

/// Returns numbers and words in a pattern of printf, cut off at 299 bytes.
template <class... Values>
std::string format_text(const char* pattern, Values... values) {
    char text[300];
    std::snprintf(text, sizeof text, pattern, values...);
    return text;
}

}  // namespace brushsvg
