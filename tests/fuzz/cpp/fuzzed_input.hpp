#pragma once

// What the fuzz targets share: numbers, brushes, strokes and passes made of a fuzzer's bytes, and how a finding ends.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "brushsvg/brush.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/plan.hpp"
#include "brushsvg/stroke.hpp"

namespace fuzz {

/// Ends the program, which libFuzzer reports as a finding, where a property does not hold.
inline void require(bool holds, const char* property, double value = 0.0) {
    if (holds) return;
    std::fprintf(stderr, "PROPERTY BROKEN: %s (%.17g)\n", property, value);
    std::abort();
}

/// Runs the code under test. A refusal (brushsvg::Error) ends the run as long as it has a code and a sentence; any
/// other exception is a finding.
template <class Run>
int refusing(Run&& run) {
    try {
        run();
    } catch (const brushsvg::Error& refusal) {
        require(!refusal.code().empty() && std::string(refusal.what()).size() > 10, "a refusal has a code and a text");
    }
    return 0;
}

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
    return std::string(reinterpret_cast<const char*>(data), size);
}

/// Values made of the bytes of an input, in order. Behind the end all bytes are 0.
class Input {
 public:
    Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

    bool is_over() const { return at_ >= size_; }
    std::uint8_t byte() { return is_over() ? 0 : data_[at_++]; }
    bool chance(int one_in) { return byte() % one_in == one_in - 1; }
    int integer(int lo, int hi) { return lo + byte() % (hi - lo + 1); }
    /// One of 65536 numbers within [lo, hi].
    double number(double lo, double hi) {
        const int value = byte() * 256 + byte();
        return lo + (hi - lo) * value / 65535.0;
    }
    /// One of 256: numbers meet each other and lines overlap as they do in drawings.
    double coarse(double lo, double hi) { return lo + (hi - lo) * byte() / 255.0; }
    /// A coordinate [mm] within 40 mm of 0: mostly on a grid of 0.25 mm or 1 mm.
    double coordinate() {
        if (!fine_) return 0.25 * integer(0, 160) - 20.0;
        return number(-40.0, 40.0);
    }
    /// Whether coordinates are on a grid, which is decided once for an input.
    void choose_grid() { fine_ = chance(2); }
    /// The number, or one time in 64 one that no code may rely on not to get.
    double wild(double number) {
        static const double kNumbers[] = {std::numeric_limits<double>::quiet_NaN(),
                                          std::numeric_limits<double>::infinity(),
                                          -1.0,
                                          -0.0,
                                          1e-300,
                                          1e300,
                                          1e6,
                                          5e-324};
        return chance(64) ? kNumbers[byte() % 8] : number;
    }

 private:
    const std::uint8_t* data_;
    std::size_t size_;
    std::size_t at_ = 0;
    bool fine_ = false;
};

inline brushsvg::Profile law(std::vector<double> coefficients) {
    brushsvg::Profile made;
    made.coefficients = std::move(coefficients);
    return made;
}

/// A drop of `front` mm in front of its widest section, `half_width` mm to either side; the first vertex is the tip.
inline brushsvg::Ring drop(double to_widest, double half_width, double front, int vertices) {
    brushsvg::Ring ring(vertices, 2);
    ring.row(0) << 0.0, 0.0;
    const double pi = 3.14159265358979323846;
    for (int i = 1; i < vertices; ++i) {
        const double angle = -0.5 * pi + pi * (i - 1) / (vertices - 2);
        ring.row(i) << to_widest + front * std::cos(angle), half_width * std::sin(angle);
    }
    return ring;
}

/// A brush whose laws and outlines agree, mostly: brushes that check() refuses are rare, and are needed too.
inline brushsvg::Brush brush_from(Input& in) {
    brushsvg::Brush brush;
    brush.name = "fuzzed";
    brush.depth_range_mm = {in.chance(4) ? in.coarse(0.0, 1.0) : 0.0, in.coarse(2.0, 12.0)};
    const double deepest = brush.depth_range_mm[1];
    const bool is_pen = in.chance(8);
    brush.kind = is_pen ? "pen" : in.chance(4) ? "liner" : "round";
    const double widest = in.coarse(0.5, 1.5), gap = widest * in.coarse(0.0, 1.0), half = in.coarse(0.1, 0.8);
    brush.tip_to_widest = law({0.0, widest});
    brush.tip_gap = law({0.0, is_pen ? widest : gap});
    brush.half_width = is_pen || in.chance(8) ? law({half}) : law({in.chance(4) ? 0.1 : 0.0, half});
    switch (is_pen ? 0 : in.integer(1, 3)) {
        case 0:
            brush.lag = law({0.0});
            break;
        case 1:
            brush.lag = law({in.coarse(0.05, 10.0)});
            break;
        case 2:
            brush.lag = law({in.coarse(0.0, 6.0), in.coarse(0.0, 1.0)});
            break;
        default: {  // rises, then falls again
            const double top = in.coarse(1.0, 8.0), most = in.coarse(0.3, 1.0) * deepest;
            brush.lag = law({in.coarse(0.1, 1.0), 2.0 * top / most, -top / (most * most)});
            brush.lag.floor = 0.05;
        }
    }
    brush.paint_depth_mm = brush.width_follows_depth() ? 0.0 : in.coarse(0.2, 1.0) * deepest;
    const int outlines = in.integer(1, 3), vertices = in.integer(4, 12);
    const double front = in.coarse(0.3, 1.5);
    for (int i = 1; i <= outlines; ++i) {
        const double depth = deepest * i / outlines;
        brush.footprints.dragged.push_back({depth, drop(brush.tip_to_widest(depth), brush.half_width(depth),
                                                        front * std::max(0.05, brush.half_width(depth)), vertices)});
        if (i == outlines && in.chance(3))
            brush.footprints.pressed.push_back({depth, drop(brush.tip_to_widest(depth), brush.half_width(depth),
                                                            0.7 * front * half * depth + 0.1, vertices)});
    }
    if (in.chance(16)) {
        const double odd = in.wild(in.number(-20.0, 20.0));
        switch (in.integer(0, 5)) {
            case 0:
                brush.lag.coefficients.push_back(odd);
                break;
            case 1:
                brush.half_width.coefficients.push_back(odd);
                break;
            case 2:
                brush.tip_gap.coefficients.push_back(odd);
                break;
            case 3:
                brush.depth_range_mm[std::size_t(in.integer(0, 1))] = odd;
                break;
            case 4:
                brush.footprints.dragged.back().outline_mm(in.integer(0, 3), in.integer(0, 1)) = odd;
                break;
            default:
                brush.lag.floor_slope = odd;
        }
    }
    return brush;
}

/// Whether check(brush) admits it: only then do marks keep to the brush's geometry.
inline bool is_sound(const brushsvg::Brush& brush) {
    try {
        check(brush);
    } catch (const brushsvg::Error&) {
        return false;
    }
    return true;
}

/// A stroke of one to `most_cubics` cubics with a width that the brush can paint, mostly.
inline brushsvg::Stroke stroke_from(Input& in, const brushsvg::Brush& brush, int most_cubics) {
    in.choose_grid();
    brushsvg::Stroke stroke;
    stroke.id = "s";
    const int cubics = in.integer(1, most_cubics);
    const bool straight = in.chance(3);
    stroke.middle_mm.resize(cubics, 8);
    Eigen::RowVector2d at(50.0 + in.coordinate(), 50.0 + in.coordinate());
    const Eigen::RowVector2d start = at;
    stroke.closed = in.chance(4);
    for (Eigen::Index i = 0; i < cubics; ++i) {
        Eigen::RowVector2d points[3];
        for (auto& point : points) point = at + Eigen::RowVector2d(in.coordinate(), in.coordinate());
        if (stroke.closed && i + 1 == cubics) points[2] = start;
        if (straight) points[0] = at + (points[2] - at) / 3.0, points[1] = at + (points[2] - at) / 1.5;
        stroke.middle_mm.row(i) << at, points[0], points[1], points[2];
        at = points[2];
    }
    const auto [narrow, wide] = brush.half_width_range_mm();
    const int knots = in.integer(1, 4);
    for (int i = 0; i < knots; ++i) {
        const double share = knots == 1 ? 0.0 : double(i) / (knots - 1);
        stroke.half_width.push_back({share, in.coarse(std::max(0.1, narrow), wide)});
    }
    stroke.start_covered = in.chance(8);
    stroke.end_covered = in.chance(8);
    if (in.chance(16)) stroke.half_width[std::size_t(in.integer(0, knots - 1))].half_width_mm = in.wild(wide);
    if (in.chance(16)) stroke.middle_mm(in.integer(0, cubics - 1), in.integer(0, 7)) = in.wild(at.x());
    return stroke;
}

/// A pass of two to `most_poses` poses within the brush's depths, mostly.
inline brushsvg::Pass pass_from(Input& in, const brushsvg::Brush& brush, int most_poses) {
    in.choose_grid();
    brushsvg::Pass pass;
    pass.stroke = "s";
    const int poses = in.integer(2, most_poses);
    const double deepest = std::clamp(brush.depth_range_mm[1], 0.0, 100.0);
    pass.poses_mm.resize(poses, 3);
    Eigen::RowVector3d at(50.0, 50.0, 0.0);
    for (Eigen::Index i = 0; i < poses; ++i) {
        const int stays = in.integer(0, 7);  // on the spot, or at one depth, as programs do
        if (stays != 0) at.head<2>() += Eigen::RowVector2d(in.coordinate(), in.coordinate());
        if (stays != 1) at.z() = -in.coarse(0.0, deepest);
        if (stays == 2) at.z() = 0.0;
        pass.poses_mm.row(i) = at;
    }
    if (in.chance(32)) pass.poses_mm(in.integer(0, poses - 1), in.integer(0, 2)) = in.wild(1.0);
    if (in.chance(8)) {
        pass.tool_axes.resize(poses, 3);
        for (Eigen::Index i = 0; i < poses; ++i) {
            const double turn = in.coarse(0.0, 6.3), tilt = in.coarse(0.0, 0.5);
            pass.tool_axes.row(i) << std::cos(turn) * std::sin(tilt), std::sin(turn) * std::sin(tilt), std::cos(tilt);
        }
    }
    return pass;
}

inline bool are_finite(const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

}  // namespace fuzz
