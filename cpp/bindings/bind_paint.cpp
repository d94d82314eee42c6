#include "bindings.hpp"
#include "brushsvg/paint.hpp"

void bind_paint(py::module_& m) {
    using brushsvg::Paint;
    py::class_<Paint> type(m, "Paint",
                           R"(The law by which marks narrow with the path painted since the last dip.

After a path of s mm, marks are exp(-narrows_per_m s / 1000) times as wide. Paint(0.4).width_share(500) is exp(-0.2).
The path is the path of the TCP on the paper.

lasts_mm: path after which hairs run dry; None if this is not known.
calibrated_mm: (least, greatest) path that was measured.
source: where the law comes from, in words.
assumed: True if the law was not measured.
covariance: of narrows_per_m, and of lasts_mm if it is known; may be empty.
degrees_of_freedom: number of spare values from which the scatter is known.
extra: unknown keys of the file, as JSON.

A Paint cannot be changed; make a new one instead.)");
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
             R"(Return the share of the width that is left after a path [mm].

The share is of a freshly dipped brush's width.)")
        .def("path_to_share_mm", &Paint::path_to_share_mm, py::arg("share"),
             R"(Return the path [mm] after which the width has fallen to a share.

The share is of a freshly dipped brush's width. The path is infinite if the width never falls so far.)")
        .def("__repr__", [](const Paint& p) {
            std::string out = "<Paint: width exp(-" + format_number(p.narrows_per_m) + " way / 1000 mm)";
            if (p.lasts_mm) out += ", hairs dry after " + format_number(*p.lasts_mm) + " mm";
            return out + (p.assumed ? ", assumed>" : ">");
        });
    add_fixed_value_semantics(type);
}
