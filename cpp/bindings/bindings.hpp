#pragma once

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <utility>

#include "brushsvg/checkpoint.hpp"
#include "parallel.hpp"

namespace py = pybind11;

void bind_profile(py::module_& m);
void bind_footprint(py::module_& m);
void bind_brush(py::module_& m);
void bind_stroke(py::module_& m);
void bind_plan(py::module_& m);
void bind_marks(py::module_& m);
void bind_lag(py::module_& m);
void bind_bristle(py::module_& m);
void bind_simulate(py::module_& m);
void bind_region(py::module_& m);
void bind_medial_axis(py::module_& m);
void bind_curve_fit(py::module_& m);
void bind_coverage(py::module_& m);
void bind_overlay(py::module_& m);
void bind_verdict(py::module_& m);
void bind_compensate(py::module_& m);
void bind_interrupt(py::module_& m);
void bind_thin_out(py::module_& m);
void bind_io(py::module_& m);
void bind_fit(py::module_& m);
void bind_mark_fit(py::module_& m);

/// Without the interpreter's lock, while Ctrl-C is heard: the main thread asks at checkpoints.
class Unlocked {
 public:
    Unlocked()
        : listens_([] {
              const py::gil_scoped_acquire locked;
              if (PyErr_CheckSignals() != 0) throw py::error_already_set();
              return false;
          }) {}

 private:
    py::gil_scoped_release unlocked_;
    brushsvg::CancelWhen listens_;
};

/// Runs `work(i)` for i in [0, n) without the interpreter's lock, in chunks between which `progress(done, n)` is called
/// where one is given.
template <class Work>
void in_chunks(std::size_t n, std::size_t chunk, const py::object& progress, Work&& work) {
    for (std::size_t begin = 0; begin < n; begin += chunk) {
        {
            const Unlocked unlocked;
            for (std::size_t i = begin; i < std::min(n, begin + chunk); ++i) work(i);
        }
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (!progress.is_none()) progress(std::min(n, begin + chunk), n);
    }
}

/// The same, each chunk on all processors.
template <class Work>
void in_parallel_chunks(std::size_t n, std::size_t chunk, const py::object& progress, Work&& work) {
    const py::object in_strokes = progress.is_none() ? progress : py::cpp_function([&](std::size_t now, std::size_t) {
        progress(std::min(n, now * chunk), n);
    });
    in_chunks((n + chunk - 1) / chunk, 1, in_strokes,
              [&](std::size_t k) { brushsvg::on_all_processors(k * chunk, std::min(n, (k + 1) * chunk), work); });
}
