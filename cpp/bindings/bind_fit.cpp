#include "angles.hpp"
#include "bindings.hpp"
#include "law_fit.hpp"

void bind_fit(py::module_& m) {
    using namespace brushsvg::fit;
    const auto unlocked = py::call_guard<Unlocked>();
    py::enum_<Norm>(m, "Norm").value("squares", Norm::squares).value("absolute", Norm::absolute);
    py::class_<LawShape>(m, "LawShape", "What is asked of a fitted law; positive and rising hold on range_mm.")
        .def(py::init([](std::array<double, 2> range_mm, int degree, bool through_zero, bool positive, bool rising,
                         double floor, Norm norm, double smoothing) {
                 return LawShape{range_mm, degree, through_zero, positive, rising, floor, norm, smoothing};
             }),
             py::arg("range_mm"), py::arg("degree"), py::kw_only(), py::arg("through_zero") = false,
             py::arg("positive") = false, py::arg("rising") = false,
             py::arg("floor") = -std::numeric_limits<double>::infinity(), py::arg("norm") = Norm::squares,
             py::arg("smoothing") = 0.0);
    py::class_<LawFit>(m, "LawFit", "A fitted law, how sure it is, and what it leaves.")
        .def_readonly("law", &LawFit::law)
        .def_readonly("covariance", &LawFit::covariance)
        .def_readonly("residual_mm", &LawFit::residual_mm)
        .def_readonly("r_squared", &LawFit::r_squared)
        .def_readonly("degrees_of_freedom", &LawFit::degrees_of_freedom)
        .def_readonly("held", &LawFit::held);
    m.def("fit_law", &fit_law, py::arg("depth_mm"), py::arg("value_mm"), py::arg("shape"), unlocked,
          "Law of a shape through measured values [mm] at depths [mm], by least squares or absolute residuals.");
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
        py::arg("lines") = Lines::plain,
        "Lag and tip gap [mm] from angles [rad] after distances s [mm] of a straight drag (article (19) to (23)).");
}
