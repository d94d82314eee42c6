#include "bindings.hpp"
#include "brushsvg/brush.hpp"

namespace {

/// Return a getter of a law of a brush. The law is a copy that is defined only at the brush's depths.
auto law_of(brushsvg::Profile brushsvg::Brush::* law) {
    return [law](const brushsvg::Brush& brush) {
        brushsvg::Profile copy = brush.*law;
        copy.depth_range_mm = brush.depth_range_mm;
        return copy;
    };
}

}  // namespace

void bind_brush(py::module_& m) {
    using brushsvg::Brush;
    py::class_<Brush> type(
        m, "Brush",
        R"(Four laws against depth and the footprints; all lengths in mm, depths in mm from first contact down.

lag, tip_gap, tip_to_widest, half_width: the laws, each a Profile that refuses depths at which the brush cannot be; footprints: a FootprintTable. Outlines rule what is
painted, laws where the tool goes: they may differ by 0.5 mm. Begin with Brush() and set all of them, name and
depth_range_mm, or with the copy of a known one. Set each as a whole: it is a value that cannot be changed.
save_brush, simulate, compensate and convert refuse what no brush can be.)");
    type.def(py::init<>())
        .def_readwrite("name", &Brush::name, "What plans and messages call it.")
        .def_readwrite("kind", &Brush::kind,
                       "round, liner (a round brush of long bristles), pen, or empty: round. Another one is refused.")
        .def_property(
            "depth_range_mm", frozen_copy(&Brush::depth_range_mm),
            [](Brush& b, std::array<double, 2> value) { b.depth_range_mm = std::move(value); },
            "(least, greatest) depth [mm] to which it may be pressed.")
        .def_property(
            "lag", law_of(&Brush::lag), [](Brush& b, brushsvg::Profile value) { b.lag = std::move(value); },
            "r(d): how far the centre of friction trails the TCP, bristles taut. A Profile, 0 everywhere for a pen.")
        .def_property(
            "tip_gap", law_of(&Brush::tip_gap), [](Brush& b, brushsvg::Profile value) { b.tip_gap = std::move(value); },
            "b(d): from the tip of the footprint to the centre of friction. A Profile.")
        .def_property(
            "tip_to_widest", law_of(&Brush::tip_to_widest),
            [](Brush& b, brushsvg::Profile value) { b.tip_to_widest = std::move(value); },
            "x_w(d): from the tip of the footprint to its widest section. A Profile.")
        .def_property(
            "half_width", law_of(&Brush::half_width),
            [](Brush& b, brushsvg::Profile value) { b.half_width = std::move(value); },
            "h(d): half of the footprint's greatest width. A Profile that never falls.")
        .def_property(
            "footprints", [](const Brush& b) -> const brushsvg::FootprintTable& { return b.footprints; },
            replace(&Brush::footprints), "Outlines by depth: a FootprintTable.")
        .def_property(
            "covariance", frozen_copy(&Brush::covariance),
            [](Brush& b, std::vector<std::vector<double>> value) { b.covariance = std::move(value); },
            "Of all coefficients, in the order of the four laws, or empty.")
        .def_property(
            "paint", [](const Brush& b) { return b.paint; },
            [](Brush& b, std::optional<brushsvg::Paint> value) { b.paint = std::move(value); },
            "How its mark narrows from dip to dip: a Paint, or None.")
        .def_readwrite("max_speed_mm_s", &Brush::max_speed_mm_s,
                       "The greatest speed [mm/s] at which the model holds; it has no inertia.")
        .def_readwrite("paint_depth_mm", &Brush::paint_depth_mm,
                       "Depth [mm] to paint at where half_width does not depend on depth.")
        .def_readwrite("sha256", &Brush::sha256, "Of the bytes of the file it was read from, or empty.")
        .def_readwrite("extra", &Brush::extra,
                       "JSON object of the keys of its file that are not known, written back as read.")
        .def("is_rigid", &Brush::is_rigid, "Whether the lag is 0 everywhere: a pen.")
        .def("width_follows_depth", &Brush::width_follows_depth, "Whether half_width depends on depth.")
        .def("half_width_range_mm", &Brush::half_width_range_mm,
             "(least, greatest) half width [mm] within depth_range_mm.")
        .def("depth_for_half_width", &Brush::depth_for_half_width, py::arg("half_width_mm"), py::arg("where") = "",
             "Depth [mm] that paints a half width [mm]; Error with the reachable range when there is none.")
        .def(
            "lever_to_widest",
            [](const Brush& b, double depth_mm) {
                return law_of(&Brush::tip_to_widest)(b).at(depth_mm) - law_of(&Brush::tip_gap)(b).at(depth_mm);
            },
            py::arg("depth_mm"), "e(d) = x_w(d) - b(d) [mm], signed.")
        .def("__repr__", [](const Brush& b) {
            const auto& [least, greatest] = b.depth_range_mm;
            const auto span = [](double from, double to) {
                return from == to ? in_digits(from) : in_digits(from) + " to " + in_digits(to);
            };
            return "<Brush " + quoted(b.name) + ": " + (b.kind.empty() ? "" : b.kind + ", ") + "depth " +
                   span(least, greatest) + " mm, lag " + span(b.lag(least), b.lag(greatest)) + " mm, lines " +
                   span(2.0 * b.half_width(least), 2.0 * b.half_width(greatest)) + " mm wide>";
        });
    as_value(type);
    m.def(
        "check", [](const Brush& brush) { brushsvg::check(brush); }, py::arg("brush"),
        "Error when the brush would lead a robot astray (negative lag, laws and outlines that disagree, ...).");
    m.def(
        "remarks",
        [](const Brush& brush) {
            py::list out;
            for (const auto& each : brushsvg::remarks(brush)) out.append(notice(each, each.sentence));
            return out;
        },
        py::arg("brush"), "What is odd about an admissible brush: notices about its laws.");
}
