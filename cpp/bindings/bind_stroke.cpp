#include "bindings.hpp"
#include "brushsvg/cubic_fit.hpp"
#include "brushsvg/stroke.hpp"
#include "brushsvg/target_mark.hpp"

void bind_stroke(py::module_& m) {
    using namespace brushsvg;
    py::class_<StrokeId> id(m, "StrokeId", R"(The origin of a stroke in a drawing.

element: id of the element.
part: number of the element's sub-path, 0 for the only one.
repeat: number of the repetition, if the stroke is painted several times.
lane: number of the pass that fills a shape wider than the brush.
load: number of the load of paint.
name: element/part#repeat~lane+load, without the parts that have their default. The name is never parsed.)");
    id.def(py::init<std::string, int, int, int, int>(), py::arg("element"), py::arg("part") = 0, py::arg("repeat") = 1,
           py::arg("lane") = 1, py::arg("load") = 1)
        .def_readonly("element", &StrokeId::element)
        .def_readonly("part", &StrokeId::part)
        .def_readonly("repeat", &StrokeId::repeat)
        .def_readonly("lane", &StrokeId::lane)
        .def_readonly("load", &StrokeId::load)
        .def_property_readonly("name", &StrokeId::name)
        .def("__repr__", [](const StrokeId& id) { return "<StrokeId " + quoted(id.name()) + ">"; });
    add_fixed_value_semantics(id);
    py::implicitly_convertible<std::string, StrokeId>();
    using Knots = std::vector<std::pair<double, double>>;
    const auto knots_of = [](const Stroke& s) {
        Knots out;
        for (const WidthKnot& k : s.half_width) out.emplace_back(k.at, k.half_width_mm);
        return out;
    };
    const auto set_knots = [](Stroke& s, const Knots& knots) {
        s.half_width.clear();
        for (const auto& [at, h] : knots) s.half_width.push_back({at, h});
    };
    py::class_<Stroke> type(m, "Stroke",
                            R"(A stroke: a middle line, with a width along it.

id: name of the stroke, made from origin. Set it to a name or to a StrokeId.
origin: a StrokeId.
middle_mm: cubics (n, 8) [mm].
half_width: half widths along the middle line [(fraction of arc length, mm)].
target_mm: rings of the target mark as drawn, or empty.
start_covered, end_covered: whether this end meets other strokes of the shape, whose paint covers the end.

Set middle_mm, half_width, target_mm and settings as a whole.)");
    type.def(py::init([set_knots](StrokeId id, const Cubics& middle_mm, bool closed, const Knots& half_width,
                                  std::string layer, std::string colour, Settings settings) {
                 Stroke s;
                 s.id = std::move(id);
                 s.middle_mm = middle_mm;
                 s.closed = closed;
                 set_knots(s, half_width);
                 s.layer = std::move(layer);
                 s.colour = std::move(colour);
                 s.settings = std::move(settings);
                 return s;
             }),
             py::arg("id") = "", py::arg("middle_mm") = Cubics(0, 8), py::arg("closed") = false,
             py::arg("half_width") = Knots{}, py::arg("layer") = "", py::arg("colour") = "",
             py::arg("settings") = Settings{})
        .def_property(
            "id", [](const Stroke& s) { return s.id.name(); }, [](Stroke& s, StrokeId id) { s.id = std::move(id); })
        .def_property_readonly("origin", [](const Stroke& s) { return s.id; })
        .def_property(
            "middle_mm", [](const Stroke& s) -> const Cubics& { return s.middle_mm; }, replace(&Stroke::middle_mm))
        .def_readwrite("closed", &Stroke::closed)
        .def_property(
            "half_width",
            [knots_of](const Stroke& s) {
                using Knot = py::typing::Tuple<py::float_, py::float_>;
                return as_typed<py::typing::Tuple<Knot, py::ellipsis>>(freeze(py::cast(knots_of(s))));
            },
            set_knots)
        .def_property("target_mm", frozen_copy(&Stroke::target_mm),
                      [](Stroke& s, Rings rings) { s.target_mm = std::move(rings); })
        .def_readwrite("layer", &Stroke::layer)
        .def_readwrite("colour", &Stroke::colour)
        .def_property(
            "settings", [](const Stroke& s) { return s.settings; },
            [](Stroke& s, Settings settings) { s.settings = std::move(settings); })
        .def_readwrite("start_covered", &Stroke::start_covered)
        .def_readwrite("end_covered", &Stroke::end_covered)
        .def_static(
            "from_points",
            [](const Ring& points_mm, const Numbers& width_mm, const std::string& name,
               std::optional<double> tolerance_mm) {
                const auto& widths = width_mm.values;
                const py::ssize_t n = points_mm.rows();
                if (widths.ndim() > 1)
                    throw Error("sizes-differ",
                                "the array of widths must have 1 dimension, not " + std::to_string(widths.ndim()) +
                                    ": use widths.ravel()",
                                name);
                if (widths.ndim() == 1 && widths.size() != n)
                    throw Error("sizes-differ",
                                "there are " + std::to_string(widths.size()) + " widths for " + std::to_string(n) +
                                    " points: give one width in mm, or one for each point",
                                name);
                const auto given = py::array_t < double, py::array::c_style | py::array::forcecast > (widths);
                WideLine line(n, 3);
                for (py::ssize_t i = 0; i < n; ++i)
                    line.row(i) << points_mm.row(i), 0.5 * given.data()[given.ndim() == 0 ? 0 : i];
                const ReleasedGil unlocked;
                return stroke_along(name, line, tolerance_mm);
            },
            py::arg("points_mm"), py::arg("width_mm"), py::arg("name") = "stroke1", py::kw_only(),
            py::arg("tolerance_mm") = py::none(),
            R"(Make a stroke through points, in painting direction.

The stroke is closed if the last point repeats the first one.

points_mm: (n, 2) [mm], y up.
width_mm: one width for all points, or (n,), one width at each point, linear in between.
tolerance_mm: None: straight lines from point to point. Otherwise cubics that pass each point within the tolerance. The
    cubics are smooth except at corners that no smooth line follows. Points too far apart for the tolerance are
    joined by lines.

Raises Error, naming the stroke, for fewer than two different points, or a width that is not positive. Also raises
Error for a number that is not finite or beyond 1e6 mm.)")
        .def(
            "replaced",
            [](const Stroke& s, const py::kwargs& fields) {
                py::object made = py::cast(Stroke(s));
                for (const auto& [name, value] : fields) py::setattr(made, name, value);
                return made.cast<Stroke>();
            },
            "Return a copy in which the given fields have these values.")
        .def("__repr__", [](const Stroke& s) {
            double length = 0.0;
            for (Eigen::Index i = 0; i < s.middle_mm.rows(); ++i) length += arc_length(s.middle_mm, i, 0.0, 1.0);
            std::string width = "no width";
            if (!s.half_width.empty()) {
                const auto [least, most] = std::minmax_element(
                    s.half_width.begin(), s.half_width.end(),
                    [](const WidthKnot& a, const WidthKnot& b) { return a.half_width_mm < b.half_width_mm; });
                width = format_number(2.0 * least->half_width_mm);
                if (least->half_width_mm != most->half_width_mm)
                    width += " to " + format_number(2.0 * most->half_width_mm);
                width += " mm wide";
            }
            return "<Stroke " + quoted(s.id.name()) + ": " + format_count(std::size_t(s.middle_mm.rows()), "cubic") +
                   ", " + format_number(length) + " mm long, " + width + (s.closed ? ", closed>" : ">");
        });
    add_value_semantics(type);
    m.def(
        "flatten",
        [](const Stroke& stroke, double tolerance_mm) {
            check(stroke);
            return flatten(stroke, tolerance_mm);
        },
        py::arg("stroke"), py::arg("tolerance_mm") = 0.005,
        "Return the middle line as points (n, 4): x, y, arc length, half width [mm].");
    m.def(
        "target_outline",
        [](const Stroke& stroke, double tolerance_mm) {
            check(stroke);
            return target_outline(stroke, tolerance_mm);
        },
        py::arg("stroke"), py::arg("tolerance_mm") = 0.005, py::call_guard<ReleasedGil>(),
        R"(Return the rings of the target mark.

The target mark is target_mm of the stroke, if given. Otherwise the target mark is the path with its width, round caps
and round joins.)");
}
