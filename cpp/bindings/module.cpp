// The module brushsvg._core. Each header has a bind_<stem>.cpp.
#include <cstdlib>

#include "bindings.hpp"
#include "brushsvg/error.hpp"

#if defined(BRUSHSVG_FIT) && __has_include(<glog/logging.h>)
#include <glog/logging.h>
#endif

/// Raise TypeError when an uninitialised value is read.
///
/// A value is uninitialised if only its __new__ was called, or if its constructor refused its arguments. A debugger may
/// show such a value; pybind11 would give it uninitialised memory.
static void refuse_uninitialised_values(const py::module_& m) {
    for (const auto& [name, what] : py::cast<py::dict>(m.attr("__dict__"))) {
        if (!py::isinstance<py::type>(what)) continue;
        if (auto* known = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(what.ptr())))
            known->operator_new = [](std::size_t) -> void* {
                throw py::type_error(
                    "this object is not initialised, because its constructor was not called or raised an exception");
            };
    }
}

PYBIND11_MODULE(_core, m) {
    m.doc() = R"(Simulation of a brush, its inverse, and the marks that it paints.

Lengths are in mm, angles in radians, coordinates in the paper frame.)";
    m.attr("__version__") = BRUSHSVG_VERSION;
    m.attr("MAX_ENTRIES") = kMaxEntries;

    py::register_local_exception_translator([](std::exception_ptr p) {
        try {
            if (p) std::rethrow_exception(p);
        } catch (const brushsvg::Error& e) {
            const py::object type = py::module_::import("brushsvg.errors").attr("Error");
            py::object range = py::none();
            if (e.range()) range = py::make_tuple((*e.range())[0], (*e.range())[1]);  // a tuple, as Error documents it
            const py::object error = type(e.what(), py::arg("where") = e.where(), py::arg("value") = e.value(),
                                          py::arg("range") = range, py::arg("code") = e.code());
            PyErr_SetObject(type.ptr(), error.ptr());
        }
    });

#ifdef GOOGLE_STRIP_LOG  // Ceres logs with glog, not with its miniglog; our own errors report failed searches
    if (!std::getenv("GLOG_minloglevel")) FLAGS_minloglevel = google::GLOG_ERROR;
#endif

    bind_brush_law(m);
    bind_paint(m);
    bind_student_t(m);
    bind_footprint(m);
    bind_brush(m);
    bind_settings(m);
    bind_stroke(m);
    bind_plan(m);
    bind_marks(m);
    bind_lag(m);
    bind_bristle_deflection(m);
    bind_simulate(m);
    bind_region(m);
    bind_medial_axis(m);
    bind_cubic_fit(m);
    bind_coverage(m);
    bind_mark_overlap(m);
    bind_stroke_score(m);
    bind_compensate(m);
    bind_stroke_search(m);
    bind_paint_loads(m);
    bind_simplify_pass(m);
    bind_io(m);
#ifdef BRUSHSVG_FIT
    bind_fit(m);
    bind_mark_fit(m);
#endif
    refuse_uninitialised_values(m);
}
