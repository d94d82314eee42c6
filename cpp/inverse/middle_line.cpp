#include "inverse/middle_line.hpp"

namespace brushsvg {

using Eigen::Vector2d;

double depth_of(const Stroke& stroke, const Brush& brush, double fraction) {
    return brush.depth_for_half_width(half_width_at(stroke, fraction), stroke.id);
}

double angle_between(const Vector2d& from, const Vector2d& to) {
    return std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
}

double distance_from_chord(const Sample& a, const Sample& b, const Sample& between) {
    const Vector2d chord = b.tcp - a.tcp;
    const double squared = chord.squaredNorm();
    const double t = squared > 0.0 ? std::clamp((between.tcp - a.tcp).dot(chord) / squared, 0.0, 1.0) : 0.5;
    const double depth = a.depth + t * (b.depth - a.depth);
    return (between.tcp - (a.tcp + t * chord)).norm() + 0.5 * std::abs(depth - between.depth);
}

}  // namespace brushsvg
