#pragma once

#include <doctest/doctest.h>

#include <cctype>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "brushsvg/error.hpp"

/// Return the Error that a call throws; nothing if it throws none.
inline std::optional<brushsvg::Error> refusal(const std::function<void()>& does) {
    try {
        does();
    } catch (const brushsvg::Error& e) {
        return e;
    }
    return std::nullopt;
}

/// Return whether a sentence contains a number or a name as a whole: 2 is not in 2.5 or 12.
inline bool stands_in(const std::string& part, const std::string& sentence) {
    const auto joins = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
    const auto at = [&](std::size_t i) { return i < sentence.size() ? sentence[i] : ' '; };
    for (std::size_t from = sentence.find(part); from != std::string::npos; from = sentence.find(part, from + 1)) {
        const std::size_t to = from + part.size();
        const char before = from > 0 ? sentence[from - 1] : ' ';
        const bool begins = !joins(part.front()) || !(joins(before) || before == '.' || before == '-');
        const bool ends = !joins(part.back()) || !(joins(at(to)) || (at(to) == '.' && joins(at(to + 1))));
        if (begins && ends) return true;
    }
    return false;
}

/// Return whether an Error has this code and element, and these numbers and names in its sentence. The other words of
/// the sentence do not matter.
inline bool agrees(const std::optional<brushsvg::Error>& error, const std::string& code, const std::string& where,
                   const std::vector<std::string>& parts = {}) {
    if (!error) {
        MESSAGE("not refused");
        return false;
    }
    bool all = error->code() == code && error->where() == where;
    for (const std::string& part : parts) all = all && stands_in(part, error->what());
    if (!all) MESSAGE(error->code(), ", ", error->where(), ": ", error->what());
    return all;
}
