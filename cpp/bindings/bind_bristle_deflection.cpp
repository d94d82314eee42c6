#include "bindings.hpp"
#include "brushsvg/bristle_deflection.hpp"
#include "brushsvg/error.hpp"

void bind_bristle_deflection(py::module_& m) {
    using namespace brushsvg;
    m.def(
        "bristle_coefficients",
        [](const std::string& end) {
            if (end != "third_derivative" && end != "shear_free")
                throw Error("choice-unknown",
                            "the sliding end must be \"third_derivative\" or \"shear_free\", not \"" + end + "\"");
            return bristle_coefficients(end == "shear_free" ? SlidingEnd::shear_free : SlidingEnd::third_derivative);
        },
        py::arg("sliding_end"),
        R"(Return the coefficients c1 to c4 of a bristle's deflection, by Lemma 1.

The deflection is w(z) = c1 + c2 z + (c3 + c4 z) e^z + z^2/2, for EI = load = exp(1 - z).

sliding_end: "third_derivative" or "shear_free".)");
    m.def(
        "bristle_deflection",
        [](const Eigen::Vector4d& coefficients, const Numbers& z) {
            return py::vectorize([&](double at) { return bristle_deflection(coefficients, at); })(z.values);
        },
        py::arg("coefficients"), py::arg("z"), R"(Return the deflection w(z) of a bristle with these coefficients.

The equation is article (3), corrected. z may be an array.)");
}
