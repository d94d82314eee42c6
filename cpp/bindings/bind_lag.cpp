#include "base/within.hpp"
#include "bindings.hpp"
#include "brushsvg/lag_arc.hpp"
#include "law_between.hpp"
#include "marks/follow_lag.hpp"

namespace {

using namespace brushsvg;
using Eigen::Vector2d;

/// Visit the pieces of a law that a straight move passes, in the order of travel: visit(piece, t0, t1). A move at one
/// depth is on one piece, also if another one begins within the rounding of that depth.
template <class Visit>
void visit_pieces(const LagLaw<double>& law, double depth0, double depth1, Visit&& visit) {
    double from = 0.0;
    for (std::size_t k = 0; k < law.pieces.size(); ++k) {
        const auto& piece = law.pieces[depth1 >= depth0 ? k : law.pieces.size() - 1 - k];
        const double end = depth1 >= depth0 ? piece.hi : piece.lo;
        const bool is_last = k + 1 == law.pieces.size() || depth0 == depth1;
        const double to = is_last ? 1.0 : std::clamp((end - depth0) / (depth1 - depth0), from, 1.0);
        visit(piece, from, to);
        if (to == 1.0) return;
        from = to;
    }
}

/// Return the angle after a drag by article (7), whose exponent is given.
double alpha_after(double alpha0, double exponent) {
    const Vector2d turned = drag_heading<double>({std::cos(alpha0), std::sin(alpha0)}, {1.0, 0.0}, std::exp(-exponent));
    return std::atan2(turned.y(), turned.x());
}

double exponent(double s_mm, double depth0, double depth1, const Profile& profile) {
    require_within(s_mm, {0.0, kMaxLengthMm}, "the length s [mm]");
    const LagLaw<double> law = make_law_between(profile, depth0, depth1);
    if (s_mm == 0.0) return 0.0;
    if (law.rigid) return std::numeric_limits<double>::infinity();
    double sum = 0.0;
    visit_pieces(law, depth0, depth1, [&](const auto& piece, double from, double to) {
        const auto depth = [&](double t) { return depth0 + t * (depth1 - depth0); };
        sum += lag_exponent(piece, depth(from), depth(to), s_mm * (to - from));
    });
    return sum;
}

using Rows = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// Follow the brush along straight moves, taut and loose, from touch-down or from a given contact.
py::dict follow(const Rows& tcp_mm, const std::vector<double>& depth_mm, const Profile& profile,
                const std::optional<Vector2d>& contact_mm) {
    const auto n = std::size_t(tcp_mm.rows());
    if (n == 0 || depth_mm.size() != n)
        throw Error("sizes-differ", "there are " + std::to_string(n) + " positions of the TCP and " +
                                        std::to_string(depth_mm.size()) +
                                        " depths: give at least one position, and one depth for each");
    for (std::size_t k = 0; k < n; ++k) {
        require_within(depth_mm[k], {0.0, 1000.0}, "depth " + std::to_string(k));
        for (int axis = 0; axis < 2; ++axis)
            require_within(tcp_mm(Eigen::Index(k), axis), {-kMaxLengthMm, kMaxLengthMm},
                           "a coordinate of position " + std::to_string(k));
    }
    const auto [lo, hi] = std::minmax_element(depth_mm.begin(), depth_mm.end());
    const LagLaw<double> law = make_law_between(profile, *lo, *hi);
    LagState<double> state = touch_down<double>(tcp_mm.row(0));
    if (contact_mm) {
        const double lag = law.at(depth_mm[0]), reach = (tcp_mm.row(0).transpose() - *contact_mm).norm();
        require_within(reach, {0.0, lag * (1.0 + 1e-9) + 1e-12}, "the distance [mm] of the contact from the TCP");
        state.contact = *contact_mm;
        if (reach > 0.0) state.heading = (tcp_mm.row(0).transpose() - *contact_mm) / reach;
        state.heading_known = reach > 0.0;
        state.taut = reach >= lag * (1.0 - 1e-9);
    }
    Rows contact(tcp_mm.rows(), 2);
    Eigen::VectorXd heading(tcp_mm.rows());
    Eigen::Array<bool, Eigen::Dynamic, 1> taut(tcp_mm.rows());
    std::optional<double> first;
    for (std::size_t k = 0; k < n; ++k) {
        const auto row = Eigen::Index(k);
        if (k > 0) {
            const Vector2d from = tcp_mm.row(row - 1), to = tcp_mm.row(row);
            advance(law, Move<double>(from, to, depth_mm[k - 1], depth_mm[k]), state);
        }
        contact.row(row) = state.contact;
        heading[row] = std::atan2(state.heading.y(), state.heading.x());
        if (!state.heading_known) continue;
        if (!first) heading.head(row).setConstant(*(first = heading[row]));
    }
    // taut where the contact is as far from the TCP as the lag reaches
    for (Eigen::Index k = 0; k < contact.rows(); ++k)
        taut[k] = (tcp_mm.row(k) - contact.row(k)).norm() >= law.at(depth_mm[std::size_t(k)]) * (1.0 - 1e-9) - 1e-12;
    py::dict rows;
    rows["contact_mm"] = contact;
    rows["heading_rad"] = heading;
    rows["taut"] = taut;
    return rows;
}

using Table = py::array_t<double, py::array::c_style>;

/// Stack the tables (rows, 2) of all lags along a third axis.
Table stack_tables(const std::vector<FollowedRows>& lags, Ring FollowedRows::* table) {
    const auto rows = lags.empty() ? 0 : (lags[0].*table).rows();
    Table out({rows, Eigen::Index(2), Eigen::Index(lags.size())});
    auto to = out.mutable_unchecked<3>();
    for (Eigen::Index k = 0; k < Eigen::Index(lags.size()); ++k)
        for (Eigen::Index i = 0; i < rows; ++i)
            for (Eigen::Index axis = 0; axis < 2; ++axis) to(i, axis, k) = (lags[std::size_t(k)].*table)(i, axis);
    return out;
}

py::list follow_lags(const std::vector<Pass>& passes, const std::vector<PassMarks>& marks,
                     const std::vector<Profile>& lags, const std::array<double, 2>& depth_range_mm) {
    if (passes.size() != marks.size())
        throw Error("sizes-differ", "there are " + std::to_string(passes.size()) + " passes and marks of " +
                                        std::to_string(marks.size()) + " passes: give the marks of each pass");
    std::vector<LagLaw<double>> laws;
    for (const Profile& lag : lags) {
        make_law_between(lag, depth_range_mm[0], depth_range_mm[1]);  // throws for a lag that is not positive
        // the brush passes smaller depths than its range has when it is set down and lifted
        laws.push_back(make_law(pieces(lag, 0.0, depth_range_mm[1] + 1e-9)));
    }
    std::vector<std::vector<FollowedRows>> followed(passes.size());
    {
        const ReleasedGil unlocked;
        parallel_for(0, passes.size(), [&](std::size_t i) {
            for (const LagLaw<double>& law : laws) followed[i].push_back(follow_lag(passes[i], marks[i], law));
        });
    }
    py::list out;
    for (const auto& of_pass : followed)
        out.append(py::make_tuple(stack_tables(of_pass, &FollowedRows::contact_mm),
                                  stack_tables(of_pass, &FollowedRows::heading)));
    return out;
}

}  // namespace

void bind_lag(py::module_& m) {
    py::module_ lag = m.def_submodule("lag", "Equations of the lag: how the contact patch trails the handle.");
    lag.def(
        "drag_straight",
        [](const Vector2d& contact, const Vector2d& tcp0, const Vector2d& tcp1, double depth0, double depth1,
           const Profile& profile) {
            const LagLaw<double> law =
                make_law(pieces(profile, std::min(depth0, depth1), std::max(depth0, depth1) + 1e-9));
            LagState<double> state;
            state.contact = contact;
            state.heading = (tcp0 - contact).normalized();
            state.taut = state.heading_known = true;
            const Move<double> move(tcp0, tcp1, depth0, depth1);
            visit_pieces(law, depth0, depth1, [&](const auto& piece, double from, double to) {
                detail::drag(piece, move, from, to, state);
            });
            return state.contact;
        },
        py::arg("contact_mm"), py::arg("tcp0_mm"), py::arg("tcp1_mm"), py::arg("depth0_mm"), py::arg("depth1_mm"),
        py::arg("profile"),
        R"(Return the contact [mm] after a straight move of a taut brush.

The equations are article (5) to (7). The rule for a loose brush is not applied.)");
    lag.def("drag_arc", &drag_arc<double>, py::arg("psi0_rad"), py::arg("curvature_per_mm"), py::arg("lag_mm"),
            py::arg("length_mm"), "Return psi [rad] of a taut brush after an arc of the TCP at constant lag.");
    lag.def("tip_direction", py::vectorize(&tip_direction<double>), py::arg("alpha0_rad"), py::arg("alpha1_rad"),
            py::arg("s_mm"), py::arg("lag_mm"), py::arg("tip_gap_mm"), "Return beta [rad] by article (11) and (12).");
    lag.def("alpha_after", py::vectorize(&alpha_after), py::arg("alpha0_rad"), py::arg("exponent"),
            "Return alpha [rad] when the integral of ds / r is `exponent`, article (7).");
    lag.def(
        "exponent",
        [](const Numbers& s_mm, const Numbers& depth0_mm, const Numbers& depth1_mm, const Profile& profile) {
            return py::vectorize([&](double s, double d0, double d1) { return exponent(s, d0, d1, profile); })(
                s_mm.values, depth0_mm.values, depth1_mm.values);
        },
        py::arg("s_mm"), py::arg("depth0_mm"), py::arg("depth1_mm"), py::arg("profile"),
        R"(Return the integral of ds / r over straight moves, article (7).

The depth is linear along each move. The summation stops beyond 50.)");
    lag.def("follow", &follow, py::arg("tcp_mm"), py::arg("depth_mm"), py::arg("profile"),
            py::arg("contact_mm") = py::none(),
            R"(Return contact, heading and tension at each position of the TCP.

The brush may be taut or loose (article 2.1 and 2.2).

contact_mm: the contact at the start. None: the brush touches down at the first position.)");
    m.def("follow_lags", &follow_lags, py::arg("passes"), py::arg("marks"), py::arg("lags"), py::arg("depth_range_mm"),
          R"(Follow the TCP of each pass with K other lags, at the rows of its marks.

Returns for each pass the contacts [mm] and the headings as unit vectors, (n, 2, K) each. In the air, the contact is the
TCP. The result is exact at each row, by the closed form.

marks: PassMarks of each pass, simulated with one upright brush.
lags: K Profiles that are positive on depth_range_mm.)");
}
