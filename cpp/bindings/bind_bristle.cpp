#include "bindings.hpp"
#include "brushsvg/bristle.hpp"
#include "brushsvg/error.hpp"

void bind_bristle(py::module_& m) {
    using namespace brushsvg;
    m.def(
        "bristle_coefficients",
        [](const std::string& end) {
            if (end != "third_derivative" && end != "shear_free")
                throw Error("choice-unknown",
                            "the sliding end is \"third_derivative\" or \"shear_free\", not \"" + end + "\"");
            return bristle_coefficients(end == "shear_free" ? SlidingEnd::shear_free : SlidingEnd::third_derivative);
        },
        py::arg("sliding_end"),
        "c1 to c4 of w = c1 + c2 z + (c3 + c4 z) e^z + z^2/2, Lemma 1 with EI = load = exp(1 - z).");
    m.def(
        "bristle_deflection",
        [](const Eigen::Vector4d& coefficients, const Numbers& z) {
            return py::vectorize([&](double at) { return bristle_deflection(coefficients, at); })(z.values);
        },
        py::arg("coefficients"), py::arg("z"), "w(z) for these coefficients, article (3) as it should read.");
}
