#include <pybind11/numpy.h>

#include "bindings.hpp"
#include "brushsvg/profile.hpp"

void bind_profile(py::module_& m) {
    using brushsvg::Profile;
    py::class_<Profile>(
        m, "Profile", "One brush parameter [mm] against press depth [mm]: max(floor + floor_slope d, c0 + c1 d + ...).")
        .def(py::init([](std::vector<double> coefficients, double floor, double floor_slope,
                         std::optional<std::array<double, 2>> calibrated_mm, std::string source, bool assumed,
                         std::vector<double> half_interval_95, std::optional<double> rmse_mm) {
                 Profile p;
                 p.coefficients = std::move(coefficients);
                 p.floor = floor;
                 p.floor_slope = floor_slope;
                 p.calibrated_mm = calibrated_mm;
                 p.source = std::move(source);
                 p.assumed = assumed;
                 p.half_interval_95 = std::move(half_interval_95);
                 p.rmse_mm = rmse_mm;
                 return p;
             }),
             py::arg("coefficients") = std::vector<double>{}, py::kw_only(),
             py::arg("floor") = -std::numeric_limits<double>::infinity(), py::arg("floor_slope") = 0.0,
             py::arg("calibrated_mm") = py::none(), py::arg("source") = "", py::arg("assumed") = false,
             py::arg("half_interval_95") = std::vector<double>{}, py::arg("rmse_mm") = py::none())
        .def("__call__", py::vectorize([](const Profile* p, double depth_mm) { return (*p)(depth_mm); }),
             py::arg("depth_mm"))
        .def_readwrite("coefficients", &Profile::coefficients)
        .def_readwrite("floor", &Profile::floor)
        .def_readwrite("floor_slope", &Profile::floor_slope)
        .def_readwrite("calibrated_mm", &Profile::calibrated_mm)
        .def_readwrite("source", &Profile::source)
        .def_readwrite("assumed", &Profile::assumed)
        .def_readwrite("half_interval_95", &Profile::half_interval_95)
        .def_readwrite("rmse_mm", &Profile::rmse_mm)
        .def_readwrite("extra", &Profile::extra);
}
