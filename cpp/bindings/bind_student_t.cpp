
#include "bindings.hpp"
#include "brushsvg/student_t.hpp"

void bind_student_t(py::module_& m) {
    m.def("interval_factor_95", &brushsvg::interval_factor_95, py::arg("degrees_of_freedom") = py::none(),
          R"(Return half of a 95 % interval, in standard deviations.

The interval is of Student's t, or of the normal distribution if degrees_of_freedom is None.)");
    m.def(
        "normal_equivalent",
        [](const Numbers& t, double degrees_of_freedom) {
            return py::vectorize([=](double each) { return brushsvg::normal_equivalent(each, degrees_of_freedom); })(
                t.values);
        },
        py::arg("t"), py::arg("degrees_of_freedom"),
        R"(Return the size of a normal value that is as unlikely as Student's t.

t: a value, or an array of values.)");
}
