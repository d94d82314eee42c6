#include "angles.hpp"
#include "bindings.hpp"
#include "law_fit.hpp"

template <>
inline constexpr auto members<brushsvg::fit::LawShape> = std::tuple(
    &brushsvg::fit::LawShape::range_mm, &brushsvg::fit::LawShape::degree, &brushsvg::fit::LawShape::through_zero,
    &brushsvg::fit::LawShape::positive, &brushsvg::fit::LawShape::rising, &brushsvg::fit::LawShape::floor,
    &brushsvg::fit::LawShape::norm, &brushsvg::fit::LawShape::smoothing);

template <>
inline constexpr auto members<brushsvg::fit::LawFit> = std::tuple(
    &brushsvg::fit::LawFit::law, &brushsvg::fit::LawFit::covariance, &brushsvg::fit::LawFit::residual_mm,
    &brushsvg::fit::LawFit::r_squared, &brushsvg::fit::LawFit::degrees_of_freedom, &brushsvg::fit::LawFit::held);

void bind_fit(py::module_& m) {
    using namespace brushsvg::fit;
    const auto unlocked = py::call_guard<ReleasedGil>();
    py::enum_<Norm>(m, "Norm").value("squares", Norm::squares).value("absolute", Norm::absolute);
    py::class_<LawShape> law_shape(m, "LawShape", R"(Constraints on a law that is fitted.

positive and rising hold at all depths of range_mm.)");
    law_shape
        .def(py::init([](std::array<double, 2> range_mm, int degree, bool through_zero, bool positive, bool rising,
                         double floor, Norm norm, double smoothing) {
                 return LawShape{range_mm, degree, through_zero, positive, rising, floor, norm, smoothing};
             }),
             py::arg("range_mm"), py::arg("degree"), py::kw_only(), py::arg("through_zero") = false,
             py::arg("positive") = false, py::arg("rising") = false,
             py::arg("floor") = -std::numeric_limits<double>::infinity(),
             py::arg_v("norm", Norm::squares, "Norm.squares"), py::arg("smoothing") = 0.0)
        .def("__repr__", [](const LawShape& v) {
            return "<LawShape of degree " + std::to_string(v.degree) + " at " + format_number(v.range_mm[0]) + " to " +
                   format_number(v.range_mm[1]) + " mm>";
        });
    add_fixed_value_semantics(law_shape);
    py::class_<LawFit> law_fit(m, "LawFit", "A fitted law, with its uncertainty and its residuals.");
    law_fit
        .def(py::init([](const brushsvg::Profile& law, std::vector<std::vector<double>> covariance,
                         std::vector<double> residual_mm, double r_squared, double degrees_of_freedom, bool held) {
                 return LawFit{law, std::move(covariance), std::move(residual_mm), r_squared, degrees_of_freedom, held};
             }),
             py::kw_only(), py::arg("law"), py::arg("covariance"), py::arg("residual_mm"), py::arg("r_squared"),
             py::arg("degrees_of_freedom"), py::arg("held"))
        .def_property_readonly("law", [](const LawFit& f) { return f.law; })
        .def_property_readonly("covariance", frozen_copy(&LawFit::covariance))
        .def_property_readonly("residual_mm", frozen_copy(&LawFit::residual_mm))
        .def_readonly("r_squared", &LawFit::r_squared)
        .def_readonly("degrees_of_freedom", &LawFit::degrees_of_freedom)
        .def_readonly("held", &LawFit::held)
        .def("__repr__", [](const LawFit& v) {
            return "<LawFit: " + repr_of(v.law) + ", R^2 " + format_number(v.r_squared) + ", " +
                   format_number(v.degrees_of_freedom) + " degrees of freedom>";
        });
    add_fixed_value_semantics(law_fit);
    m.def("fit_law", &fit_law, py::arg("depth_mm"), py::arg("value_mm"), py::arg("shape"),
          py::arg("scatter") = std::vector<double>{}, unlocked,
          R"(Fit a law to values [mm] measured at depths [mm].

The fit minimises squares or absolute residuals.

shape: a LawShape, the constraints on the law.
scatter: scatter of each value, up to a common factor. Empty: all values scatter alike.)");
    py::enum_<Lines>(m, "Lines").value("plain", Lines::plain).value("total", Lines::total);
    m.def(
        "from_angles",
        [](double alpha0, std::vector<double> s_mm, std::vector<double> alpha, std::vector<double> beta, Lines lines) {
            const FromAngles out = from_angles({alpha0, std::move(s_mm), std::move(alpha), std::move(beta)}, lines);
            py::dict d;
            d["lag_mm"] = out.lag_mm;
            d["lag_rmse_mm"] = out.lag_rmse_mm;
            d["tip_gap_mm"] = out.tip_gap_mm;
            d["tip_gap_rmse_mm"] = out.tip_gap_rmse_mm;
            d["left_out"] = out.left_out;
            return d;
        },
        py::arg("alpha0"), py::arg("s_mm"), py::arg("alpha"), py::arg("beta") = std::vector<double>{},
        py::arg_v("lines", Lines::plain, "Lines.plain"),
        R"(Compute lag and tip gap [mm] from the angles of a straight drag.

The equations are article (19) to (23).

alpha0, alpha, beta: angles [rad].
s_mm: distances of the drag after which alpha and beta were measured.)");
}
