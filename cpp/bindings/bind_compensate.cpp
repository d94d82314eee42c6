#include <algorithm>
#include <functional>
#include <set>

#include "bindings.hpp"
#include "brushsvg/compensate.hpp"
#include "brushsvg/error.hpp"
#include "inverse/repeats.hpp"
#ifdef BRUSHSVG_FIT
#include "refine.hpp"
#endif

namespace {

using Compensator = std::function<brushsvg::CompensatedPass(const brushsvg::Stroke&)>;

/// Return the function that computes the plan of one stroke by a method.
Compensator make_compensator(const std::string& method, const brushsvg::Brush& brush,
                             brushsvg::CompensateOptions options,
                             [[maybe_unused]] const std::array<double, 2>& sheet_mm) {
    using brushsvg::Compensation;
    const auto closed_form = [&brush](const brushsvg::CompensateOptions& o) -> Compensator {
        return [&brush, o](const brushsvg::Stroke& stroke) { return compensate(stroke, brush, o); };
    };
    for (const auto& [name, value] : {std::pair("none", Compensation::none),
                                      {"constant", Compensation::constant},
                                      {"closed", Compensation::closed}})
        if (method == name) {
            options.method = value;
            return closed_form(options);
        }
    if (method != "refined")
        throw brushsvg::Error("choice-unknown",
                              "compensation must be none, constant, closed or refined, not \"" + method + "\"");
#ifdef BRUSHSVG_FIT
    const brushsvg::fit::RefineOptions refining{options.tolerance_mm, options.speed_mm_s, sheet_mm, options.start,
                                                options.end};
    return [&brush, refining](const brushsvg::Stroke& stroke) {
        return brushsvg::fit::refine(stroke, brush, refining).plan;
    };
#else
    throw brushsvg::Error("package-missing",
                          "this build of brushsvg has no refined compensation, because Ceres was missing: use closed");
#endif
}

struct Compensated {
    brushsvg::Plan plan;
    std::vector<brushsvg::TrackingError> tracking_errors;
    std::vector<brushsvg::Warning> warnings;
};

}  // namespace

template <>
inline constexpr auto members<Compensated> =
    std::tuple(&Compensated::plan, &Compensated::tracking_errors, &Compensated::warnings);

void bind_compensate(py::module_& m) {
    using namespace brushsvg;
    py::class_<TrackingError> error(m, "TrackingError",
                                    R"(Distance [mm] of a mark's widest point from the middle line of its stroke.

The distance is measured from the first taut row to the last.

largest_mm: the largest distance.
at_mm: the place (x, y) of the largest distance.
mean_mm: the mean distance over the painted length.
within_tolerance: whether the largest distance is within the tolerance.
has_turn_in_place: whether the brush turns in place, at a corner too sharp for the lever.)");
    error.def_readonly("largest_mm", &TrackingError::largest_mm)
        .def_property_readonly("at_mm", frozen_copy(&TrackingError::at_mm))
        .def_readonly("mean_mm", &TrackingError::mean_mm)
        .def_readonly("within_tolerance", &TrackingError::within_tolerance)
        .def_readonly("has_turn_in_place", &TrackingError::has_turn_in_place)
        .def("__repr__", [](const TrackingError& e) {
            return "<TrackingError of " + format_number(e.largest_mm) + " mm at (" + format_number(e.at_mm[0]) + ", " +
                   format_number(e.at_mm[1]) + ") mm, " + format_number(e.mean_mm) + " mm on average" +
                   (e.within_tolerance ? ", within the tolerance>" : ">");
        });
    add_fixed_value_semantics(error);
    py::class_<Compensated> type(m, "Compensated",
                                 R"(A plan with its tracking errors and warnings.

plan: the Plan.
tracking_errors: a TrackingError for each pass.
warnings: notices about strokes.)");
    type.def_readonly("plan", &Compensated::plan)
        .def_property_readonly("tracking_errors", parts(&Compensated::tracking_errors))
        .def_property_readonly("warnings",
                               [](const Compensated& done) {
                                   py::tuple out(done.warnings.size());
                                   for (std::size_t i = 0; i < out.size(); ++i) out[i] = make_notice(done.warnings[i]);
                                   return out;
                               })
        .def(
            "spliced",
            [](const Compensated& done, const Compensated& other,
               const std::vector<std::pair<bool, std::size_t>>& passes) {
                Compensated out;
                out.plan = done.plan;
                out.plan.passes.clear();
                std::set<std::string> names;
                for (const auto& [is_other, k] : passes) {
                    const Compensated& from = is_other ? other : done;
                    out.plan.passes.push_back(from.plan.passes.at(k));
                    out.tracking_errors.push_back(from.tracking_errors.at(k));
                    if (is_other) names.insert(out.plan.passes.back().stroke.name());
                }
                for (const brushsvg::Warning& each : done.warnings)
                    if (names.count(each.where) == 0) out.warnings.push_back(each);
                for (const brushsvg::Warning& each : other.warnings)
                    if (!each.where.empty()) out.warnings.push_back(each);
                return out;
            },
            py::arg("other"), py::arg("passes"),
            R"(Combine passes of this plan and another plan into one plan.

other: the other Compensated.
passes: (whether the pass is from the other plan, its index there) for each pass of the new plan, in order.)")
        .def("__repr__", [](const Compensated& done) {
            double largest = 0.0;
            for (const TrackingError& each : done.tracking_errors) largest = std::max(largest, each.largest_mm);
            return "<Compensated: " + format_count(done.plan.passes.size(), "pass") + ", at most " +
                   format_number(largest) + " mm off the middle line, " +
                   format_count(done.warnings.size(), "warning") + ">";
        });
    add_value_semantics(type);
    m.def(
        "compensate",
        [](const std::vector<Stroke>& strokes, const Brush& brush, std::optional<std::array<double, 2>> sheet,
           const std::string& method, double tolerance_mm, std::optional<double> lag_mm, double speed_mm_s,
           const py::object& progress, bool few_poses, const std::string& start, const std::string& end) {
            CompensateOptions options;
            options.tolerance_mm = tolerance_mm;
            options.lag_mm = lag_mm;
            options.speed_mm_s = speed_mm_s;
            options.few_poses = few_poses;
            options.start = parse_terminal(start, "");
            options.end = parse_terminal(end, "");
            check(brush);
            if (sheet) check_sheet(*sheet);
            const std::array<double, 2> sheet_mm = sheet.value_or(std::array<double, 2>{0.0, 0.0});
            const Compensator compensate_one = make_compensator(method, brush, options, sheet_mm);
            Compensated out;
            out.plan.brush = brush.name;
            out.plan.brush_sha256 = brush.sha256;
            out.plan.sheet_mm = sheet_mm;
            if (!brush.width_follows_depth())
                out.warnings.push_back(
                    Warning{"widths-ignored", "", "brush " + brush.name + " has one width: drawn widths are ignored"});
            std::vector<CompensatedPass> done(strokes.size());
            const std::size_t at_once = method == "refined" ? 8 : 32;  // Ctrl-C and progress wait for this many strokes
            // Refined passes depend on the place: no paint may leave the sheet.
            std::vector<Original> originals;
            if (method != "refined") originals = find_originals(strokes);
            const auto is_original = [&](std::size_t i) { return originals.empty() || originals[i].index == i; };
            run_in_parallel_chunks(strokes.size(), at_once, progress, [&](std::size_t i) {
                if (is_original(i))
                    done[i] = compensate_one(strokes[i]);
                else
                    check(strokes[i]);
            });
            for (std::size_t i = 0; i < strokes.size(); ++i)
                if (!is_original(i))
                    done[i] = move_to(strokes[i], done[originals[i].index], originals[i].displacement_mm);
            for (CompensatedPass& one : done) {
                out.plan.passes.push_back(std::move(one.pass));
                out.tracking_errors.push_back(one.tracking_error);
                for (Warning& each : one.warnings) out.warnings.push_back(std::move(each));
            }
            return out;
        },
        py::arg("strokes"), py::arg("brush"), py::arg("sheet_mm"), py::arg("method") = "closed",
        py::arg("tolerance_mm") = 0.05, py::arg("lag_mm") = py::none(), py::arg("speed_mm_s") = 20.0,
        py::arg("progress") = py::none(), py::arg("few_poses") = true, py::arg("start") = "pointed",
        py::arg("end") = "round",
        R"(Compute a plan for the TCP that puts the paint on the strokes' middle lines.

Returns a Compensated. Each pass is simulated, and its tracking error is returned.

sheet_mm: (width, height), kept in the plan. None: the plan has no sheet and is only for viewing.
method: how the plan is computed:
    "none": the TCP is on the middle line.
    "constant": the TCP is ahead by lag_mm.
    "closed": the inverse of the brush's laws.
    "refined": the closed plan, moved by least squares until the outline of the mark fits the target best. The refined
    plan is kept only if its mark overlaps the target better. Refining moves the middle of the mark on purpose.
tolerance_mm: largest allowed distance of the mark's widest point from the middle line. The limit applies once the
    brush is taut, also between poses.
lag_mm: constant only. None: the lag at each stroke's median depth.
speed_mm_s: painting speed, at most the speed of the brush.
progress: called with (strokes done, strokes).
few_poses: closed only. Use no more poses than the tolerance needs.
start, end: closed and refined only. Terminals of the strokes that do not set their own:
    "pointed": the shape of the footprint's rear.
    "round": the shape of the footprint's front. At a start, the brush is set down inside the stroke. Then it goes back
    to the stroke's beginning and turns over.
    "butt": straight. A narrower mark goes into one corner, along the cut and into the other corner.
    "auto": the terminal that suits the drawn end best.

Raises Error, naming the stroke, for widths or depths that the brush cannot reach.)");
    m.def("tracking_error_of", &tracking_error_of, py::arg("pass_"), py::arg("stroke"), py::arg("brush"),
          py::arg("tolerance_mm") = 0.05, py::call_guard<ReleasedGil>(),
          R"(Return the TrackingError of a pass against the stroke that it should paint.

The pass is simulated.)");
    m.def(
        "tracking_errors_of",
        [](const std::vector<Pass>& passes, const std::vector<Stroke>& strokes, const Brush& brush,
           double tolerance_mm) {
            if (passes.size() != strokes.size())
                throw Error("sizes-differ", "there are " + std::to_string(strokes.size()) + " strokes for " +
                                                std::to_string(passes.size()) +
                                                " passes: give one stroke for each pass");
            std::vector<TrackingError> found(passes.size());
            run_in_parallel_chunks(found.size(), 64, py::none(), [&](std::size_t i) {
                found[i] = tracking_error_of(passes[i], strokes[i], brush, tolerance_mm);
            });
            return found;
        },
        py::arg("passes"), py::arg("strokes"), py::arg("brush"), py::arg("tolerance_mm") = 0.05,
        R"(Return a TrackingError for each pass, against the stroke with its index.

Each pass is simulated, on all processors. Raises Error if there are not as many strokes as passes.)");
}
