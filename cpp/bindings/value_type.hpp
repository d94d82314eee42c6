#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "converters.hpp"
#include "members.hpp"

// Features of all value types in Python in addition to their fields: equality, pickling and copying, and a hash if they
// cannot be changed.

template <class Value>
inline constexpr bool has_members = !std::is_same_v<decltype(members<Value>), const int>;

/// Return whether two values are equal in all members.
///
/// Here nan equals nan, so that a copy is equal to its original.
inline bool are_equal(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

template <int Rows, int Columns, int Options>
bool are_equal(const Eigen::Matrix<double, Rows, Columns, Options>& a,
               const Eigen::Matrix<double, Rows, Columns, Options>& b) {
    if (a.rows() != b.rows()) return false;
    for (Eigen::Index i = 0; i < a.size(); ++i)
        if (!are_equal(a.data()[i], b.data()[i])) return false;
    return true;
}

template <class Value>
bool are_equal(const Value& a, const Value& b);
template <class Value>
bool are_equal(const std::vector<Value>& a, const std::vector<Value>& b);
template <class Value>
bool are_equal(const std::optional<Value>& a, const std::optional<Value>& b);
template <class Value, std::size_t N>
bool are_equal(const std::array<Value, N>& a, const std::array<Value, N>& b) {
    for (std::size_t i = 0; i < N; ++i)
        if (!are_equal(a[i], b[i])) return false;
    return true;
}
template <class Value>
bool are_equal(const std::vector<Value>& a, const std::vector<Value>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (!are_equal(a[i], b[i])) return false;
    return true;
}
template <class Value>
bool are_equal(const std::optional<Value>& a, const std::optional<Value>& b) {
    return a.has_value() == b.has_value() && (!a || are_equal(*a, *b));
}
template <class Value>
bool are_equal(const Value& a, const Value& b) {
    if constexpr (has_members<Value>)
        return std::apply([&](auto... member) { return (are_equal(a.*member, b.*member) && ...); }, members<Value>);
    else
        return a == b;
}

template <class Value>
struct State;  // the pickled form of a value

template <class Value>
py::object state_of(const Value& value) {
    return State<Value>::of(value);
}

template <class Value>
struct State {
    static py::object of(const Value& value) {
        if constexpr (has_members<Value>)
            return std::apply([&](auto... member) { return py::make_tuple(state_of(value.*member)...); },
                              members<Value>);
        else
            return py::cast(value, py::return_value_policy::copy);
    }
    static Value from(const py::handle& state) {
        if constexpr (has_members<Value>) {
            const auto all = state.cast<py::tuple>();
            if (all.size() != std::tuple_size_v<std::decay_t<decltype(members<Value>)>>)
                throw py::type_error(
                    "the object was pickled by another version of brushsvg: pickle it again with this version");
            Value value{};
            std::size_t k = 0;
            const auto set = [&](auto& member) { member = State<std::decay_t<decltype(member)>>::from(all[k++]); };
            std::apply([&](auto... member) { (set(value.*member), ...); }, members<Value>);
            return value;
        } else {
            return state.cast<Value>();
        }
    }
};

template <class Value>
struct State<std::vector<Value>> {
    static py::object of(const std::vector<Value>& values) {
        if constexpr (std::is_arithmetic_v<Value>)  // marks contain thousands of numbers
            return py::array_t<Value>(py::ssize_t(values.size()), values.data());
        else {
            py::tuple out(values.size());
            for (std::size_t i = 0; i < values.size(); ++i) out[i] = state_of(values[i]);
            return std::move(out);
        }
    }
    static std::vector<Value> from(const py::handle& state) {
        if constexpr (std::is_arithmetic_v<Value>) {
            const auto numbers = state.cast<py::array_t<Value>>();
            return std::vector<Value>(numbers.data(), numbers.data() + numbers.size());
        } else {
            std::vector<Value> values;
            for (const py::handle one : state.cast<py::tuple>()) values.push_back(State<Value>::from(one));
            return values;
        }
    }
};

template <class Value>
struct State<std::optional<Value>> {
    static py::object of(const std::optional<Value>& value) { return value ? state_of(*value) : py::none(); }
    static std::optional<Value> from(const py::handle& state) {
        if (state.is_none()) return std::nullopt;
        return State<Value>::from(state);
    }
};

/// Return a hashable form of a state. Equal values have equal forms.
inline py::object hashable(const py::object& state) {
    if (py::isinstance<py::array>(state)) return hashable(state.attr("tolist")());
    if (py::isinstance<py::float_>(state) && std::isnan(state.cast<double>())) return py::none();
    if (!py::isinstance<py::tuple>(state) && !py::isinstance<py::list>(state)) return state;
    py::tuple out(py::len(state));
    std::size_t k = 0;
    for (const py::handle one : state) out[k++] = hashable(py::reinterpret_borrow<py::object>(one));
    return std::move(out);
}

/// Add equality, pickling and copying to a class whose members are listed.
///
/// A copy shares nothing with its original.
template <class Value>
void add_value_semantics(py::class_<Value>& type) {
    static_assert(has_members<Value>);
    type.def(
            "__eq__", [](const Value& a, const Value& b) { return are_equal(a, b); }, py::is_operator())
        .def("__copy__", [](const Value& value) { return Value(value); })
        .def(
            "__deepcopy__", [](const Value& value, const py::dict&) { return Value(value); }, py::arg("memo"))
        .def(py::pickle([](const Value& value) { return State<Value>::of(value).template cast<py::tuple>(); },
                        [](const py::tuple& state) { return State<Value>::from(state); }));
}

/// Add equality, pickling, copying and a hash to a class whose fields cannot be set.
template <class Value>
void add_fixed_value_semantics(py::class_<Value>& type) {
    add_value_semantics(type);
    type.def("__hash__", [](const Value& value) { return py::hash(hashable(state_of(value))); });
}

/// Format a number for repr.
inline std::string format_number(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", number);
    return text;
}

/// Return a name in quotes, like repr.
inline std::string quoted(const std::string& name) { return py::repr(py::str(name)).cast<std::string>(); }

inline std::string format_count(std::size_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : what.back() == 's' ? "es" : "s");
}

/// Return the repr of a value.
template <class Value>
std::string repr_of(const Value& value) {
    return py::repr(py::cast(value)).template cast<std::string>();
}
