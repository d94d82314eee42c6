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

/// The paint of one pass: shares of the pixels of a box.
struct Tile {
    PixelBox box;
    Coverage share;
};

/// A shape in pixels, the cost of paint on it, and the places of its pixels. Row 0 is the top.
class Canvas {
 public:
    /// margin_mm: margin round the shape in which paint counts.
    Canvas(const Rings& target_mm, const ObjectiveWeights& weights, double margin_mm);

    double px_per_mm() const { return px_per_mm_; }
    PixelBox whole() const { return {0, 0, target_.rows(), target_.cols()}; }
    Window window_of(const PixelBox& box) const;
    /// Return the pixels about a rectangle of the paper, limited to the canvas.
    PixelBox box_of(const Eigen::Vector2d& low_mm, const Eigen::Vector2d& high_mm) const;
    Eigen::Vector2d place(Eigen::Index row, Eigen::Index column) const;
    /// Return whether at least half of the pixel at a place is in the shape.
    bool is_inside(const Eigen::Vector2d& at_mm) const;

    /// Return the paint of a pass. Throws Error if the pass cannot be simulated.
    Tile paint(const Pass& pass, const Brush& brush) const;
    const Coverage& target() const { return target_; }
    /// Return how much of each pixel is in the shape without a rim as wide as `seen_mm`.
    const Coverage& inner() const { return inner_; }
    /// Return the area of paint that is visible outside of the shape [mm^2].
    double bulge_mm2(const Tile& tile) const;
    /// Return the cost of the pixels of a box [mm^2]. is_last: false if other strokes may still paint bare parts, which
    /// then do not count twice.
    double cost_mm2(const PixelBox& box, const Coverage& painted, bool is_last = true) const;

 private:
    ObjectiveWeights weights_;
    Window window_{};
    double px_per_mm_ = 0.0;
    Coverage target_, inner_, outer_;
};

/// Add a tile to a picture of a box. Each pixel in both gets the larger share.
void paint_over(Coverage& picture, const PixelBox& box, const Tile& tile);

}  // namespace brushsvg
