#include "bindings.hpp"
#include "brushsvg/settings.hpp"

namespace {

/// Return the settings that are set, under their names in Python.
py::dict set_fields(const brushsvg::Settings& settings) {
    py::dict out;
    const auto add_field = [&out](const char* name, const auto& value) {
        if (value) out[name] = *value;
    };
    each_setting(settings, add_field);
    add_field("extra", settings.extra == "{}" ? std::nullopt : std::optional(settings.extra));
    return out;
}

}  // namespace

void bind_settings(py::module_& m) {
    using brushsvg::Settings;
    py::class_<Settings> type(m, "Settings",
                              R"(The brushsvg settings of an element in a drawing; None if a setting is absent.

brush, end, order, passes, reload, skip, speed_mm_s, start, width_mm: see docs/reference/drawings.md.
kind: kind of a stroke on the calibration chart.
extra: unknown keys of a plan.json, as JSON.

A Settings cannot be changed; use replaced() to make a new one.)");
    type.def(py::init([](std::optional<std::string> brush, std::optional<std::string> end,
                         std::optional<std::string> kind, std::optional<int> order, std::optional<int> passes,
                         std::optional<bool> reload, std::optional<bool> skip, std::optional<double> speed_mm_s,
                         std::optional<std::string> start, std::optional<double> width_mm, std::string extra) {
                 return Settings{
                     std::move(brush), std::move(end),   std::move(kind), order,           passes, reload, skip,
                     speed_mm_s,       std::move(start), width_mm,        std::move(extra)};
             }),
             py::kw_only(), py::arg("brush") = py::none(), py::arg("end") = py::none(), py::arg("kind") = py::none(),
             py::arg("order") = py::none(), py::arg("passes") = py::none(), py::arg("reload") = py::none(),
             py::arg("skip") = py::none(), py::arg("speed_mm_s") = py::none(), py::arg("start") = py::none(),
             py::arg("width_mm") = py::none(), py::arg("extra") = "{}")
        .def_readonly("brush", &Settings::brush)
        .def_readonly("end", &Settings::end)
        .def_readonly("kind", &Settings::kind)
        .def_readonly("order", &Settings::order)
        .def_readonly("passes", &Settings::passes)
        .def_readonly("reload", &Settings::reload)
        .def_readonly("skip", &Settings::skip)
        .def_readonly("speed_mm_s", &Settings::speed_mm_s)
        .def_readonly("start", &Settings::start)
        .def_readonly("width_mm", &Settings::width_mm)
        .def_readonly("extra", &Settings::extra)
        .def(
            "replaced",
            [](const Settings& self, const py::kwargs& fields) {
                py::dict all = set_fields(self);
                all.attr("update")(fields);
                return py::type::of<Settings>()(**all).cast<Settings>();
            },
            "Return a copy in which the given fields have these values.")
        .def("__repr__", [](const Settings& self) {
            py::list parts;
            for (const auto& [name, value] : set_fields(self)) parts.append(py::str("{}={!r}").format(name, value));
            return py::str("Settings({})").format(py::str(", ").attr("join")(parts));
        });
    add_fixed_value_semantics(type);
}
