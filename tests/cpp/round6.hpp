#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "brush_json.hpp"
#include "brushsvg/brush.hpp"
#include "brushsvg/stroke.hpp"

/// Return the shipped brush of this name.
inline brushsvg::Brush shipped(const std::string& name) {
    std::ifstream file(std::string(BRUSHES_DIR) + "/" + name + ".json");
    std::stringstream text;
    text << file.rdbuf();
    return brushsvg::io::read_brush(text.str());
}

/// Return a polyline as cubics.
inline brushsvg::Cubics polyline(const std::vector<Eigen::Vector2d>& points) {
    brushsvg::Cubics out(Eigen::Index(points.size()) - 1, 8);
    for (Eigen::Index i = 0; i < out.rows(); ++i) {
        const Eigen::Vector2d a = points[i], b = points[i + 1], third = (b - a) / 3.0;
        out.row(i) << a.transpose(), (a + third).transpose(), (b - third).transpose(), b.transpose();
    }
    return out;
}

/// Return the stroke "s" along cubics.
inline brushsvg::Stroke stroke_of(const brushsvg::Cubics& middle, std::vector<brushsvg::WidthKnot> half_width) {
    brushsvg::Stroke s;
    s.id = "s";
    s.middle_mm = middle;
    s.half_width = std::move(half_width);
    return s;
}
