#pragma once

#include <Eigen/Core>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/coverage.hpp"
#include "brushsvg/objective.hpp"
#include "brushsvg/plan.hpp"

namespace brushsvg {

/// A rectangle of pixels of a canvas.
struct PixelBox {
    Eigen::Index row = 0, column = 0, rows = 0, columns = 0;

    bool is_empty() const { return rows <= 0 || columns <= 0; }
};

/// What one pass paints: shares of the pixels of a box.
struct Tile {
    PixelBox box;
    Coverage share;
};

/// A shape in pixels, its cost in paint, and the places of its pixels. Row 0 is the top.
class Canvas {
 public:
    /// beside_mm: how far round the shape paint is looked at.
    Canvas(const Rings& target_mm, const ObjectiveWeights& weights, double beside_mm);

    double px_per_mm() const { return px_per_mm_; }
    PixelBox whole() const { return {0, 0, target_.rows(), target_.cols()}; }
    Window window_of(const PixelBox& box) const;
    /// The pixels about a rectangle of the paper, none beyond the canvas.
    PixelBox box_of(const Eigen::Vector2d& low_mm, const Eigen::Vector2d& high_mm) const;
    Eigen::Vector2d place(Eigen::Index row, Eigen::Index column) const;
    /// Whether the middle of the pixel there is in the shape.
    bool is_inside(const Eigen::Vector2d& at_mm) const;

    /// What a pass paints. Error where it cannot be simulated.
    Tile paint(const Pass& pass, const Brush& brush) const;
    const Coverage& target() const { return target_; }
    /// How much of each pixel the shape covers that is smaller all round by what is seen.
    const Coverage& inner() const { return inner_; }
    /// Area of paint that is seen out of the shape [mm^2].
    double bulge_mm2(const Tile& tile) const;
    /// The cost of pixels, of a box [mm^2]. is_last: else what is bare may be painted yet, and is not counted twice.
    double cost_mm2(const PixelBox& box, const Coverage& painted, bool is_last = true) const;

 private:
    ObjectiveWeights weights_;
    Window window_{};
    double px_per_mm_ = 0.0;
    Coverage target_, inner_, outer_;
};

/// Adds a tile to a picture of a box: the larger share of each pixel that both have.
void paint_over(Coverage& picture, const PixelBox& box, const Tile& tile);

}  // namespace brushsvg
