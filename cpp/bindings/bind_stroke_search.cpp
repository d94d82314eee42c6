#include "bindings.hpp"
#include "brushsvg/stroke_search.hpp"

namespace {

using Shape = std::tuple<brushsvg::Rings, std::vector<brushsvg::Stroke>, std::vector<brushsvg::Pass>>;
using Point = std::array<double, 2>;
using Added = std::tuple<brushsvg::Stroke, std::size_t, brushsvg::Rings, brushsvg::Rings>;
using Searched = std::tuple<std::vector<std::vector<brushsvg::Stroke>>, std::vector<bool>, std::vector<Added>>;
using Uncovered = std::tuple<brushsvg::Rings, Point, double>;

std::vector<brushsvg::PaintedShape> painted(const std::vector<Shape>& shapes) {
    std::vector<brushsvg::PaintedShape> out;
    for (const auto& [target, strokes, passes] : shapes) out.push_back({target, strokes, passes});
    return out;
}

}  // namespace

void bind_stroke_search(py::module_& m) {
    using namespace brushsvg;
    m.def(
        "search_strokes",
        [](const std::vector<Shape>& shapes, const Brush& brush, const std::string& detail, bool are_free) {
            const ObjectiveWeights weights = weights_for(parse_detail(detail));
            const ReleasedGil unlocked;
            std::vector<Searched> out;
            for (SearchedShape& found : search_strokes(painted(shapes), brush, weights, are_free)) {
                std::vector<Added> added;
                for (AddedStroke& each : found.added)
                    added.emplace_back(std::move(each.stroke), each.neighbour, std::move(each.area_mm),
                                       std::move(each.mark_mm));
                out.emplace_back(std::move(found.strokes), std::move(found.changed), std::move(added));
            }
            return out;
        },
        py::arg("shapes"), py::arg("brush"), py::arg("detail") = "normal", py::arg("are_free") = true,
        R"(Search for the strokes with which the mark of each shape costs least.

Returns (strokes, changed, added) for each shape:
    strokes: for each given stroke, the strokes that paint it best; [] if it is best left out.
    changed: for each given stroke, whether these strokes differ from the given stroke.
    added: (stroke, index of the nearest stroke, rings of the area that the stroke is for, rings of its paint) for each
    added stroke.

shapes: (rings of the shape, strokes, passes that paint the strokes) for each shape.
detail: "draft", "normal" or "fine": how small an area gets its own stroke.
are_free: True if strokes may also be moved, cut or left out. False: strokes are only added.)");
    m.def(
        "uncovered_areas",
        [](const std::vector<Shape>& shapes, const Brush& brush, double min_share) {
            const ReleasedGil unlocked;
            std::vector<std::vector<Uncovered>> out;
            for (const auto& of_shape : uncovered_areas(painted(shapes), brush, min_share)) {
                out.emplace_back();
                for (const UncoveredArea& each : of_shape)
                    out.back().emplace_back(each.outline_mm, Point{each.place_mm.x(), each.place_mm.y()}, each.mm2);
            }
            return out;
        },
        py::arg("shapes"), py::arg("brush"), py::arg("min_share"),
        R"(Find the areas of each shape that its passes leave without paint.

Returns for each shape a list of (rings [mm], a place (x, y) in the area [mm], area [mm2]), the largest area first.

shapes: as for search_strokes.
min_share: the least area, as a share of the shape's area.)");
}
