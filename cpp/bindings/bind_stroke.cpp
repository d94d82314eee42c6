#include "bindings.hpp"
#include "brushsvg/stroke.hpp"
#include "brushsvg/wanted.hpp"

void bind_stroke(py::module_& m) {
    using namespace brushsvg;
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
    py::class_<Stroke>(m, "Stroke",
                       "A middle line of cubics (n, 8) [mm] with half widths [(fraction of arc length, mm)].")
        .def(py::init([set_knots](std::string id, const Cubics& middle_mm, bool closed, const Knots& half_width,
                                  std::string layer, std::string colour, std::string settings) {
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
             py::arg("half_width") = Knots{}, py::arg("layer") = "", py::arg("colour") = "", py::arg("settings") = "{}")
        .def_readwrite("id", &Stroke::id)
        .def_property(
            "middle_mm", [](const Stroke& s) { return s.middle_mm; },
            [](Stroke& s, const Cubics& middle) { s.middle_mm = middle; })
        .def_readwrite("closed", &Stroke::closed)
        .def_property("half_width", knots_of, set_knots)
        .def_readwrite("wanted_mm", &Stroke::wanted_mm)
        .def_readwrite("layer", &Stroke::layer)
        .def_readwrite("colour", &Stroke::colour)
        .def_readwrite("settings", &Stroke::settings);
    m.def(
        "flatten",
        [](const Stroke& stroke, double tolerance_mm) {
            check(stroke);
            return flatten(stroke, tolerance_mm);
        },
        py::arg("stroke"), py::arg("tolerance_mm") = 0.005,
        "Middle line as (n, 4): x, y, arc length, half width [mm].");
    m.def("wanted_pieces", &wanted_pieces, py::arg("stroke"), py::arg("tolerance_mm") = 0.005,
          py::call_guard<Unlocked>(),
          "Convex rings whose union is the path with its width and round caps; no wanted_mm is looked at.");
    m.def(
        "wanted_outline",
        [](const Stroke& stroke, double tolerance_mm) {
            check(stroke);
            return wanted_outline(stroke, tolerance_mm);
        },
        py::arg("stroke"), py::arg("tolerance_mm") = 0.005, py::call_guard<Unlocked>(),
        "Rings of the wanted mark: the path with its width, round caps and round joins.");
}
