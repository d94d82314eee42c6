#include "bindings.hpp"
#include "brushsvg/brush.hpp"

namespace {

/// Return a getter of a law of a brush. The law is a copy that is defined only at the brush's depths.
auto law_getter(brushsvg::Profile brushsvg::Brush::* law) {
    return [law](const brushsvg::Brush& brush) {
        brushsvg::Profile copy = brush.*law;
        copy.depth_range_mm = brush.depth_range_mm;
        return copy;
    };
}

}  // namespace

void bind_brush(py::module_& m) {
    using brushsvg::Brush;
    py::class_<Brush> type(m, "Brush",
                           R"(A brush: four laws against depth, and the footprints.

All lengths are in mm. Depths are in mm and increase downwards from first contact.

lag, tip_gap, tip_to_widest, half_width: the laws. Each is a Profile that refuses depths that the brush cannot have.
footprints: a FootprintTable.

The outlines of the footprints determine what is painted, and the laws determine where the tool goes. Outlines and
laws may differ by 0.5 mm.

To make a brush, start with Brush() and set all laws, footprints, name and depth_range_mm. Or start with a copy of a
known brush. Set each law, and the footprints, as a whole: these values cannot be changed. save_brush, simulate,
compensate and convert refuse a brush that is not valid.)");
    type.def(py::init<>())
        .def_readwrite("name", &Brush::name, "Name of the brush in plans and messages.")
        .def_readwrite("kind", &Brush::kind,
                       R"(Kind of the brush: round, liner, pen, or empty, which means round.

A liner is a round brush with long bristles. Other kinds are refused.)")
        .def_property(
            "depth_range_mm", frozen_copy(&Brush::depth_range_mm),
            [](Brush& b, std::array<double, 2> value) { b.depth_range_mm = std::move(value); },
            "(least, greatest) depth [mm] to which the brush may be pressed.")
        .def_property(
            "lag", law_getter(&Brush::lag), [](Brush& b, brushsvg::Profile value) { b.lag = std::move(value); },
            R"(r(d): distance of the centre of friction behind the TCP, bristles taut.

A Profile, 0 at all depths for a pen.)")
        .def_property(
            "tip_gap", law_getter(&Brush::tip_gap),
            [](Brush& b, brushsvg::Profile value) { b.tip_gap = std::move(value); },
            R"(b(d): distance from the tip of the footprint to the centre of friction.

A Profile.)")
        .def_property(
            "tip_to_widest", law_getter(&Brush::tip_to_widest),
            [](Brush& b, brushsvg::Profile value) { b.tip_to_widest = std::move(value); },
            R"(x_w(d): distance from the tip of the footprint to its widest section.

A Profile.)")
        .def_property(
            "half_width", law_getter(&Brush::half_width),
            [](Brush& b, brushsvg::Profile value) { b.half_width = std::move(value); },
            "h(d): half of the footprint's greatest width. A Profile that never falls.")
        .def_property(
            "footprints", [](const Brush& b) -> const brushsvg::FootprintTable& { return b.footprints; },
            replace(&Brush::footprints), "Outlines of the contact patch by depth: a FootprintTable.")
        .def_property(
            "covariance", frozen_copy(&Brush::covariance),
            [](Brush& b, std::vector<std::vector<double>> value) { b.covariance = std::move(value); },
            "Covariance of all coefficients, in the order of the four laws; may be empty.")
        .def_property(
            "paint", [](const Brush& b) { return b.paint; },
            [](Brush& b, std::optional<brushsvg::Paint> value) { b.paint = std::move(value); },
            "How the mark narrows between two dips into paint: a Paint, or None.")
        .def_readwrite("max_speed_mm_s", &Brush::max_speed_mm_s,
                       "Greatest speed [mm/s] at which the model holds; the model has no inertia.")
        .def_readwrite("paint_depth_mm", &Brush::paint_depth_mm,
                       "Painting depth [mm] if half_width does not depend on depth.")
        .def_readwrite("sha256", &Brush::sha256,
                       "SHA-256 of the bytes of the file from which the brush was read, or empty.")
        .def_readwrite("extra", &Brush::extra,
                       "JSON object of the unknown keys of the brush's file, written back as read.")
        .def("is_rigid", &Brush::is_rigid, "Return whether the lag is 0 at all depths: a pen.")
        .def("width_follows_depth", &Brush::width_follows_depth, "Return whether half_width depends on depth.")
        .def("half_width_range_mm", &Brush::half_width_range_mm,
             "Return the (least, greatest) half width [mm] within depth_range_mm.")
        .def("depth_for_half_width", &Brush::depth_for_half_width, py::arg("half_width_mm"), py::arg("where") = "",
             R"(Return the depth [mm] that paints a half width [mm]. A brush of one width has one depth: paint_depth_mm.

where: the element that the error names.

Raises Error, with the reachable range, if no depth paints this half width.)")
        .def(
            "lever_to_widest",
            [](const Brush& b, double depth_mm) {
                return law_getter(&Brush::tip_to_widest)(b).at(depth_mm) - law_getter(&Brush::tip_gap)(b).at(depth_mm);
            },
            py::arg("depth_mm"), "Return e(d) = x_w(d) - b(d) [mm], signed.")
        .def("__repr__", [](const Brush& b) {
            const auto& [least, greatest] = b.depth_range_mm;
            const auto span = [](double from, double to) {
                return from == to ? format_number(from) : format_number(from) + " to " + format_number(to);
            };
            return "<Brush " + quoted(b.name) + ": " + (b.kind.empty() ? "" : b.kind + ", ") + "depth " +
                   span(least, greatest) + " mm, lag " + span(b.lag(least), b.lag(greatest)) + " mm, lines " +
                   span(2.0 * b.half_width(least), 2.0 * b.half_width(greatest)) + " mm wide>";
        });
    add_value_semantics(type);
    m.def(
        "check", [](const Brush& brush) { brushsvg::check(brush); }, py::arg("brush"),
        R"(Raise Error if the brush would make a robot go wrong.

Examples are a negative lag, or laws and outlines that disagree.)");
    m.def(
        "remarks",
        [](const Brush& brush) {
            py::list out;
            for (const auto& each : brushsvg::remarks(brush)) out.append(make_notice(each, each.sentence));
            return out;
        },
        py::arg("brush"), "Return notices about unusual laws of a brush that check() accepts.");
}
