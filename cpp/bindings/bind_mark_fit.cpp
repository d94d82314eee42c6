#include "bindings.hpp"
#include "mark_fit.hpp"

template <>
inline constexpr auto members<brushsvg::fit::PaintedMark> =
    std::tuple(&brushsvg::fit::PaintedMark::stroke, &brushsvg::fit::PaintedMark::poses_mm,
               &brushsvg::fit::PaintedMark::outline_mm, &brushsvg::fit::PaintedMark::arcs);

template <>
inline constexpr auto members<brushsvg::fit::Prior> =
    std::tuple(&brushsvg::fit::Prior::value, &brushsvg::fit::Prior::sigma);

template <>
inline constexpr auto members<brushsvg::fit::MarkLaws> =
    std::tuple(&brushsvg::fit::MarkLaws::lag, &brushsvg::fit::MarkLaws::tip_gap, &brushsvg::fit::MarkLaws::half_width,
               &brushsvg::fit::MarkLaws::widest_per_half, &brushsvg::fit::MarkLaws::front_per_half,
               &brushsvg::fit::MarkLaws::round_tail, &brushsvg::fit::MarkLaws::widest_by_depth,
               &brushsvg::fit::MarkLaws::front_by_depth);

template <>
inline constexpr auto members<brushsvg::fit::LawPrior> =
    std::tuple(&brushsvg::fit::LawPrior::laws, &brushsvg::fit::LawPrior::rows);

template <>
inline constexpr auto members<brushsvg::fit::Machine> = std::tuple(
    &brushsvg::fit::Machine::lean_mm_per_mm, &brushsvg::fit::Machine::scale, &brushsvg::fit::Machine::skew,
    &brushsvg::fit::Machine::tilt_mm_per_mm, &brushsvg::fit::Machine::backlash_mm, &brushsvg::fit::Machine::field_mm,
    &brushsvg::fit::Machine::field_middle_mm, &brushsvg::fit::Machine::field_reach_mm);

template <>
inline constexpr auto members<brushsvg::fit::MarkOptions> =
    std::tuple(&brushsvg::fit::MarkOptions::deepest_mm, &brushsvg::fit::MarkOptions::lag_terms,
               &brushsvg::fit::MarkOptions::tip_gap_terms, &brushsvg::fit::MarkOptions::half_width_terms,
               &brushsvg::fit::MarkOptions::departing, &brushsvg::fit::MarkOptions::widest_per_half,
               &brushsvg::fit::MarkOptions::front_per_half, &brushsvg::fit::MarkOptions::laws,
               &brushsvg::fit::MarkOptions::round_tail, &brushsvg::fit::MarkOptions::height_mm,
               &brushsvg::fit::MarkOptions::placement_mm, &brushsvg::fit::MarkOptions::turn_rad,
               &brushsvg::fit::MarkOptions::displacement_mm, &brushsvg::fit::MarkOptions::lean_mm_per_mm,
               &brushsvg::fit::MarkOptions::axes, &brushsvg::fit::MarkOptions::tilt_mm_per_mm,
               &brushsvg::fit::MarkOptions::backlash_mm, &brushsvg::fit::MarkOptions::field_mm,
               &brushsvg::fit::MarkOptions::spacing_mm, &brushsvg::fit::MarkOptions::noise_mm,
               &brushsvg::fit::MarkOptions::noise_length_mm, &brushsvg::fit::MarkOptions::max_iterations);

template <>
inline constexpr auto members<brushsvg::fit::MarkResidual> =
    std::tuple(&brushsvg::fit::MarkResidual::point_mm, &brushsvg::fit::MarkResidual::distance_mm,
               &brushsvg::fit::MarkResidual::displacement_mm, &brushsvg::fit::MarkResidual::way_mm,
               &brushsvg::fit::MarkResidual::rms_mm, &brushsvg::fit::MarkResidual::outlier);

template <>
inline constexpr auto members<brushsvg::fit::MarkFit> =
    std::tuple(&brushsvg::fit::MarkFit::laws, &brushsvg::fit::MarkFit::covariance, &brushsvg::fit::MarkFit::height_mm,
               &brushsvg::fit::MarkFit::turn_rad, &brushsvg::fit::MarkFit::shift_mm, &brushsvg::fit::MarkFit::centre_mm,
               &brushsvg::fit::MarkFit::machine, &brushsvg::fit::MarkFit::marks, &brushsvg::fit::MarkFit::noise_mm,
               &brushsvg::fit::MarkFit::samples, &brushsvg::fit::MarkFit::effective_samples,
               &brushsvg::fit::MarkFit::outlier_share, &brushsvg::fit::MarkFit::slim, &brushsvg::fit::MarkFit::remarks,
               &brushsvg::fit::MarkFit::iterations, &brushsvg::fit::MarkFit::converged);

void bind_mark_fit(py::module_& m) {
    using namespace brushsvg::fit;
    const auto unlocked = py::call_guard<ReleasedGil>();
    py::class_<PaintedMark> painted_mark(m, "PaintedMark", R"(The mark that one pass painted, with the path of the TCP.

stroke: id of the stroke.
poses_mm: path of the TCP (n, 3), z = -depth.
outline_mm: rings [(n, 2) mm] of the mark, including its holes.
arcs: arcs of the pass, which the TCP follows on their circles.)");
    painted_mark
        .def(py::init([](std::string stroke, brushsvg::Poses poses_mm, brushsvg::Rings outline_mm,
                         std::vector<brushsvg::Arc> arcs) {
                 return PaintedMark{std::move(stroke), std::move(poses_mm), std::move(outline_mm), std::move(arcs)};
             }),
             py::arg("stroke"), py::arg("poses_mm"), py::arg("outline_mm"),
             py::arg("arcs") = std::vector<brushsvg::Arc>{})
        .def_readonly("stroke", &PaintedMark::stroke)
        .def_readonly("poses_mm", &PaintedMark::poses_mm)
        .def_property_readonly("outline_mm", frozen_copy(&PaintedMark::outline_mm))
        .def_property_readonly("arcs", frozen_copy(&PaintedMark::arcs))
        .def("__repr__", [](const PaintedMark& v) {
            return "<PaintedMark " + quoted(v.stroke) + ": " + format_count(v.outline_mm.size(), "ring") +
                   ", painted along " + format_count(std::size_t(v.poses_mm.rows()), "pose") + ">";
        });
    add_fixed_value_semantics(painted_mark);
    py::class_<Prior> prior(m, "Prior",
                            R"(Prior knowledge of a number, as a normal distribution.

value: the mean.
sigma: the standard deviation. 0: the number is known; inf: nothing is known.)");
    prior
        .def(py::init([](double value, double sigma) { return Prior{value, sigma}; }), py::arg("value"),
             py::arg("sigma"))
        .def_readwrite("value", &Prior::value)
        .def_readwrite("sigma", &Prior::sigma)
        .def("__repr__",
             [](const Prior& v) { return "Prior(" + format_number(v.value) + ", " + format_number(v.sigma) + ")"; });
    add_value_semantics(prior);
    py::class_<MarkLaws> mark_laws(m, "MarkLaws",
                                   R"(Laws as coefficients (ascending powers of depth), and a footprint's shape.

The footprint has the shape of a drop.)");
    mark_laws
        .def(py::init([](std::vector<double> lag, std::vector<double> tip_gap, std::vector<double> half_width,
                         double widest_per_half, double front_per_half, bool round_tail,
                         std::vector<double> widest_by_depth, std::vector<double> front_by_depth) {
                 return MarkLaws{
                     std::move(lag), std::move(tip_gap), std::move(half_width),      widest_per_half,
                     front_per_half, round_tail,         std::move(widest_by_depth), std::move(front_by_depth)};
             }),
             py::arg("lag"), py::arg("tip_gap"), py::arg("half_width"), py::arg("widest_per_half") = 1.8,
             py::arg("front_per_half") = 1.0, py::arg("round_tail") = false,
             py::arg("widest_by_depth") = std::vector<double>{}, py::arg("front_by_depth") = std::vector<double>{})
        .def_property_readonly("lag", frozen_copy(&MarkLaws::lag))
        .def_property_readonly("tip_gap", frozen_copy(&MarkLaws::tip_gap))
        .def_property_readonly("half_width", frozen_copy(&MarkLaws::half_width))
        .def_readonly("widest_per_half", &MarkLaws::widest_per_half)
        .def_readonly("front_per_half", &MarkLaws::front_per_half)
        .def_readonly("round_tail", &MarkLaws::round_tail)
        .def_property_readonly("widest_by_depth", frozen_copy(&MarkLaws::widest_by_depth))
        .def_property_readonly("front_by_depth", frozen_copy(&MarkLaws::front_by_depth))
        .def("__repr__", [](const MarkLaws& v) {
            return "<MarkLaws: lag of " + format_count(v.lag.size(), "term") + ", tip gap of " +
                   std::to_string(v.tip_gap.size()) + ", half width of " + std::to_string(v.half_width.size()) + ">";
        });
    add_fixed_value_semantics(mark_laws);
    py::class_<LawPrior> law_prior(m, "LawPrior", R"(Prior knowledge of the laws.

laws: the mean.
rows: (k, n), over the coefficients of lag, tip_gap and half_width (their constant, 0, left out) and widest_per_half.
    Each row turns the difference of these numbers from the mean into a standard normal number.)");
    law_prior
        .def(py::init([](MarkLaws laws, std::vector<std::vector<double>> rows) {
                 return LawPrior{std::move(laws), std::move(rows)};
             }),
             py::arg("laws"), py::arg("rows"))
        .def("__repr__", [](const LawPrior& v) { return "<LawPrior: " + format_count(v.rows.size(), "row") + ">"; });
    add_fixed_value_semantics(law_prior);
    py::class_<Machine> machine(m, "Machine", R"(The systematic errors of a machine's motion.

The tool is commanded to (x, y), measured from MarkFit.centre_mm, and to the depth d. The machine moves the tool to

    x' = scale_x x + skew y + lean_x d
    y' = scale_y y + lean_y d

and by tilt_x x + tilt_y y deeper. On each axis the tool stays behind by half of the backlash. A smooth field adds
a u^2 + b u v + c v^2 [mm] to x and to y.

field_mm: (2, 3), the numbers a, b and c for x and for y.
field_middle_mm, field_reach_mm: u and v are the commanded distances from field_middle_mm, divided by
    field_reach_mm.)");
    machine.def_property_readonly("lean_mm_per_mm", frozen_copy(&Machine::lean_mm_per_mm))
        .def_property_readonly("scale", frozen_copy(&Machine::scale))
        .def_readonly("skew", &Machine::skew)
        .def_property_readonly("tilt_mm_per_mm", frozen_copy(&Machine::tilt_mm_per_mm))
        .def_property_readonly("backlash_mm", frozen_copy(&Machine::backlash_mm))
        .def_property_readonly("field_mm", frozen_copy(&Machine::field_mm))
        .def_property_readonly("field_middle_mm", frozen_copy(&Machine::field_middle_mm))
        .def_property_readonly("field_reach_mm", frozen_copy(&Machine::field_reach_mm))
        .def("__repr__", [](const Machine& v) {
            return "<Machine: scale " + format_number(v.scale[0]) + " and " + format_number(v.scale[1]) + ", skew " +
                   format_number(v.skew) + ", backlash " + format_number(v.backlash_mm[0]) + " and " +
                   format_number(v.backlash_mm[1]) + " mm>";
        });
    add_fixed_value_semantics(machine);
    py::class_<MarkOptions> mark_options(m, "MarkOptions", R"(Options of fit_marks; lengths in mm.

deepest_mm: the laws hold on [0, deepest_mm].
lag_terms, tip_gap_terms, half_width_terms: number of coefficients of each law, at most four.
widest_per_half, front_per_half, height_mm: a Prior each.
laws: LawPrior or None.
placement_mm, turn_rad: sigmas of the sheet's shift and turn; 0: none.
displacement_mm: sigma of each mark's own displacement; 0: none.
lean_mm_per_mm, axes, tilt_mm_per_mm, backlash_mm, field_mm: sigmas of the numbers of the Machine; 0: the machine does
    not have this error.
departing: whether laws get more coefficients if the marks need them.
noise_mm: noise of the edges. If given, nothing is fitted, and the result is the covariance to expect from these
    edges.)");
    mark_options.def(py::init<>())
        .def_readwrite("deepest_mm", &MarkOptions::deepest_mm)
        .def_readwrite("lag_terms", &MarkOptions::lag_terms)
        .def_readwrite("tip_gap_terms", &MarkOptions::tip_gap_terms)
        .def_readwrite("half_width_terms", &MarkOptions::half_width_terms)
        .def_readwrite("departing", &MarkOptions::departing)
        .def_readwrite("widest_per_half", &MarkOptions::widest_per_half)
        .def_readwrite("front_per_half", &MarkOptions::front_per_half)
        .def_readwrite("round_tail", &MarkOptions::round_tail)
        .def_property(
            "laws", [](const MarkOptions& o) { return o.laws; },
            [](MarkOptions& o, std::optional<LawPrior> laws) { o.laws = std::move(laws); })
        .def_readwrite("height_mm", &MarkOptions::height_mm)
        .def_readwrite("placement_mm", &MarkOptions::placement_mm)
        .def_readwrite("turn_rad", &MarkOptions::turn_rad)
        .def_readwrite("displacement_mm", &MarkOptions::displacement_mm)
        .def_readwrite("lean_mm_per_mm", &MarkOptions::lean_mm_per_mm)
        .def_readwrite("axes", &MarkOptions::axes)
        .def_readwrite("tilt_mm_per_mm", &MarkOptions::tilt_mm_per_mm)
        .def_readwrite("backlash_mm", &MarkOptions::backlash_mm)
        .def_readwrite("field_mm", &MarkOptions::field_mm)
        .def_readwrite("spacing_mm", &MarkOptions::spacing_mm)
        .def_readwrite("noise_mm", &MarkOptions::noise_mm)
        .def_readwrite("noise_length_mm", &MarkOptions::noise_length_mm)
        .def_readwrite("max_iterations", &MarkOptions::max_iterations)
        .def("__repr__", [](const MarkOptions& v) {
            return "<MarkOptions: to depth " + format_number(v.deepest_mm) + " mm, a point every " +
                   format_number(v.spacing_mm) + " mm>";
        });
    add_value_semantics(mark_options);
    py::class_<MarkResidual> mark_residual(m, "MarkResidual", "Deviation of one painted mark from its prediction.");
    mark_residual.def_readonly("point_mm", &MarkResidual::point_mm)
        .def_property_readonly("distance_mm", frozen_copy(&MarkResidual::distance_mm))
        .def_property_readonly("displacement_mm", frozen_copy(&MarkResidual::displacement_mm))
        .def_readonly("way_mm", &MarkResidual::way_mm)
        .def_readonly("rms_mm", &MarkResidual::rms_mm)
        .def_readonly("outlier", &MarkResidual::outlier)
        .def("__repr__", [](const MarkResidual& v) {
            return "<MarkResidual: rms " + format_number(v.rms_mm) + " mm over " +
                   format_count(v.distance_mm.size(), "point") + ">";
        });
    add_fixed_value_semantics(mark_residual);
    py::class_<MarkFit> mark_fit(m, "MarkFit", R"(A brush fitted to marks.

covariance: of these numbers, in this order:
    the coefficients of lag, and of tip_gap and half_width (without the constant 0 of both);
    widest_per_half and front_per_half, or the coefficients of widest_by_depth and front_by_depth if the ratios change
    with depth;
    height, shift x and y, turn;
    if any number of the machine was requested: lean x and y, scale x and y, skew, tilt x and y, backlash x and y, and
    the six numbers of the field.)");
    mark_fit.def_readonly("laws", &MarkFit::laws)
        .def_property_readonly("covariance", frozen_copy(&MarkFit::covariance))
        .def_readonly("height_mm", &MarkFit::height_mm)
        .def_readonly("turn_rad", &MarkFit::turn_rad)
        .def_property_readonly("shift_mm", frozen_copy(&MarkFit::shift_mm))
        .def_property_readonly("centre_mm", frozen_copy(&MarkFit::centre_mm))
        .def_readonly("machine", &MarkFit::machine)
        .def_property_readonly("marks", parts(&MarkFit::marks))
        .def_readonly("noise_mm", &MarkFit::noise_mm)
        .def_readonly("samples", &MarkFit::samples)
        .def_readonly("effective_samples", &MarkFit::effective_samples)
        .def_readonly("outlier_share", &MarkFit::outlier_share)
        .def_readonly("slim", &MarkFit::slim)
        .def_property_readonly("remarks", frozen_copy(&MarkFit::remarks))
        .def_readonly("iterations", &MarkFit::iterations)
        .def_readonly("converged", &MarkFit::converged)
        .def("__repr__", [](const MarkFit& v) {
            return "<MarkFit to " + format_count(v.marks.size(), "mark") + ": edges within " +
                   format_number(v.noise_mm) + " mm (1 sigma)" + (v.converged ? ">" : ", not converged>");
        });
    add_fixed_value_semantics(mark_fit);
    m.def("fit_marks", &fit_marks, py::arg("marks"), py::arg("start") = std::optional<MarkLaws>(),
          py::arg_v("options", MarkOptions(), "MarkOptions()"), unlocked,
          R"(Fit laws to painted marks and to the TCP paths that painted them.

The fit is by robust least squares through the simulator.

marks: a PaintedMark for each pass.
start: MarkLaws at which the fit begins. None: lags of many lengths are tried.
options: MarkOptions.

Raises Error if there is no mark, for numbers that are not finite, and for marks that no brush paints along these
paths.)");
}
