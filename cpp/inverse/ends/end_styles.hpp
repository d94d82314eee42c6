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

/// A turn of the brush on the spot, at one depth. P rests, the footprint goes round it and paints a disc.
struct TurnRound {
    Eigen::Vector2d at_mm;
    double depth_mm;
    Eigen::Vector2d ends_heading{1.0, 0.0};  ///< used if no move is before the turn and no line is after it
};

/// One move of the brush on the paper: it turns round on the spot, or the widest section is moved along a line, or
/// both. Where a line follows another move, P rests. The mark continues where the widest section is as far from P as
/// its lever, between `from_mm` and `latest_mm`.
struct BrushMove {
    std::optional<TurnRound> turn;
    std::optional<Stroke> line;
    double from_mm = 0.0, latest_mm = 0.0, to_mm = 0.0;  ///< arc lengths along the line [mm]
};
using BrushMoves = std::vector<BrushMove>;

/// A stroke with a new end. If the brush is turned round there, also the depth of the turn.
struct StrokeWithEnd {
    Stroke stroke;
    std::optional<double> turn_depth_mm;
};

/// A way to begin a stroke, or to end it. Each function finds the moves from the geometry alone. None if there is no
/// room, or if the brush is too coarse.
struct StartStyle {
    Terminal name;
    std::optional<BrushMoves> (*moves)(const Stroke& ended, const Brush& brush, Caps caps);
};
struct EndStyle {
    Terminal name;  ///< automatic: round, and not taken where a round end is requested
    std::optional<StrokeWithEnd> (*ended)(const Stroke& stroke, const Brush& brush, Caps caps);
};
extern const std::array<StartStyle, 5> kStartStyles;  ///< the plainest style first
extern const std::array<StartStyle, 3> kDotStyles;    ///< for a stroke that is a dot: it has no end of its own
extern const std::array<EndStyle, 4> kEndStyles;

/// Return moves that paint a mark by turning the brush on the spot. A short bar is turned at both of its ends. None for
/// a stroke longer than a dot, a ring, or a rigid brush. None if a footprint of least depth already reaches the drawn
/// edge.
std::optional<BrushMoves> turned_dot(const Stroke& stroke, const Brush& brush, Caps caps = Caps::round);

/// Return moves for a dot with corners, as in the i of a sans: turn round, then paint a narrow mark along its corners.
std::optional<BrushMoves> dot_with_corners(const Stroke& stroke, const Brush& brush, Caps caps = Caps::round);

/// Narrow a stroke to a point at the drawn end. It is a pointed start mirrored, with the shape of the footprint's rear.
/// None if the stroke is shorter than that, or as fine as its point.
std::optional<StrokeWithEnd> pointed_end(const Stroke& stroke, const Brush& brush, Caps caps);

/// A stroke with a butt end at one side. Near its end it narrows and runs on into the corner that is further ahead, its
/// outer edge on the stroke's edge. Then it follows the cut into the other corner, and goes a little way back. A butt
/// start does so on the way back from where the brush was set down inside the stroke, and then joins the path again.
struct ButtEnd {
    Stroke stroke;
    PathEnd end;
    Eigen::Vector2d back_mm;  ///< where the way back along the side ends
    double reach_mm;          ///< how far from the path's end its widest section goes
};
std::optional<ButtEnd> make_butt_end(const Stroke& stroke, const Brush& brush, Caps caps, Side side);

/// Return how far from P the paint reaches when the brush is pressed to a depth and turned there [mm].
double turn_radius_mm(const Brush& brush, double depth);

/// Angle of a turn on the spot [rad]. An arc that ends where it began would be ambiguous.
inline constexpr double kFullTurnRad = 356.0 * EIGEN_PI / 180.0;

/// First and last row of a mark between which the brush is turned round on the spot. There P follows the line, and the
/// widest section goes round P.
struct FullTurn {
    std::size_t first, last;
};
std::vector<FullTurn> find_full_turns(const PassMarks& marks);

}  // namespace brushsvg
