#pragma once

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "brushsvg/error.hpp"

// Converters from Python's lists and arrays to C++ types, like those of pybind11. But they neither reserve memory nor
// call numpy before they know the number of entries.

namespace py = pybind11;

/// Most entries of a list. No useful list is longer, and no memory is requested for a longer one.
inline constexpr py::ssize_t kMaxEntries = 10'000'000;

/// Counts the entries of one argument. Lists within a list are counted together; a row of numbers is one entry.
class EntryCounter {
 public:
    EntryCounter() {
        if (depth_++ == 0) entry_count_ = 0;
    }
    ~EntryCounter() { --depth_; }
    EntryCounter(const EntryCounter&) = delete;
    EntryCounter& operator=(const EntryCounter&) = delete;

    /// Throw Error if that many more entries are too many.
    static void require_room_for(py::ssize_t more) {
        const double all = double(entry_count_) + double(more);
        if (all > double(kMaxEntries))
            throw brushsvg::Error("list-too-long",
                                  "a list has " +
                                      std::to_string(entry_count_ + std::min(more, PY_SSIZE_T_MAX - entry_count_)) +
                                      " entries, but at most " + std::to_string(kMaxEntries) + " are allowed",
                                  "", all, std::array<double, 2>{0.0, double(kMaxEntries)});
    }
    static void add(py::ssize_t more) {
        require_room_for(more);
        entry_count_ += more;
    }

 private:
    static inline thread_local int depth_ = 0;
    static inline thread_local py::ssize_t entry_count_ = 0;
};

/// A number, or an array of numbers of any shape, for `py::vectorize`.
struct Numbers {
    py::array_t<double, py::array::forcecast> values;
};

namespace pybind11::detail {

using DoubleArray = array_t<double, array::c_style | array::forcecast>;

/// Replace masked values by nan: values below a mask are not data.
inline object replace_masked_by_nan(handle source) {
    if (!isinstance<array>(source) || !hasattr(source, "filled")) return reinterpret_borrow<object>(source);
    return source.attr("astype")("float64").attr("filled")(std::numeric_limits<double>::quiet_NaN());
}

/// Return an array of numbers, or null for anything else.
///
/// Complex numbers, dates and words would only seem to be numbers, and None would become nan.
inline DoubleArray to_double_array(handle source) {
    const auto found = reinterpret_steal<object>(array::ensure(replace_masked_by_nan(source)).release());
    if (!found || std::string("biuf").find(array(found).dtype().kind()) == std::string::npos)
        return reinterpret_steal<DoubleArray>(handle());
    const auto values = reinterpret_borrow<array>(found);
    EntryCounter::require_room_for(values.ndim() == 2 ? values.shape(0) : values.size());
    return DoubleArray::ensure(values);
}

/// Return whether an object is an array or makes one of itself, unlike a list.
inline bool is_array(handle source) {
    return isinstance<array>(source) || hasattr(source, "__array__") || PyMemoryView_Check(source.ptr());
}

template <class Value>
struct type_caster<std::vector<Value>> : list_caster<std::vector<Value>, Value> {
    bool load(handle source, bool convert) {
        if (!object_is_convertible_to_std_vector(source)) return false;
        if (!convert && !isinstance<sequence>(source)) return false;  // a generator can be read only once
        const EntryCounter entries;
        ssize_t claimed = PyObject_LengthHint(source.ptr(), 0);
        if (claimed < 0) {
            PyErr_Clear();
            claimed = 0;
        }
        EntryCounter::require_room_for(claimed);
        this->value.clear();
        this->value.reserve(std::size_t(claimed));
        for (const handle one : reinterpret_borrow<iterable>(source)) {
            EntryCounter::add(1);  // it may have more entries than it claims
            make_caster<Value> read;
            if (!read.load(one, convert)) return false;
            this->value.push_back(cast_op<Value&&>(std::move(read)));
        }
        return true;
    }
};

/// Converts only str, not bytes. Bytes need not be text, so a file written with them could not be read again. For the
/// content of a file, use std::string_view.
template <>
struct type_caster<std::string> : string_caster<std::string> {
    bool load(handle source, bool convert) {
        return PyUnicode_Check(source.ptr()) && string_caster<std::string>::load(source, convert);
    }
};

/// Converts only sequences, not the generators, sets and dicts that pybind11 would accept.
template <std::size_t N>
struct type_caster<std::array<double, N>> : array_caster<std::array<double, N>, double, false, N> {
    bool load(handle source, bool convert) {
        return isinstance<sequence>(source) &&
               array_caster<std::array<double, N>, double, false, N>::load(source, convert);
    }
};

template <>
struct type_caster<Numbers> {
    PYBIND11_TYPE_CASTER(Numbers, const_name("numpy.typing.ArrayLike"));

    bool load(handle source, bool convert) {
        if (isinstance<sequence>(source) && !is_array(source)) {
            make_caster<std::vector<double>> list;
            if (!list.load(source, convert)) return false;
            const auto& read = cast_op<std::vector<double>&>(list);
            value.values = array_t<double>(ssize_t(read.size()), read.data());
            return true;
        }
        const auto numbers = to_double_array(source);
        if (numbers) value.values = numbers;
        return bool(numbers);
    }
};

/// Converts (n, Columns) numbers: an array, or a list of rows.
template <int Columns>
struct rows_caster {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Columns, Eigen::RowMajor>;
    using props = EigenProps<Rows>;
    PYBIND11_TYPE_CASTER(Rows, props::descriptor);

    bool load(handle source, bool convert) {
        if (!convert && !isinstance<array_t<double>>(source)) return false;
        const EntryCounter entries;
        if (is_array(source)) {
            const auto numbers = to_double_array(source);
            if (!numbers || numbers.ndim() != 2 || numbers.shape(1) != Columns) return false;
            EntryCounter::add(numbers.shape(0));
            value = Eigen::Map<const Rows>(numbers.data(), numbers.shape(0), Columns);
            return true;
        }
        make_caster<std::vector<std::array<double, Columns>>> list;
        if (!list.load(source, convert)) return false;
        const auto& read = cast_op<std::vector<std::array<double, Columns>>&>(list);
        value.resize(Eigen::Index(read.size()), Columns);
        for (std::size_t i = 0; i < read.size(); ++i)
            for (int k = 0; k < Columns; ++k) value(Eigen::Index(i), k) = read[i][std::size_t(k)];
        return true;
    }

    static handle cast(Rows&& rows, return_value_policy, handle) {
        return eigen_encapsulate<props>(new Rows(std::move(rows)));
    }
    static handle cast(const Rows& rows, return_value_policy policy, handle parent) {
        return policy == return_value_policy::reference_internal ? eigen_ref_array<props>(rows, parent)
                                                                 : eigen_array_cast<props>(rows);
    }
};

template <>
struct type_caster<Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>> : rows_caster<2> {};
template <>
struct type_caster<Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> : rows_caster<3> {};
template <>
struct type_caster<Eigen::Matrix<double, Eigen::Dynamic, 8, Eigen::RowMajor>> : rows_caster<8> {};

/// Converts a place or a direction, (x, y).
template <>
struct type_caster<Eigen::Vector2d> {
    PYBIND11_TYPE_CASTER(Eigen::Vector2d, const_name("tuple[float, float]"));

    bool load(handle source, bool convert) {
        make_caster<std::array<double, 2>> list;
        if (!list.load(source, convert)) return false;
        const auto& read = cast_op<std::array<double, 2>&>(list);
        value = {read[0], read[1]};
        return true;
    }
    static handle cast(const Eigen::Vector2d& place, return_value_policy, handle) {
        return eigen_array_cast<EigenProps<Eigen::Vector2d>>(place);
    }
};

}  // namespace pybind11::detail
