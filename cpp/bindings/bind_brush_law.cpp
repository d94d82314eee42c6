#include <pybind11/numpy.h>

#include "bindings.hpp"
#include "brushsvg/brush_law.hpp"

void bind_brush_law(py::module_& m) {
    using brushsvg::Profile;
    py::class_<Profile> type(m, "Profile",
                             R"(A law of a brush: one parameter [mm] against the press depth d [mm].

The value is max(floor + floor_slope d, c0 + c1 d + ...). Profile([3.1, 0.86])(2.0) is 3.1 + 0.86 * 2 mm. The depth may
be an array.

coefficients: c0, c1, ..., in ascending powers of d, at most 11.
floor, floor_slope: the lower limit of the value, linear in d.
calibrated_mm: (least, greatest) depth that was measured; None if this is not known.
source: where the law comes from, in words.
assumed: True if the law was not measured.
half_interval_95: half of the 95 % interval of each coefficient.
rmse_mm: root mean square error of the fit.
degrees_of_freedom: number of spare values from which the scatter is known.
extra: unknown keys of the file, as JSON.

A Profile cannot be changed; make a new one instead.)");
    type.def(py::init([](std::vector<double> coefficients, double floor, double floor_slope,
                         std::optional<std::array<double, 2>> calibrated_mm, std::string source, bool assumed,
                         std::vector<double> half_interval_95, std::optional<double> rmse_mm,
                         std::optional<double> degrees_of_freedom, std::string extra) {
                 Profile p;
                 p.coefficients = std::move(coefficients);
                 p.floor = floor;
                 p.floor_slope = floor_slope;
                 p.calibrated_mm = calibrated_mm;
                 p.source = std::move(source);
                 p.assumed = assumed;
                 p.half_interval_95 = std::move(half_interval_95);
                 p.rmse_mm = rmse_mm;
                 p.degrees_of_freedom = degrees_of_freedom;
                 p.extra = std::move(extra);
                 return p;
             }),
             py::arg("coefficients") = std::vector<double>{}, py::kw_only(),
             py::arg("floor") = -std::numeric_limits<double>::infinity(), py::arg("floor_slope") = 0.0,
             py::arg("calibrated_mm") = py::none(), py::arg("source") = "", py::arg("assumed") = false,
             py::arg("half_interval_95") = std::vector<double>{}, py::arg("rmse_mm") = py::none(),
             py::arg("degrees_of_freedom") = py::none(), py::arg("extra") = "{}")
        .def(
            "__call__",
            [](const Profile& p, const Numbers& depth_mm) {
                return py::vectorize([&p](double d) { return p.at(d); })(depth_mm.values);
            },
            py::arg("depth_mm"), R"(Return the value of the law at a depth [mm], or at an array of depths.

Raises Error for depths outside depth_range_mm.)")
        .def(
            "extrapolated",
            [](const Profile& p, const Numbers& depth_mm) {
                return py::vectorize([&p](double d) { return p(d); })(depth_mm.values);
            },
            py::arg("depth_mm"), R"(Return the value of the law at any depth [mm], or at an array of depths.

Beyond the measured depths, a polynomial soon becomes meaningless.)")
        .def_property_readonly("coefficients", frozen_copy(&Profile::coefficients))
        .def_readonly("floor", &Profile::floor)
        .def_readonly("floor_slope", &Profile::floor_slope)
        .def_property_readonly("calibrated_mm", frozen_copy(&Profile::calibrated_mm))
        .def_readonly("source", &Profile::source)
        .def_readonly("assumed", &Profile::assumed)
        .def_property_readonly("half_interval_95", frozen_copy(&Profile::half_interval_95))
        .def_readonly("rmse_mm", &Profile::rmse_mm)
        .def_readonly("degrees_of_freedom", &Profile::degrees_of_freedom)
        .def_readonly("extra", &Profile::extra)
        .def_property_readonly("depth_range_mm", frozen_copy(&Profile::depth_range_mm),
                               R"(Depths [mm] at which the law is defined; None: at any depth.

For a law of a Brush, this is depth_range_mm of the Brush.)")
        .def("__repr__", [](const Profile& p) {
            std::string out;
            for (std::size_t i = 0; i < p.coefficients.size(); ++i) {
                const double c = p.coefficients[i];
                if (c == 0.0) continue;
                out += out.empty() ? (c < 0.0 ? "-" : "") : c < 0.0 ? " - " : " + ";
                out += format_number(std::abs(c)) + (i == 0 ? "" : i == 1 ? " d" : " d^" + std::to_string(i));
            }
            if (out.empty()) out = "0";
            if (std::isfinite(p.floor))
                out = "max(" + format_number(p.floor) + " + " + format_number(p.floor_slope) + " d, " + out + ")";
            out = "<Profile " + out + " mm at depth d mm";
            if (p.calibrated_mm)
                out += ", measured at " + format_number((*p.calibrated_mm)[0]) + " to " +
                       format_number((*p.calibrated_mm)[1]) + " mm";
            return out + (p.assumed ? ", assumed>" : ">");
        });
    add_fixed_value_semantics(type);
}
