#include "bindings.hpp"
#include "brushsvg/lag_arc.hpp"

void bind_lag(py::module_& m) {
    using namespace brushsvg;
    using Eigen::Vector2d;
    py::module_ lag = m.def_submodule("lag", "The law by which the contact patch trails the handle.");
    lag.def(
        "drag_straight",
        [](const Vector2d& contact, const Vector2d& tcp0, const Vector2d& tcp1, double depth0, double depth1,
           const Profile& profile) {
            const LagLaw<double> law =
                make_law(pieces(profile, std::min(depth0, depth1), std::max(depth0, depth1) + 1e-9));
            LagState<double> start;
            start.contact = contact;
            start.heading = (tcp0 - contact).normalized();
            start.taut = start.heading_known = true;
            LagState<double> state = start;
            double from = 0.0;  // piece by piece, in the order of travel
            for (std::size_t k = 0; k < law.pieces.size(); ++k) {
                const auto& piece = law.pieces[depth1 >= depth0 ? k : law.pieces.size() - 1 - k];
                const double end = depth1 >= depth0 ? piece.hi : piece.lo;
                const double to = k + 1 == law.pieces.size() ? 1.0 : (end - depth0) / (depth1 - depth0);
                detail::drag(piece, Move<double>(tcp0, tcp1, depth0, depth1), from, to, state);
                from = to;
            }
            return state.contact;
        },
        py::arg("contact_mm"), py::arg("tcp0_mm"), py::arg("tcp1_mm"), py::arg("depth0_mm"), py::arg("depth1_mm"),
        py::arg("profile"),
        "Contact [mm] after a straight move of a taut brush, article (5) to (7); the loose rule is not applied.");
    lag.def("drag_arc", &drag_arc<double>, py::arg("psi0_rad"), py::arg("curvature_per_mm"), py::arg("lag_mm"),
            py::arg("length_mm"), "psi [rad] after an arc of the TCP at constant lag, taut.");
    lag.def("tip_direction", &tip_direction<double>, py::arg("alpha0_rad"), py::arg("alpha1_rad"), py::arg("s_mm"),
            py::arg("lag_mm"), py::arg("tip_gap_mm"), "beta [rad], article (11), (12).");
}
