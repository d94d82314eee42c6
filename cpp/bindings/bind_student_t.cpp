
#include "bindings.hpp"
#include "brushsvg/student_t.hpp"

void bind_student_t(py::module_& m) {
    m.def("deviations_of_95", &brushsvg::deviations_of_95, py::arg("degrees_of_freedom") = py::none(),
          "Half of a 95 % interval in standard deviations: Student's t, or normal where no degrees of freedom are "
          "known.");
    m.def(
        "as_normal",
        [](const Numbers& t, double degrees_of_freedom) {
            return py::vectorize([=](double each) { return brushsvg::as_normal(each, degrees_of_freedom); })(t.values);
        },
        py::arg("t"), py::arg("degrees_of_freedom"),
        "Size of a normal value as unlikely as t with so many degrees of freedom; of each t, where there are many.");
}
