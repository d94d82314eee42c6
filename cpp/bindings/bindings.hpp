#pragma once

#include <pybind11/eval.h>

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "converters.hpp"
#include "value_type.hpp"

void bind_brush_law(py::module_& m);
void bind_paint(py::module_& m);
void bind_student_t(py::module_& m);
void bind_footprint(py::module_& m);
void bind_brush(py::module_& m);
void bind_settings(py::module_& m);
void bind_stroke(py::module_& m);
void bind_plan(py::module_& m);
void bind_marks(py::module_& m);
void bind_lag(py::module_& m);
void bind_bristle_deflection(py::module_& m);
void bind_simulate(py::module_& m);
void bind_region(py::module_& m);
void bind_medial_axis(py::module_& m);
void bind_cubic_fit(py::module_& m);
void bind_coverage(py::module_& m);
void bind_mark_overlap(py::module_& m);
void bind_stroke_score(py::module_& m);
void bind_compensate(py::module_& m);
void bind_stroke_search(py::module_& m);
void bind_paint_loads(py::module_& m);
void bind_simplify_pass(py::module_& m);
void bind_io(py::module_& m);
void bind_fit(py::module_& m);
void bind_mark_fit(py::module_& m);

/// Releases the interpreter's lock while the object lives, but still reacts to Ctrl-C.
///
/// The main thread checks for signals at checkpoints. Any thread can be stopped by PyThreadState_SetAsyncExc. Its
/// exception is raised only when a line of Python runs, so a line is evaluated every now and then.
class ReleasedGil {
 public:
    ReleasedGil()
        : cancel_([] {
              const py::gil_scoped_acquire locked;
              if (PyErr_CheckSignals() != 0) throw py::error_already_set();
              py::eval("None");
              return false;
          }) {}

 private:
    py::gil_scoped_release unlocked_;
    brushsvg::CancelWhen cancel_;
};

/// Freeze a copy: make lists tuples and arrays read-only.
///
/// Otherwise Python code could change the copy by mistake, and the change would be lost without a message.
inline py::object freeze(const py::object& copy) {
    if (py::isinstance<py::list>(copy) || py::isinstance<py::tuple>(copy)) {
        py::tuple out(py::len(copy));
        std::size_t k = 0;
        for (const py::handle one : copy) out[k++] = freeze(py::reinterpret_borrow<py::object>(one));
        return std::move(out);
    }
    if (py::isinstance<py::array>(copy)) copy.attr("setflags")(py::arg("write") = false);
    return copy;
}

/// The type of the result of frozen(), for type checkers.
template <class Value>
struct FrozenType {
    using type = Value;
};
template <>
struct FrozenType<double> {
    using type = py::float_;
};
template <>
struct FrozenType<int> {
    using type = py::int_;
};
template <>
struct FrozenType<std::string> {
    using type = py::str;
};
template <int Rows, int Columns, int Options>
struct FrozenType<Eigen::Matrix<double, Rows, Columns, Options>> {
    using type = py::array_t<double>;
};
template <class Value>
struct FrozenType<std::vector<Value>> {
    using type = py::typing::Tuple<typename FrozenType<Value>::type, py::ellipsis>;
};
template <class Value, std::size_t N>
struct FrozenType<std::array<Value, N>> {
    using type = py::typing::Tuple<typename FrozenType<Value>::type, py::ellipsis>;
};
template <class Value>
struct FrozenType<std::optional<Value>> {
    using type = py::typing::Optional<typename FrozenType<Value>::type>;
};

/// Return the same object, annotated with a type.
template <class Type>
Type as_typed(const py::object& value) {
    return py::reinterpret_borrow<Type>(value);
}

/// Return a getter that returns a frozen copy of a member.
template <class Owner, class Member>
auto frozen_copy(Member Owner::* member) {
    return [member](const Owner& owner) {
        return as_typed<typename FrozenType<Member>::type>(
            freeze(py::cast(owner.*member, py::return_value_policy::copy)));
    };
}

/// Return a getter for a vector's elements themselves, in a tuple.
///
/// Their fields can be set, but nothing can be added to the tuple.
template <class Owner, class Value>
auto parts(std::vector<Value> Owner::* member) {
    return [member](const py::object& owner) {
        using Parts = py::typing::Tuple<Value, py::ellipsis>;
        return as_typed<Parts>(
            py::tuple(py::cast(owner.cast<Owner&>().*member, py::return_value_policy::reference_internal, owner)));
    };
}

/// Return a setter for a member to which Python may hold references.
///
/// These references stay valid as long as the owner lives, and show the old value.
template <class Owner, class Value>
auto replace(Value Owner::* member) {
    return [member](const py::object& owner, Value value) {
        Value& now = owner.cast<Owner&>().*member;
        auto before = std::make_unique<Value>(std::exchange(now, std::move(value)));
        py::detail::keep_alive_impl(owner,
                                    py::capsule(before.release(), [](void* p) { delete static_cast<Value*>(p); }));
    };
}

/// Make a Python notice from a warning.
///
/// `about`: its subject. Only notices with the same subject can be alike.
inline py::object make_notice(const brushsvg::Warning& warning, const std::string& about = "") {
    return py::module_::import("brushsvg.errors")
        .attr("Notice")(warning.where, warning.sentence, py::arg("code") = warning.code, py::arg("about") = about);
}

/// Run `work(i)` for i in [0, n), in chunks, without the interpreter's lock.
///
/// `progress(done, n)`: called after each chunk, if given.
template <class Work>
void run_in_chunks(std::size_t n, std::size_t chunk, const py::object& progress, Work&& work) {
    for (std::size_t begin = 0; begin < n; begin += chunk) {
        {
            const ReleasedGil unlocked;
            for (std::size_t i = begin; i < std::min(n, begin + chunk); ++i) work(i);
        }
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (!progress.is_none()) progress(std::min(n, begin + chunk), n);
    }
}

/// Run `work(i)` for i in [0, n), in chunks, each chunk on all processors.
template <class Work>
void run_in_parallel_chunks(std::size_t n, std::size_t chunk, const py::object& progress, Work&& work) {
    const py::object in_strokes = progress.is_none() ? progress : py::cpp_function([&](std::size_t now, std::size_t) {
        progress(std::min(n, now * chunk), n);
    });
    run_in_chunks((n + chunk - 1) / chunk, 1, in_strokes,
                  [&](std::size_t k) { brushsvg::parallel_for(k * chunk, std::min(n, (k + 1) * chunk), work); });
}
