#include "bindings.hpp"
#include "brushsvg/paint.hpp"

void bind_paint(py::module_& m) {
    using brushsvg::Paint;
    py::class_<Paint> type(
        m, "Paint",
        R"(What the way [mm] painted since the last dip does: marks are exp(-narrows_per_m way / 1000) times as wide.

Paint(0.4).width_share(500) is exp(-0.2). The way is the TCP's on the paper. lasts_mm: the way after which hairs run dry,
None where nobody knows. calibrated_mm: (least, greatest) way that was measured; source: where it comes from, in words;
assumed: nobody measured it. covariance: of narrows_per_m, and lasts_mm where it is known, or empty, by
degrees_of_freedom values to spare. extra: unknown keys of its file, as JSON. A value: it is not changed, but another
one made.)");
    type.def(py::init([](double narrows_per_m, std::optional<double> lasts_mm,
                         std::optional<std::array<double, 2>> calibrated_mm, std::string source, bool assumed,
                         std::vector<std::vector<double>> covariance, std::optional<double> degrees_of_freedom,
                         std::string extra) {
                 Paint p;
                 p.narrows_per_m = narrows_per_m;
                 p.lasts_mm = lasts_mm;
                 p.calibrated_mm = calibrated_mm;
                 p.source = std::move(source);
                 p.assumed = assumed;
                 p.covariance = std::move(covariance);
                 p.degrees_of_freedom = degrees_of_freedom;
                 p.extra = std::move(extra);
                 return p;
             }),
             py::arg("narrows_per_m") = 0.0, py::kw_only(), py::arg("lasts_mm") = py::none(),
             py::arg("calibrated_mm") = py::none(), py::arg("source") = "", py::arg("assumed") = false,
             py::arg("covariance") = std::vector<std::vector<double>>{}, py::arg("degrees_of_freedom") = py::none(),
             py::arg("extra") = "{}")
        .def_readonly("narrows_per_m", &Paint::narrows_per_m)
        .def_readonly("lasts_mm", &Paint::lasts_mm)
        .def_property_readonly("calibrated_mm", frozen_copy(&Paint::calibrated_mm))
        .def_readonly("source", &Paint::source)
        .def_readonly("assumed", &Paint::assumed)
        .def_property_readonly("covariance", frozen_copy(&Paint::covariance))
        .def_readonly("degrees_of_freedom", &Paint::degrees_of_freedom)
        .def_readonly("extra", &Paint::extra)
        .def("width_share", &Paint::width_share, py::arg("way_mm"),
             "Width over that of a freshly dipped brush, after a way [mm].")
        .def(
            "way_to_share_mm", &Paint::way_to_share_mm, py::arg("share"),
            "The way [mm] after which the width is that share of a freshly dipped brush's; infinite where it never is.")
        .def("__repr__", [](const Paint& p) {
            std::string out = "<Paint: width exp(-" + in_digits(p.narrows_per_m) + " way / 1000 mm)";
            if (p.lasts_mm) out += ", hairs dry after " + in_digits(*p.lasts_mm) + " mm";
            return out + (p.assumed ? ", assumed>" : ">");
        });
    as_fixed_value(type);
}
