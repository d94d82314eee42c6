#pragma once

#include <vector>

// One row of many ways for all lanes in which nothing happens, with vector instructions. Inside follow_many.
namespace brushsvg::many {

/// What a lane's law is where the lane is now: a polynomial on [lo, hi]; an empty range: leave it to advance().
/// Numbers of a kind lie beside each other, one for each lane; behind the last kind there are kWidest more.
struct LawLanes {
    int degree = 0;          ///< the greatest; what a law lacks is 0
    std::size_t stride = 0;  ///< between numbers of a kind
    bool shared = false;     ///< one law: its numbers are repeated as often as the widest vector has lanes
    std::vector<double> lo, hi, steepest, clear2;
    std::vector<double> coefficients;          ///< (degree + 1) times stride
    std::vector<double> root_real, root_imag;  ///< degree times stride; what is missing is infinitely far away
};

/// The widest vector has as many lanes.
constexpr std::size_t kWidest = 8;

/// A way's row before and this one; with `shared_way` one number each.
struct WayRow {
    const double *x0, *y0, *depth0, *x1, *y1, *depth1;
};

/// p and u, at a row.
struct StateRow {
    double *contact_x, *contact_y, *heading_x, *heading_y;
};

/// What a lane does: nobody knows its heading yet, or it is in the air: 0.
constexpr double kTaut = 1.0, kResting = -1.0;

/// Carries lanes from a row to the next where they are taut and stay so, or rest and go on to. does: kTaut, kResting or
/// 0 for each lane, and as many numbers more as the widest vector has lanes. Returns how many lanes it left alone, and
/// which: `left` has room for all.
std::size_t carry_quiet(std::size_t lanes, bool shared_way, const WayRow& way, const LawLanes& law, const double* does,
                        const StateRow& before, const StateRow& after, int* left);

}  // namespace brushsvg::many
