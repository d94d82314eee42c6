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
            const ObjectiveWeights weights = weights_for(detail_named(detail));
            const Unlocked unlocked;
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
        R"(The strokes by which the mark of each shape costs least: for each (strokes, changed, added).

shapes: (rings of the shape, strokes, the passes that paint them). detail: "draft", "normal" or "fine", how small an area
gets a stroke of its own. are_free: whether strokes may be moved, cut or left out, and not only added. strokes: for each that was
given what it is best painted as, [] for not at all; changed: whether that differs; added: (stroke, number of the stroke
that is nearest, rings of the area that it is for, rings of what it paints).)");
    m.def(
        "uncovered_areas",
        [](const std::vector<Shape>& shapes, const Brush& brush, double least_share) {
            const Unlocked unlocked;
            std::vector<std::vector<Uncovered>> out;
            for (const auto& of_shape : uncovered_areas(painted(shapes), brush, least_share)) {
                out.emplace_back();
                for (const UncoveredArea& each : of_shape)
                    out.back().emplace_back(each.outline_mm, Point{each.place_mm.x(), each.place_mm.y()}, each.mm2);
            }
            return out;
        },
        py::arg("shapes"), py::arg("brush"), py::arg("least_share"),
        R"(The areas of each shape that its passes leave without paint, from a share of the shape on, the largest first.

shapes: as for search_strokes. For each a list of (rings [mm], (x, y) in it [mm], area [mm2]).)");
}
