// An arc is simulated as the many short moves are that run along it.
#include "brushsvg/lag_arc.hpp"
#include "brushsvg/simulate.hpp"
#include "fuzzed_input.hpp"

using namespace brushsvg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in(data, size);
    return fuzz::refusing([&] {
        const Brush brush = fuzz::brush_from(in);
        const double pi = 3.14159265358979323846;
        const double radius = std::abs(in.wild(in.coarse(0.2, 40.0))),
                     depth = in.coarse(0.0, 1.0) * brush.depth_range_mm[1];
        const double begins = in.coarse(-pi, pi), step = in.coarse(0.05, 3.0);
        const int direction = in.chance(2) ? -1 : 1, steps = in.integer(1, 4);
        // down from the side, once round some of the circle, and straight on
        Pass pass;
        pass.stroke = "s";
        pass.poses_mm.resize(steps + 3, 3);
        const Eigen::Vector2d centre(50.0, 50.0);
        const auto on_circle = [&](double angle) {
            return Eigen::Vector2d(centre.x() + radius * std::cos(angle), centre.y() + radius * std::sin(angle));
        };
        pass.poses_mm.row(0) << in.coordinate() + 50.0, in.coordinate() + 50.0, 0.0;
        for (int i = 0; i <= steps; ++i)
            pass.poses_mm.row(i + 1) << on_circle(begins + direction * step * i).transpose(), -depth;
        pass.poses_mm.row(steps + 2) << in.coordinate() + 50.0, in.coordinate() + 50.0, -depth;
        Pass chords = pass;
        pass.arcs.push_back({1, 1 + steps, centre, direction});
        if (in.chance(16)) pass.arcs[0].first = in.integer(0, 6);
        if (in.chance(16)) pass.arcs[0].last = in.integer(0, 8);
        if (in.chance(16)) pass.arcs[0].centre_mm.x() = in.wild(50.1);
        const PassMarks marks = simulate(pass, brush, 0.05, false);
        fuzz::require(marks.contact_mm.allFinite() && fuzz::are_finite(marks.heading_rad), "rows are finite");
        const Arc& arc = pass.arcs[0];
        if (arc.first != 1 || arc.last != 1 + steps || arc.centre_mm != centre || !fuzz::is_sound(brush)) return;
        for (int i = 1; i <= 1 + steps; ++i) {
            const double off = std::abs((pass.poses_mm.row(i).head<2>().transpose() - centre).norm() - radius);
            fuzz::require(off <= kMaxCircleErrorMm, "an arc that is simulated has its poses on its circle", off);
        }
        constexpr int kPieces = 256;  // of each step: a chord leaves the arc by radius (step / kPieces)^2 / 8
        chords.poses_mm.resize(2 + steps * kPieces + 1, 3);
        chords.poses_mm.row(0) = pass.poses_mm.row(0);
        for (int i = 0; i <= steps * kPieces; ++i)
            chords.poses_mm.row(i + 1) << on_circle(begins + direction * step * i / kPieces).transpose(), -depth;
        chords.poses_mm.row(2 + steps * kPieces) = pass.poses_mm.row(steps + 2);
        const PassMarks along_chords = simulate(chords, brush, 0.05, false);
        const auto rows = pose_rows(marks), rows_of_chords = pose_rows(along_chords);
        for (int i = 0; i <= steps; ++i) {
            const Eigen::Index a = Eigen::Index(rows[std::size_t(i + 1)]),
                               b = Eigen::Index(rows_of_chords[std::size_t(1 + i * kPieces)]);
            const double off = (marks.contact_mm.row(a) - along_chords.contact_mm.row(b)).norm();
            fuzz::require(off <= 0.05, "the patch is where it is behind many short moves", off);
        }
    });
}
