#pragma once

#include <tuple>

#include "brushsvg/brush.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/mark_overlap.hpp"
#include "brushsvg/marks.hpp"
#include "brushsvg/medial_axis.hpp"
#include "brushsvg/plan.hpp"
#include "brushsvg/stroke.hpp"
#include "brushsvg/stroke_score.hpp"
#include "brushsvg/tracking_error.hpp"

// The members that make up a value. They are compared, copied and pickled. A member that is not listed here is lost
// when a value is pickled.

/// The members of a value type, as a tuple of pointers. A number for all other types.
template <class Value>
inline constexpr auto members = 0;

template <>
inline constexpr auto members<brushsvg::Warning> =
    std::tuple(&brushsvg::Warning::code, &brushsvg::Warning::where, &brushsvg::Warning::sentence);

template <>
inline constexpr auto members<brushsvg::Profile> =
    std::tuple(&brushsvg::Profile::coefficients, &brushsvg::Profile::floor, &brushsvg::Profile::floor_slope,
               &brushsvg::Profile::calibrated_mm, &brushsvg::Profile::source, &brushsvg::Profile::assumed,
               &brushsvg::Profile::half_interval_95, &brushsvg::Profile::rmse_mm,
               &brushsvg::Profile::degrees_of_freedom, &brushsvg::Profile::extra);

template <>
inline constexpr auto members<brushsvg::Paint> =
    std::tuple(&brushsvg::Paint::narrows_per_m, &brushsvg::Paint::lasts_mm, &brushsvg::Paint::calibrated_mm,
               &brushsvg::Paint::source, &brushsvg::Paint::assumed, &brushsvg::Paint::covariance,
               &brushsvg::Paint::degrees_of_freedom, &brushsvg::Paint::extra);

template <>
inline constexpr auto members<brushsvg::Footprint> =
    std::tuple(&brushsvg::Footprint::depth_mm, &brushsvg::Footprint::outline_mm);

template <>
inline constexpr auto members<brushsvg::FootprintTable> =
    std::tuple(&brushsvg::FootprintTable::dragged, &brushsvg::FootprintTable::pressed);

template <>
inline constexpr auto members<brushsvg::Brush> =
    std::tuple(&brushsvg::Brush::name, &brushsvg::Brush::kind, &brushsvg::Brush::depth_range_mm, &brushsvg::Brush::lag,
               &brushsvg::Brush::tip_gap, &brushsvg::Brush::tip_to_widest, &brushsvg::Brush::half_width,
               &brushsvg::Brush::footprints, &brushsvg::Brush::covariance, &brushsvg::Brush::paint,
               &brushsvg::Brush::max_speed_mm_s, &brushsvg::Brush::paint_depth_mm, &brushsvg::Brush::sha256,
               &brushsvg::Brush::extra);

template <>
inline constexpr auto members<brushsvg::Settings> =
    std::tuple(&brushsvg::Settings::brush, &brushsvg::Settings::end, &brushsvg::Settings::kind,
               &brushsvg::Settings::order, &brushsvg::Settings::passes, &brushsvg::Settings::reload,
               &brushsvg::Settings::skip, &brushsvg::Settings::speed_mm_s, &brushsvg::Settings::start,
               &brushsvg::Settings::width_mm, &brushsvg::Settings::extra);

template <>
inline constexpr auto members<brushsvg::StrokeId> =
    std::tuple(&brushsvg::StrokeId::element, &brushsvg::StrokeId::part, &brushsvg::StrokeId::repeat,
               &brushsvg::StrokeId::lane, &brushsvg::StrokeId::load);

template <>
inline constexpr auto members<brushsvg::WidthKnot> =
    std::tuple(&brushsvg::WidthKnot::at, &brushsvg::WidthKnot::half_width_mm);

template <>
inline constexpr auto members<brushsvg::Stroke> = std::tuple(
    &brushsvg::Stroke::id, &brushsvg::Stroke::middle_mm, &brushsvg::Stroke::closed, &brushsvg::Stroke::half_width,
    &brushsvg::Stroke::target_mm, &brushsvg::Stroke::layer, &brushsvg::Stroke::colour, &brushsvg::Stroke::settings,
    &brushsvg::Stroke::start_covered, &brushsvg::Stroke::end_covered);

template <>
inline constexpr auto members<brushsvg::Arc> =
    std::tuple(&brushsvg::Arc::first, &brushsvg::Arc::last, &brushsvg::Arc::centre_mm, &brushsvg::Arc::direction);

template <>
inline constexpr auto members<brushsvg::Pass> =
    std::tuple(&brushsvg::Pass::stroke, &brushsvg::Pass::poses_mm, &brushsvg::Pass::arcs, &brushsvg::Pass::speed_mm_s,
               &brushsvg::Pass::layer, &brushsvg::Pass::colour, &brushsvg::Pass::settings, &brushsvg::Pass::load,
               &brushsvg::Pass::extra, &brushsvg::Pass::tool_axes);

template <>
inline constexpr auto members<brushsvg::Plan> =
    std::tuple(&brushsvg::Plan::brush, &brushsvg::Plan::brush_sha256, &brushsvg::Plan::sheet_mm,
               &brushsvg::Plan::passes, &brushsvg::Plan::extra);

template <>
inline constexpr auto members<brushsvg::PassMarks> =
    std::tuple(&brushsvg::PassMarks::stroke, &brushsvg::PassMarks::pose, &brushsvg::PassMarks::tcp_mm,
               &brushsvg::PassMarks::contact_mm, &brushsvg::PassMarks::heading_rad, &brushsvg::PassMarks::depth_mm,
               &brushsvg::PassMarks::taut, &brushsvg::PassMarks::pull, &brushsvg::PassMarks::lean_mm_per_mm,
               &brushsvg::PassMarks::width_share, &brushsvg::PassMarks::outline_mm);

template <>
inline constexpr auto members<brushsvg::Marks> = std::tuple(&brushsvg::Marks::passes, &brushsvg::Marks::outline_mm);

template <>
inline constexpr auto members<brushsvg::TrackingError> =
    std::tuple(&brushsvg::TrackingError::largest_mm, &brushsvg::TrackingError::at_mm, &brushsvg::TrackingError::mean_mm,
               &brushsvg::TrackingError::within_tolerance, &brushsvg::TrackingError::has_turn_in_place);

template <>
inline constexpr auto members<brushsvg::WorstPlace> =
    std::tuple(&brushsvg::WorstPlace::at_mm, &brushsvg::WorstPlace::is_missing, &brushsvg::WorstPlace::area_mm2);

template <>
inline constexpr auto members<brushsvg::StrokeScore> =
    std::tuple(&brushsvg::StrokeScore::overlap, &brushsvg::StrokeScore::width_error_mm,
               &brushsvg::StrokeScore::excess_turning, &brushsvg::StrokeScore::worst);

template <>
inline constexpr auto members<brushsvg::CommonArea> =
    std::tuple(&brushsvg::CommonArea::intersection_mm2, &brushsvg::CommonArea::union_mm2);

template <>
inline constexpr auto members<brushsvg::AxisBranch> = std::tuple(
    &brushsvg::AxisBranch::from, &brushsvg::AxisBranch::to, &brushsvg::AxisBranch::line, &brushsvg::AxisBranch::part);
