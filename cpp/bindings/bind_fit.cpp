#include "bindings.hpp"
#include "law_fit.hpp"

void bind_fit(py::module_& m) {
    using namespace brushsvg::fit;
    const auto unlocked = py::call_guard<py::gil_scoped_release>();
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
}
