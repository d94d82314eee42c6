#pragma once

#include <functional>
#include <string>

#include "brushsvg/error.hpp"

/// Where and why something is refused, "" where it is not.
inline std::string refusal(const std::function<void()>& does) {
    try {
        does();
    } catch (const brushsvg::Error& e) {
        return e.where() + ": " + e.what();
    }
    return "";
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }
