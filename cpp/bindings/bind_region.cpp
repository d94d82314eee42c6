#include "bindings.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/excess_turning.hpp"
#include "brushsvg/region.hpp"

void bind_region(py::module_& m) {
    using namespace brushsvg;
    const auto unlocked = py::call_guard<ReleasedGil>();
    m.def("unite", &unite, py::arg("rings"), unlocked,
          R"(Return the union of shapes.

Each counter-clockwise ring is filled. The clockwise rings after it are its holes.

Raises Error if the clockwise rings outweigh the others.)");
    m.def(
        "fill",
        [](const Rings& outlines, const std::string& rule) {
            if (rule != "nonzero" && rule != "evenodd")
                throw Error("choice-unknown", "the fill rule must be nonzero or evenodd, not \"" + rule + "\"");
            return fill(outlines, rule == "nonzero" ? FillRule::nonzero : FillRule::evenodd);
        },
        py::arg("outlines"), py::arg("rule") = "nonzero", unlocked,
        R"(Return the rings of the shape that closed outlines fill.

The outlines may cross and turn either way.

rule: "nonzero" or "evenodd".)");
    m.def("intersect", &intersect, py::arg("rings_a"), py::arg("rings_b"), unlocked,
          "Return the intersection of two shapes, each given as for unite.");
    m.def("convex_hull", &convex_hull, py::arg("points"),
          "Return the convex hull of points (n, 2), counter-clockwise.");
    m.def("clearance", &clearance, py::arg("rings"), py::arg("points"), unlocked,
          "Return the distance [mm] of points (n, 2) from the outline, on either side.");
    m.def("first_crossings", &first_crossings, py::arg("rings"), py::arg("places"), py::arg("directions"), unlocked,
          R"(Return how far ahead of each place the outline of rings is first crossed [mm].

The distance is infinite if the outline is not crossed.

places: (n, 2).
directions: (n, 2), the unit vector from each place along which to look.

Raises Error if there are not as many directions as places.)");
    m.def("area", &area, py::arg("rings"),
          R"(Return the area of rings [mm^2].

Clockwise rings are holes, and their area is subtracted. The area is negative if the holes outweigh the rest.)");
    m.def("excess_turning", &excess_turning, py::arg("mark"), py::arg("target"),
          R"(Return how much more a mark's outlines turn than the target's, in full turns.

Each outline is replaced by a polygon within 0.1 mm.)");
    m.def("thorns", &thorns, py::arg("mark"), py::arg("target"),
          R"(Count the corners of a mark that stick out of the target.

Counted are corners of more than 20 degrees that stick out by more than 0.3 mm. Each outline is replaced by a polygon
within 0.05 mm. The target is given as for unite.)");
    m.def("overlap", &overlap, py::arg("rings_a"), py::arg("rings_b"), unlocked,
          R"(Return the area of the intersection of two shapes over the area of their union.

The result is 1 if both shapes are empty. Each shape is given as for unite.)");
}
