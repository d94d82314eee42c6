#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "brushsvg/compensate.hpp"
#include "brushsvg/marks.hpp"
#include "inverse/ends/end_geometry.hpp"

namespace brushsvg {

/// The brush is turned round on the spot at a depth: P rests, the footprint goes round it and paints a disc.
struct TurnRound {
    Eigen::Vector2d at_mm;
    double depth_mm;
    Eigen::Vector2d ends_heading{1.0, 0.0};  ///< where nothing before it and no line after it says so
};

/// One move of the brush on the paper: it turns round on the spot, or the widest section is moved along a line, or
/// both. Where a line follows another move, P rests, and the mark goes on where the widest section is as far from P as
/// its lever: between `from_mm` and `latest_mm`.
struct BrushMove {
    std::optional<TurnRound> turn;
    std::optional<Stroke> line;
    double from_mm = 0.0, latest_mm = 0.0, to_mm = 0.0;  ///< arc lengths
};
using BrushMoves = std::vector<BrushMove>;

/// A stroke with a new end, and the depth at which the brush is turned round there, if it is.
struct EndedStroke {
    Stroke stroke;
    std::optional<double> turn_depth_mm;
};

/// A way to begin a stroke, or to end it. Each function finds the moves from the geometry alone; none where there is no
/// room, or where the brush is too coarse.
struct StartStyle {
    Terminal name;
    std::optional<BrushMoves> (*moves)(const Stroke& ended, const Brush& brush, Caps caps);
};
struct EndStyle {
    Terminal name;  ///< automatic: round, and not taken where a round end is requested
    std::optional<EndedStroke> (*ended)(const Stroke& stroke, const Brush& brush, Caps caps);
};
extern const std::array<StartStyle, 5> kStartStyles;  ///< the plainest first
extern const std::array<StartStyle, 3> kDotStyles;    ///< of a stroke that is a dot: it has no end of its own
extern const std::array<EndStyle, 4> kEndStyles;

/// A mark that is painted by turning the brush on the spot. A short bar is turned at both of its ends. None for a
/// stroke longer than a dot, a ring, a rigid brush, and where a footprint of no depth reaches the drawn edge.
std::optional<BrushMoves> turned_dot(const Stroke& stroke, const Brush& brush, Caps caps = Caps::round);

/// A dot with corners, as in the i of a sans: turned round, then a narrow mark goes round its corners.
std::optional<BrushMoves> dot_with_corners(const Stroke& stroke, const Brush& brush, Caps caps = Caps::round);

/// Narrows to a point at the drawn end, as a pointed start widens: as the footprint is behind, mirrored. None where the
/// stroke is shorter than that, or as fine as its point.
std::optional<EndedStroke> pointed_end(const Stroke& stroke, const Brush& brush, Caps caps);

/// A stroke with a butt end at one side. Near its end it narrows and runs on into the corner that is further ahead, its
/// outer edge on the stroke's own, then along the cut into the other corner, and a little way back. A butt start is
/// the same on the way back from where the brush was set down, inside of the stroke; then it is on the path again.
struct ButtEnd {
    Stroke stroke;
    PathEnd end;
    Eigen::Vector2d back_mm;  ///< where the way back along the side ends
    double reach_mm;          ///< how far from the path's end its widest section goes
};
std::optional<ButtEnd> make_butt_end(const Stroke& stroke, const Brush& brush, Caps caps, Side side);

/// How far from P the paint reaches when the brush is pressed to a depth and turned there [mm].
double reach_of_turn_mm(const Brush& brush, double depth);

/// Angle of a turn on the spot [rad]: an arc that ends where it began would say nothing.
inline constexpr double kTurnRad = 356.0 * EIGEN_PI / 180.0;

/// Rows of a mark, both included, in which the brush is turned round on the spot: then P follows the line, and the
/// widest section goes round it.
struct Turned {
    std::size_t first, last;
};
std::vector<Turned> turned_round(const PassMarks& marks);

}  // namespace brushsvg
