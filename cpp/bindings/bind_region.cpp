#include "bindings.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/excess_turning.hpp"
#include "brushsvg/region.hpp"

void bind_region(py::module_& m) {
    using namespace brushsvg;
    const auto unlocked = py::call_guard<Unlocked>();
    m.def("unite", &unite, py::arg("rings"), unlocked,
          "Union of shapes: counter-clockwise rings fill, the clockwise rings behind one are its holes. Error where "
          "clockwise ones outweigh.");
    m.def(
        "fill",
        [](const Rings& outlines, const std::string& rule) {
            if (rule != "nonzero" && rule != "evenodd")
                throw Error("choice-unknown", "the fill rule is nonzero or evenodd, not \"" + rule + "\"");
            return fill(outlines, rule == "nonzero" ? FillRule::nonzero : FillRule::evenodd);
        },
        py::arg("outlines"), py::arg("rule") = "nonzero", unlocked,
        "Rings of the shape that closed outlines fill; they may cross and turn either way.");
    m.def("intersect", &intersect, py::arg("rings_a"), py::arg("rings_b"), unlocked,
          "What two shapes have in common, each given as for unite.");
    m.def("convex_hull", &convex_hull, py::arg("points"), "Convex hull of points (n, 2), counter-clockwise.");
    m.def("clearance", &clearance, py::arg("rings"), py::arg("points"), unlocked,
          "Distance [mm] of points (n, 2) from the outline, on whichever side of it.");
    m.def("first_crossings", &first_crossings, py::arg("rings"), py::arg("places"), py::arg("ways"), unlocked,
          "How far ahead [mm] of each place (n, 2), along the unit vector in its row of ways (n, 2), the outline of "
          "rings "
          "is first crossed; infinite where it is not. Error where there are not as many ways as places.");
    m.def("area", &area, py::arg("rings"),
          "Area [mm^2], clockwise rings, which are holes, taken off: negative where they outweigh.");
    m.def("excess_turning", &excess_turning, py::arg("mark"), py::arg("wanted"),
          "How much more the outlines of a mark turn than those of the target, in full turns; each as a "
          "polygon within 0.1 mm.");
    m.def("thorns", &thorns, py::arg("mark"), py::arg("wanted"),
          "How many corners of a mark's outlines beyond 20 degrees stick out of the target by more than 0.3 mm; "
          "each "
          "outline as a polygon within 0.05 mm, target given as for unite.");
    m.def("overlap", &overlap, py::arg("rings_a"), py::arg("rings_b"), unlocked,
          "Area of the intersection over area of the union, each given as for unite; 1 when both are empty.");
}
