#include "brushsvg/brush.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/format_text.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/student_t.hpp"

namespace brushsvg {
namespace {

constexpr double kMaxDepthMm = 1000.0;  // no brush is longer, and plans grow with the depth
constexpr double kMaxLawValueMm = 1000.0;
constexpr std::size_t kMaxOutlines = 1000;
constexpr Eigen::Index kMaxVertices = 2000;                     // of an outline: all pairs are compared
constexpr std::array<double, 2> kSpeedRangeMmS{0.01, 10000.0};  // mm/s; a program writes feeds in steps of 0.1 mm/min
/// Least half width that has a depth, as a share of the greatest one: lines may taper to nothing, no depth is 0.
constexpr double kMinWidthShare = 1e-6;
constexpr double kMaxInvisibleErrorMm = 0.05;  // largest invisible error of a mark's edge: the default tolerance
// Largest RMSE relative to the law. The worst law of the article, the tip gap from angles, has 0.6.
constexpr double kMaxRmseShare = 0.3;
constexpr double kMaxCorrelationError = 1e-4;  // error of a correlation when a covariance is rounded to five digits
constexpr double kMaxLawOutlineDifferenceMm = 0.5;  // outlines determine the mark, laws the inverse: they must agree

std::array<std::pair<const Profile*, const char*>, 4> laws(const Brush& brush) {
    return {{{&brush.lag, "lag"},
             {&brush.tip_gap, "tip_gap"},
             {&brush.tip_to_widest, "tip_to_widest"},
             {&brush.half_width, "half_width"}}};
}

/// The least value of a profile over the depth range, and its depth.
struct LawMinimum {
    double depth, value;
};
LawMinimum find_minimum(const Profile& profile, double lo, double hi) {
    LawMinimum found{lo, profile(lo)};
    for (const PolynomialPiece& piece : pieces(profile, lo, hi)) {
        std::vector<double> slope;
        for (std::size_t i = 1; i < piece.coefficients.size(); ++i) slope.push_back(double(i) * piece.coefficients[i]);
        std::vector<double> candidates = real_roots(slope, piece.lo, piece.hi);
        candidates.push_back(piece.lo);
        candidates.push_back(piece.hi);
        for (double d : candidates)
            if (profile(d) < found.value) found = {d, profile(d)};
    }
    return found;
}

struct Decrease {
    double mm, from_mm, to_mm;
};

/// Returns the greatest decrease of a law from one depth to a greater one.
Decrease find_greatest_decrease(const Profile& profile, double lo, double hi) {
    Decrease fall{0.0, lo, lo};
    double highest_at = lo;
    for (int i = 1; i <= 400; ++i) {
        const double d = lo + (hi - lo) * i / 400;
        if (profile(d) > profile(highest_at)) highest_at = d;
        if (const double mm = profile(highest_at) - profile(d); mm > fall.mm) fall = {mm, highest_at, d};
    }
    return fall;
}

void check_lag(const Brush& brush) {
    const auto [lo, hi] = brush.depth_range_mm;
    if (brush.is_rigid()) {
        for (int i = 0; i <= 100; ++i) {
            const double d = lo + (hi - lo) * i / 100, e = brush.tip_to_widest(d) - brush.tip_gap(d);
            if (!(std::abs(e) <= kMaxInvisibleErrorMm))
                throw Error(
                    "pen-off-centre",
                    format_text(
                        "the lag is zero, but at depth %.2f mm the mark is widest %.3f mm from the contact, "
                        "outside the range [-0.05, 0.05] mm: measure the lag, or set tip_to_widest equal to tip_gap",
                        d, e),
                    "lag", e, std::array<double, 2>{-kMaxInvisibleErrorMm, kMaxInvisibleErrorMm});
        }
        return;
    }
    // A brush passes smaller depths than its range has when it is set down and lifted.
    const LawMinimum worst = find_minimum(brush.lag, 0.0, hi);
    if (worst.value < 0.0)
        throw Error(
            "law-negative",
            format_text(
                "the lag is %.3f mm at depth %.2f mm, but must be at least 0 from depth 0 to %.2f mm: correct its "
                "coefficients, or measure the lag near that depth and fit the law again",
                worst.value, worst.depth, hi),
            "lag", worst.value, std::array<double, 2>{0.0, INFINITY});
    // A lag of zero is only valid at depth 0, where the lever begins to grow.
    const LawMinimum inside = find_minimum(brush.lag, lo + 1e-3 * (hi - lo), hi);
    if (!(inside.value > 0.0))
        throw Error(
            "law-zero",
            format_text(
                "the lag is zero at depth %.2f mm but not at all depths: correct its coefficients so that the lag "
                "is positive, or set all of them to 0 for a rigid pen",
                inside.depth),
            "lag", 0.0, std::array<double, 2>{0.0, INFINITY});
}

void check_half_width(const Brush& brush) {
    const auto [lo, hi] = brush.depth_range_mm;
    double before = brush.half_width(lo);
    if (before < 0.0)
        throw Error(
            "law-negative",
            format_text(
                "the half width is %.3f mm at depth %.2f mm, but must be at least 0: correct its coefficients, or "
                "begin depth_range_mm at a greater depth",
                before, lo),
            "half_width", before, std::array<double, 2>{0.0, INFINITY});
    constexpr int n = 1000;
    for (int i = 1; i <= n; ++i) {
        const double d = lo + (hi - lo) * i / n, now = brush.half_width(d);
        if (now < before - 1e-9)
            throw Error(
                "width-falls",
                format_text(
                    "the half width falls at depth %.2f mm, but a mark cannot get narrower as the brush is pressed: "
                    "correct its coefficients, or end depth_range_mm before that depth",
                    d),
                "half_width", d, brush.depth_range_mm);
        before = now;
    }
    if (!(before > 0.0))
        throw Error(
            "law-zero",
            format_text("the half width is zero at all depths from %.2f to %.2f mm: correct its coefficients", lo, hi),
            "half_width");
}

void check_range(const Profile& law, double lo, double hi, const char* where) {
    for (int i = 0; i <= 100; ++i) {
        const double d = lo + (hi - lo) * i / 100, value = law(d);
        if (!(std::abs(value) <= kMaxLawValueMm))
            throw Error(
                "out-of-range",
                format_text(
                    "the law gives %.4g mm at depth %.2f mm, outside the range [-%.0f, %.0f] mm: check the units "
                    "and the order of its coefficients, which multiply ascending powers of the depth in mm",
                    value, d, kMaxLawValueMm, kMaxLawValueMm),
                where, value, std::array<double, 2>{-kMaxLawValueMm, kMaxLawValueMm});
    }
    if (const auto& measured = law.calibrated_mm;
        measured && !((*measured)[0] < (*measured)[1] && (*measured)[0] < hi && (*measured)[1] > lo))
        throw Error(
            "out-of-range",
            format_text(
                "calibrated_mm is [%.4g, %.4g] mm, but must ascend and overlap the depth range [%.4g, %.4g] mm: enter "
                "the least and the greatest measured depth",
                (*measured)[0], (*measured)[1], lo, hi),
            where);
    const auto refuse_negative = [&](const char* key, double value) {
        if (!(value >= 0.0))
            throw Error("out-of-range", format_text("%s contains %.4g, but must be at least 0", key, value), where,
                        value, std::array<double, 2>{0.0, INFINITY});
    };
    for (const double half : law.half_interval_95) refuse_negative("half_interval_95", half);
    if (law.rmse_mm) refuse_negative("rmse_mm", *law.rmse_mm);
}

/// Throws Error unless the covariance is symmetric, positive semi-definite within rounding errors, and gives no law a
/// standard deviation above the largest permitted value of a law.
void check_covariance(const Brush& brush) {
    if (brush.covariance.empty()) return;
    const Eigen::Index n = Eigen::Index(brush.covariance.size());
    Eigen::MatrixXd c(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const std::vector<double>& row = brush.covariance[std::size_t(i)];
        if (Eigen::Index(row.size()) != n)
            throw Error(
                "covariance-invalid",
                format_text("row %.0f of the covariance has %.0f numbers, but there are %.0f rows: a covariance has "
                            "as many columns as rows",
                            double(i), double(row.size()), double(n)),
                "covariance");
        c.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), n);
    }
    if (!c.allFinite()) throw Error("not-finite", "the covariance contains a number that is not finite", "covariance");
    const Eigen::VectorXd least = c.diagonal().cwiseMax(1e-24).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd correlation = least.asDiagonal() * c * least.asDiagonal();
    for (Eigen::Index i = 0; i < n; ++i) {
        const std::string here = "covariance[" + std::to_string(i) + "]";
        if (correlation(i, i) < -kMaxCorrelationError)
            throw Error(
                "covariance-invalid",
                format_text(
                    "the variance is %.4g, but must be at least 0: compute the covariance again, or leave it out",
                    c(i, i)),
                here + "[" + std::to_string(i) + "]", c(i, i), std::array<double, 2>{0.0, INFINITY});
        for (Eigen::Index j = 0; j < i; ++j)
            if (!(std::abs(correlation(i, j) - correlation(j, i)) <= kMaxCorrelationError))
                throw Error("covariance-invalid",
                            format_text("the covariance is not symmetric, because %.4g differs from the mirrored "
                                        "number %.4g: compute it again, or leave it out",
                                        c(i, j), c(j, i)),
                            here + "[" + std::to_string(j) + "]");
    }
    const Eigen::MatrixXd raised = correlation + kMaxCorrelationError * Eigen::MatrixXd::Identity(n, n);
    if (raised.llt().info() != Eigen::Success)
        throw Error("covariance-invalid",
                    "the covariance is not positive semi-definite, so some sum of the coefficients would have a "
                    "negative variance: compute it again, or leave it out",
                    "covariance");
    Eigen::Index total = 0;
    for (const auto& [law, where] : laws(brush)) total += Eigen::Index(law->coefficients.size());
    if (total != n)
        throw Error("covariance-invalid",
                    format_text("the covariance must have %.0f rows, one per coefficient of the laws, not %.0f",
                                double(total), double(n)),
                    "covariance", double(n));
    Eigen::Index first = 0;
    for (const auto& [law, where] : laws(brush)) {
        const Eigen::Index count = Eigen::Index(law->coefficients.size());
        for (double depth : {brush.depth_range_mm[0], brush.depth_range_mm[1]}) {
            Eigen::VectorXd powers = Eigen::VectorXd::Ones(count);
            for (Eigen::Index i = 1; i < count; ++i) powers[i] = powers[i - 1] * depth;
            const double half_interval =
                interval_factor_95(law->degrees_of_freedom) *
                std::sqrt(std::max(0.0, powers.dot(c.block(first, first, count, count) * powers)));
            if (!(half_interval <= kMaxLawValueMm))
                throw Error(
                    "out-of-range",
                    format_text("the covariance gives the law a 95 %% interval of +- %.3g mm at depth %.2f mm, but at "
                                "most %.0f mm are allowed: compute it again, or leave it out",
                                half_interval, depth, kMaxLawValueMm),
                    where, half_interval, std::array<double, 2>{0.0, kMaxLawValueMm});
        }
        first += count;
    }
}

bool crosses_itself(const Ring& p) {
    const Eigen::Index n = p.rows();
    const auto side = [&](Eigen::Index a, Eigen::Index b, Eigen::Index c) {
        return (p(b, 0) - p(a, 0)) * (p(c, 1) - p(a, 1)) - (p(b, 1) - p(a, 1)) * (p(c, 0) - p(a, 0));
    };
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = i + 2; j < n; ++j) {
            if (i == 0 && j == n - 1) continue;
            const Eigen::Index i1 = (i + 1) % n, j1 = (j + 1) % n;
            if (side(i, i1, j) * side(i, i1, j1) < 0.0 && side(j, j1, i) * side(j, j1, i1) < 0.0) return true;
        }
    return false;
}

void check_shapes(const Brush& brush, const std::vector<Footprint>& shapes, const std::string& where) {
    double depth_before = 0.0;
    if (shapes.size() > kMaxOutlines)
        throw Error("footprint-invalid",
                    format_text("there are %.0f outlines, but at most %.0f are allowed: keep fewer depths",
                                double(shapes.size()), double(kMaxOutlines)),
                    where);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const Footprint& shape = shapes[i];
        const std::string here = where + "[" + std::to_string(i) + "]";
        const double d = shape.depth_mm;
        if (!(d <= kMaxLawValueMm) || !(d > depth_before))
            throw Error(
                "not-ascending",
                format_text("depth %.3f mm is outside the range (%.3f, 1000] mm: sort the outlines by ascending depth",
                            d, depth_before),
                here, d);
        depth_before = d;
        if (!shape.outline_mm.allFinite())
            throw Error("not-finite", "the outline has a coordinate that is not finite", here);
        const double largest = shape.outline_mm.size() > 0 ? shape.outline_mm.cwiseAbs().maxCoeff() : 0.0;
        if (!(largest <= kMaxLawValueMm))
            throw Error(
                "out-of-range",
                format_text("the outline has a coordinate of %.4g mm, but at most %.0f mm are allowed: check its unit",
                            largest, kMaxLawValueMm),
                here, largest, std::array<double, 2>{0.0, kMaxLawValueMm});
        if (shape.outline_mm.rows() > kMaxVertices)
            throw Error("footprint-invalid",
                        format_text("the outline has %.0f vertices, but at most %.0f are allowed: simplify it",
                                    double(shape.outline_mm.rows()), double(kMaxVertices)),
                        here);
        if (shape.outline_mm.rows() < 3)
            throw Error(
                "footprint-invalid",
                format_text("the outline has %.0f vertices, but needs at least 3", double(shape.outline_mm.rows())),
                here);
        if (shape.outline_mm.rows() != brush.footprints.vertex_count())
            throw Error(
                "footprint-invalid",
                format_text(
                    "the outline has %.0f vertices, but the first outline has %.0f: give all outlines the same number",
                    double(shape.outline_mm.rows()), double(brush.footprints.vertex_count())),
                here);
        if (shape.outline_mm.row(0).norm() > 1e-9)
            throw Error(
                "footprint-invalid",
                format_text("the outline begins at (%.4g, %.4g) mm, but must begin at the tip, (0, 0): move its origin "
                            "to the tip and list the tip first",
                            shape.outline_mm(0, 0), shape.outline_mm(0, 1)),
                here);
        if (!(signed_area(shape.outline_mm) > 0.0))
            throw Error("footprint-invalid", "the outline is clockwise: list its vertices counter-clockwise", here);
        if (crosses_itself(shape.outline_mm))
            throw Error("footprint-invalid", "the outline crosses itself: list its vertices in order along the edge",
                        here);
        if (d > brush.depth_range_mm[1]) continue;
        const WidestSection seen = widest_section(shape.outline_mm);
        // Several sections may be equally wide. The law must match one of them.
        const double x_law = brush.tip_to_widest(d), h_law = brush.half_width(d);
        if (std::abs(seen.half_width_mm - h_law) > kMaxLawOutlineDifferenceMm)
            throw Error("footprint-against-law",
                        format_text("at depth %.2f mm the outline has a half width of %.2f mm, but the law half_width "
                                    "gives %.2f mm: correct one of them, they may differ by 0.5 mm at most",
                                    d, seen.half_width_mm, h_law),
                        here, seen.half_width_mm, std::array<double, 2>{h_law - 0.5, h_law + 0.5});
        if (std::abs(seen.from_tip_mm - x_law) > kMaxLawOutlineDifferenceMm)
            throw Error(
                "footprint-against-law",
                format_text("at depth %.2f mm the outline is widest %.2f mm from the tip, but the law "
                            "tip_to_widest gives %.2f mm: correct one of them, they may differ by 0.5 mm at most",
                            d, seen.from_tip_mm, x_law),
                here, seen.from_tip_mm, std::array<double, 2>{x_law - 0.5, x_law + 0.5});
    }
}

/** Returns a positive number, rounded down to two significant digits. */
double round_down(double number) {
    const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
    return std::floor(number / unit) * unit;
}

}  // namespace

bool Brush::is_rigid() const {
    return std::all_of(lag.coefficients.begin(), lag.coefficients.end(), [](double c) { return c == 0.0; }) &&
           (std::isinf(lag.floor) || (lag.floor == 0.0 && lag.floor_slope == 0.0));
}

std::array<double, 2> Brush::half_width_range_mm() const {
    return {half_width(depth_range_mm[0]), half_width(depth_range_mm[1])};
}

bool Brush::width_follows_depth() const {
    const auto [narrow, wide] = half_width_range_mm();
    return wide - narrow > 1e-9;
}

double Brush::depth_for_half_width(double half_width_mm, const std::string& where) const {
    if (!width_follows_depth()) return paint_depth_mm;
    const auto [narrow, wide] = half_width_range_mm();
    const double rounding = 1e-9 * wide;  // of a width after conversion from text and units
    if (!(half_width_mm >= narrow - rounding && half_width_mm <= wide + rounding))
        throw Error("width-out-of-reach",
                    format_text("width %.3f mm is outside the range [%.3f, %.3f] mm", 2.0 * half_width_mm, 2.0 * narrow,
                                2.0 * wide) +
                        " that brush " + name + " can paint: " +
                        (half_width_mm > narrow
                             ? format_text("draw it narrower, scale the drawing to %.2g, make the line a filled shape,",
                                           round_down(wide / half_width_mm))
                             : std::string("draw it wider")) +
                        " or use another brush",
                    where, 2.0 * half_width_mm, std::array<double, 2>{2.0 * narrow, 2.0 * wide});
    half_width_mm = std::max(half_width_mm, kMinWidthShare * wide);
    double a = depth_range_mm[0], b = depth_range_mm[1];
    // At depth 0 a brush only touches the paper, and a program that goes no deeper paints nothing.
    if (a == 0.0 && narrow > 0.0)
        half_width_mm = std::max(half_width_mm, std::min(narrow + kMaxInvisibleErrorMm, wide));
    if (half_width.coefficients.size() == 2 && std::isinf(half_width.floor))
        return std::clamp((half_width_mm - half_width.coefficients[0]) / half_width.coefficients[1], a, b);
    for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (a + b);
        if (!(a < middle && middle < b)) break;
        (half_width(middle) < half_width_mm ? a : b) = middle;
    }
    return b;
}

void require_known_kind(const Brush& brush) {
    if (!brush.kind.empty() && std::find(kBrushKinds.begin(), kBrushKinds.end(), brush.kind) == kBrushKinds.end()) {
        std::string known;
        for (const char* kind : kBrushKinds) known += (known.empty() ? "" : ", ") + std::string(kind);
        throw Error("choice-unknown",
                    "brushes of kind " + brush.kind.substr(0, 40) + " are not simulated (known: " + known +
                        "): use round if the footprint is the same in every direction",
                    "kind");
    }
}

void check(const Brush& brush) {
    const auto [lo, hi] = brush.depth_range_mm;
    if (brush.name.empty() ||
        std::any_of(brush.name.begin(), brush.name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
        throw Error("name-invalid", "the name must be one line of text, not empty and without control characters",
                    "name");
    require_known_kind(brush);
    if (!(std::isfinite(lo) && std::isfinite(hi) && lo >= 0.0 && hi > lo && hi <= kMaxDepthMm))
        throw Error(
            "out-of-range",
            format_text("the depth range is [%.4g, %.4g] mm, but must be two ascending depths within [0, %.0f] mm", lo,
                        hi, kMaxDepthMm),
            "depth_range_mm");
    for (const auto& [profile, where] : laws(brush)) {
        require_law_degree(profile->coefficients, where);
        for (double c : profile->coefficients)
            if (!std::isfinite(c)) throw Error("not-finite", "the law has a coefficient that is not finite", where);
        check_range(*profile, lo, hi, where);
    }
    check_covariance(brush);
    if (brush.paint) check(*brush.paint);
    check_lag(brush);
    check_half_width(brush);
    if (brush.footprints.dragged.empty())
        throw Error("footprint-invalid", "there is no outline, but at least one is needed", "footprints.dragged");
    check_shapes(brush, brush.footprints.dragged, "footprints.dragged");
    check_shapes(brush, brush.footprints.pressed, "footprints.pressed");
    if (!(brush.max_speed_mm_s >= kSpeedRangeMmS[0] && brush.max_speed_mm_s <= kSpeedRangeMmS[1]))
        throw Error("out-of-range",
                    format_text("the speed limit %.3g mm/s is outside the range [%.2f, %.0f] mm/s",
                                brush.max_speed_mm_s, kSpeedRangeMmS[0], kSpeedRangeMmS[1]),
                    "max_speed_mm_s", brush.max_speed_mm_s, kSpeedRangeMmS);
    const double paints = brush.paint_depth_mm;
    if (!brush.width_follows_depth() && !(paints > 0.0))
        throw Error(
            "out-of-range",
            format_text(
                "the painting depth is %.2f mm, but must be greater than 0, because the width does not depend on the "
                "depth: set paint_depth_mm to a depth within [%.2f, %.2f] mm",
                paints, lo, hi),
            "paint_depth_mm", paints, brush.depth_range_mm);
    if (!(paints == 0.0 || (paints >= lo && paints <= hi)))
        throw Error("out-of-range",
                    format_text("the painting depth %.2f mm is outside the range [%.2f, %.2f] mm", paints, lo, hi),
                    "paint_depth_mm", paints, brush.depth_range_mm);
}

constexpr const char* kLawAssumed = "the law is assumed, not measured: calibrate the brush to measure it";

std::vector<Warning> remarks(const Brush& brush) {
    std::vector<Warning> out;
    const auto [lo, hi] = brush.depth_range_mm;
    for (const auto& [profile, where] : laws(brush)) {
        if (profile->assumed) out.push_back(Warning{"law-assumed", where, kLawAssumed});
        if (profile->calibrated_mm && ((*profile->calibrated_mm)[0] > lo || (*profile->calibrated_mm)[1] < hi))
            out.push_back(Warning{
                "depth-not-measured", where,
                format_text("the law was measured from depth %.2f to %.2f mm, but the brush may be used from %.2f "
                            "to %.2f mm",
                            (*profile->calibrated_mm)[0], (*profile->calibrated_mm)[1], lo, hi)});
    }
    if (brush.paint && brush.paint->assumed) out.push_back(Warning{"law-assumed", "paint", kLawAssumed});
    if (!brush.is_rigid()) {
        bool falls = true, gap = true;
        for (int i = 1; i <= 200; ++i) {
            const double d = lo + (hi - lo) * i / 200, before = lo + (hi - lo) * (i - 0.5) / 200;
            falls = falls && brush.lag(d) * before <= brush.lag(before) * d + 1e-12;
            gap = gap && brush.tip_gap(d) >= 0.0;
        }
        if (!falls)
            out.push_back(
                Warning{"pressed-on-the-spot", "lag",
                        "the lag divided by the depth rises at some depths, so a landing in motion would drag the "
                        "patch: the brush is pressed down in place before it moves"});
        if (!gap)
            out.push_back(Warning{"contact-outside-footprint", "tip_gap",
                                  "the tip gap is negative at some depths, so the centre of friction is outside the "
                                  "footprint: measure the tip gap again"});
        const Decrease fall = find_greatest_decrease(brush.lag, lo, hi);
        if (fall.mm > kMaxInvisibleErrorMm)
            out.push_back(Warning{
                "law-falls", "lag",
                format_text("the lag falls by %.2f mm from depth %.2f to %.2f mm, but bristles that are pressed deeper "
                            "usually trail further: measure the lag again at these depths",
                            fall.mm, fall.from_mm, fall.to_mm)});
        for (const Footprint& shape : brush.footprints.dragged) {
            if (shape.outline_mm.rows() == 0) continue;
            const double front = shape.outline_mm.col(0).maxCoeff(), contact = brush.tip_gap(shape.depth_mm);
            if (!(shape.depth_mm <= hi && contact > front + kMaxInvisibleErrorMm)) continue;
            out.push_back(Warning{"contact-outside-footprint", "tip_gap",
                                  format_text("at depth %.2f mm the centre of friction is %.2f mm from the tip, "
                                              "beyond the footprint, which is %.2f mm long: measure the tip gap again",
                                              shape.depth_mm, contact, front)});
            break;
        }
    }
    for (const auto& [profile, where] : laws(brush)) {
        const double largest = std::max(std::abs((*profile)(lo)), std::abs((*profile)(hi)));
        if (profile->rmse_mm && *profile->rmse_mm > kMaxRmseShare * largest)
            out.push_back(Warning{
                "law-scatters", where,
                format_text("the measurements scatter by %.2f mm around a law of at most %.2f mm: measure again, or "
                            "take more measurements",
                            *profile->rmse_mm, largest)});
    }
    if (!brush.width_follows_depth())
        out.push_back(
            Warning{"widths-ignored", "half_width",
                    format_text("the width does not depend on depth: drawn widths are ignored and every stroke is "
                                "%.2f mm wide",
                                2.0 * brush.half_width(hi))});
    if (brush.footprints.pressed.empty())
        out.push_back(
            Warning{"footprint-assumed", "footprints.pressed",
                    "there is no outline of the brush pressed straight down: the dragged one is used instead"});
    return out;
}

}  // namespace brushsvg
