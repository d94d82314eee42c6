#include "brushsvg/brush.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "brushsvg/error.hpp"
#include "brushsvg/student_t.hpp"

namespace brushsvg {
namespace {

template <class... Numbers>
std::string format(const char* pattern, Numbers... numbers) {
    char text[256];
    std::snprintf(text, sizeof text, pattern, numbers...);
    return text;
}

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
                    format("the lag is zero, so the mark has no heading, but at depth %.2f mm it is widest %.2f "
                           "mm away from where it touches",
                           d, e),
                    "lag", e, std::array<double, 2>{-kMaxInvisibleErrorMm, kMaxInvisibleErrorMm});
        }
        return;
    }
    // A brush passes smaller depths than its range has when it is set down and lifted.
    const LawMinimum worst = find_minimum(brush.lag, 0.0, hi);
    if (worst.value < 0.0)
        throw Error("law-negative",
                    format("the lag is %.3f mm at depth %.2f mm; it must not be negative between depths 0.00 and ",
                           worst.value, worst.depth) +
                        format("%.2f mm", hi),
                    "lag", worst.value, std::array<double, 2>{0.0, INFINITY});
    // A lag of zero is only valid at depth 0, where the lever begins to grow.
    const LawMinimum inside = find_minimum(brush.lag, lo + 1e-3 * (hi - lo), hi);
    if (!(inside.value > 0.0))
        throw Error("law-zero",
                    format("the lag is zero at depth %.2f mm but not everywhere: a brush lags over its whole range, a "
                           "rigid pen nowhere",
                           inside.depth),
                    "lag", 0.0, std::array<double, 2>{0.0, INFINITY});
}

void check_half_width(const Brush& brush) {
    const auto [lo, hi] = brush.depth_range_mm;
    double before = brush.half_width(lo);
    if (before < 0.0)
        throw Error("law-negative",
                    format("the half width is %.3f mm at depth %.2f mm; it must not be negative", before, lo),
                    "half_width");
    constexpr int n = 1000;
    for (int i = 1; i <= n; ++i) {
        const double d = lo + (hi - lo) * i / n, now = brush.half_width(d);
        if (now < before - 1e-9)
            throw Error("width-falls",
                        format("the half width falls at depth %.2f mm; it must not fall as the brush is pressed", d),
                        "half_width", d, brush.depth_range_mm);
        before = now;
    }
    if (!(before > 0.0)) throw Error("law-zero", "the half width is zero over the whole depth range", "half_width");
}

void check_range(const Profile& law, double lo, double hi, const char* where) {
    for (int i = 0; i <= 100; ++i) {
        const double d = lo + (hi - lo) * i / 100, value = law(d);
        if (!(std::abs(value) <= kMaxLawValueMm))
            throw Error("out-of-range",
                        format("the law says %.4g mm at depth %.2f mm; no more than %.0f mm is taken for true", value,
                               d, kMaxLawValueMm),
                        where, value, std::array<double, 2>{-kMaxLawValueMm, kMaxLawValueMm});
    }
    if (const auto& measured = law.calibrated_mm;
        measured && !((*measured)[0] < (*measured)[1] && (*measured)[0] < hi && (*measured)[1] > lo))
        throw Error(
            "out-of-range",
            format("it was measured in [%.4g, %.4g] mm, which must rise and meet the depth range [%.4g, %.4g] mm",
                   (*measured)[0], (*measured)[1], lo, hi),
            where);
    const auto& half = law.half_interval_95;
    if (std::any_of(half.begin(), half.end(), [](double value) { return !(value >= 0.0); }) ||
        (law.rmse_mm && !(*law.rmse_mm >= 0.0)))
        throw Error("out-of-range", "an interval or rmse_mm is negative", where);
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
                format("a row of covariance holds %.0f numbers, its columns %.0f", double(row.size()), double(n)),
                "covariance");
        c.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), n);
    }
    if (!c.allFinite()) throw Error("not-finite", "a number is not finite", "covariance");
    const Eigen::VectorXd least = c.diagonal().cwiseMax(1e-24).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd correlation = least.asDiagonal() * c * least.asDiagonal();
    for (Eigen::Index i = 0; i < n; ++i) {
        const std::string here = "covariance[" + std::to_string(i) + "]";
        if (correlation(i, i) < -kMaxCorrelationError)
            throw Error("covariance-invalid", format("the variance %.4g must not be negative", c(i, i)),
                        here + "[" + std::to_string(i) + "]", c(i, i), std::array<double, 2>{0.0, INFINITY});
        for (Eigen::Index j = 0; j < i; ++j)
            if (!(std::abs(correlation(i, j) - correlation(j, i)) <= kMaxCorrelationError))
                throw Error(
                    "covariance-invalid",
                    format("%.4g differs from %.4g on the other side: a covariance is symmetric", c(i, j), c(j, i)),
                    here + "[" + std::to_string(j) + "]");
    }
    const Eigen::MatrixXd raised = correlation + kMaxCorrelationError * Eigen::MatrixXd::Identity(n, n);
    if (raised.llt().info() != Eigen::Success)
        throw Error(
            "covariance-invalid",
            "some sum of the coefficients would have a negative variance: a covariance is positive semi-definite",
            "covariance");
    Eigen::Index first = 0;
    for (const auto& [law, where] : laws(brush)) {
        const Eigen::Index count = Eigen::Index(law->coefficients.size());
        if (first + count > n)
            throw Error("covariance-invalid", "covariance must have one row per coefficient", "covariance");
        for (double depth : {brush.depth_range_mm[0], brush.depth_range_mm[1]}) {
            Eigen::VectorXd powers = Eigen::VectorXd::Ones(count);
            for (Eigen::Index i = 1; i < count; ++i) powers[i] = powers[i - 1] * depth;
            const double half_interval =
                interval_factor_95(law->degrees_of_freedom) *
                std::sqrt(std::max(0.0, powers.dot(c.block(first, first, count, count) * powers)));
            if (!(half_interval <= kMaxLawValueMm))
                throw Error("out-of-range",
                            format("by the covariance the law is known to +- %.3g mm at depth %.2f mm; no more than "
                                   "%.0f mm is taken for true",
                                   half_interval, depth, kMaxLawValueMm),
                            where, half_interval, std::array<double, 2>{0.0, kMaxLawValueMm});
        }
        first += count;
    }
    if (first != n) throw Error("covariance-invalid", "covariance must have one row per coefficient", "covariance");
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
        throw Error(
            "footprint-invalid",
            format("there are %.0f outlines; at most %.0f are read", double(shapes.size()), double(kMaxOutlines)),
            where);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const Footprint& shape = shapes[i];
        const std::string here = where + "[" + std::to_string(i) + "]";
        const double d = shape.depth_mm;
        if (!(d <= kMaxLawValueMm) || !(d > depth_before))
            throw Error("not-ascending",
                        format("depth %.3f mm is not greater than the one before, %.3f mm, and at most 1000 mm", d,
                               depth_before),
                        here, d);
        depth_before = d;
        if (!shape.outline_mm.allFinite())
            throw Error("not-finite", "the outline has a coordinate that is not finite", here);
        const double largest = shape.outline_mm.size() > 0 ? shape.outline_mm.cwiseAbs().maxCoeff() : 0.0;
        if (!(largest <= kMaxLawValueMm))
            throw Error("out-of-range",
                        format("the outline reaches %.4g mm from the tip; no brush is larger than %.0f mm", largest,
                               kMaxLawValueMm),
                        here, largest, std::array<double, 2>{0.0, kMaxLawValueMm});
        if (shape.outline_mm.rows() > kMaxVertices)
            throw Error("footprint-invalid",
                        format("the outline has %.0f vertices; at most %.0f are read", double(shape.outline_mm.rows()),
                               double(kMaxVertices)),
                        here);
        if (shape.outline_mm.rows() < 3)
            throw Error("footprint-invalid", "the outline needs at least 3 vertices", here);
        if (shape.outline_mm.rows() != brush.footprints.vertex_count())
            throw Error("footprint-invalid",
                        format("the outline has %.0f vertices where the first one has %.0f; all depths need the same",
                               double(shape.outline_mm.rows()), double(brush.footprints.vertex_count())),
                        here);
        if (shape.outline_mm.row(0).norm() > 1e-9)
            throw Error("footprint-invalid", "the outline's first vertex is not the tip at (0, 0)", here);
        if (!(signed_area(shape.outline_mm) > 0.0))
            throw Error("footprint-invalid", "the outline does not run counter-clockwise", here);
        if (crosses_itself(shape.outline_mm)) throw Error("footprint-invalid", "the outline crosses itself", here);
        if (d > brush.depth_range_mm[1]) continue;
        const WidestSection seen = widest_section(shape.outline_mm);
        // Several sections may be equally wide. The law must match one of them.
        const double x_law = brush.tip_to_widest(d), h_law = brush.half_width(d);
        if (std::abs(seen.half_width_mm - h_law) > kMaxLawOutlineDifferenceMm)
            throw Error(
                "footprint-against-law",
                format("at depth %.2f mm the outline is %.2f mm wide on each side but half_width says %.2f mm; they "
                       "must agree to 0.5 mm",
                       d, seen.half_width_mm, h_law),
                here, seen.half_width_mm, std::array<double, 2>{h_law - 0.5, h_law + 0.5});
        if (std::abs(seen.from_tip_mm - x_law) > kMaxLawOutlineDifferenceMm)
            throw Error(
                "footprint-against-law",
                format("at depth %.2f mm the outline is widest %.2f mm from the tip but tip_to_widest says %.2f mm; "
                       "they must agree to 0.5 mm",
                       d, seen.from_tip_mm, x_law),
                here, seen.from_tip_mm, std::array<double, 2>{x_law - 0.5, x_law + 0.5});
    }
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
                    format("width %.3f mm is outside the range [%.3f, %.3f] mm", 2.0 * half_width_mm, 2.0 * narrow,
                           2.0 * wide) +
                        " that brush " + name + " can paint: " +
                        (half_width_mm > narrow
                             ? format("draw it narrower, scale the drawing to %.2f, or make the line a filled shape",
                                      std::floor(100.0 * wide / half_width_mm) / 100.0)
                             : std::string("draw it wider")) +
                        ", or take another brush",
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
                        "). Use round if its footprint is the same in every direction",
                    "kind");
    }
}

void check(const Brush& brush) {
    const auto [lo, hi] = brush.depth_range_mm;
    if (brush.name.empty() ||
        std::any_of(brush.name.begin(), brush.name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
        throw Error("name-invalid", "the name must be one line of text", "name");
    require_known_kind(brush);
    if (!(std::isfinite(lo) && std::isfinite(hi) && lo >= 0.0 && hi > lo && hi <= kMaxDepthMm))
        throw Error("out-of-range",
                    format("the depth range [%.4g, %.4g] mm must rise within [0, %.0f] mm", lo, hi, kMaxDepthMm),
                    "depth_range_mm");
    for (const auto& [profile, where] : laws(brush)) {
        require_law_degree(profile->coefficients, where);
        for (double c : profile->coefficients)
            if (!std::isfinite(c)) throw Error("not-finite", "a coefficient is not finite", where);
        check_range(*profile, lo, hi, where);
    }
    check_covariance(brush);
    if (brush.paint) check(*brush.paint);
    check_lag(brush);
    check_half_width(brush);
    if (brush.footprints.dragged.empty()) throw Error("footprint-invalid", "there is no outline", "footprints.dragged");
    check_shapes(brush, brush.footprints.dragged, "footprints.dragged");
    check_shapes(brush, brush.footprints.pressed, "footprints.pressed");
    if (!(brush.max_speed_mm_s >= kSpeedRangeMmS[0] && brush.max_speed_mm_s <= kSpeedRangeMmS[1]))
        throw Error("out-of-range",
                    format("the speed limit %.3g mm/s is outside the range [%.2f, %.0f] mm/s", brush.max_speed_mm_s,
                           kSpeedRangeMmS[0], kSpeedRangeMmS[1]),
                    "max_speed_mm_s", brush.max_speed_mm_s, kSpeedRangeMmS);
    const double paints = brush.paint_depth_mm;
    if (!brush.width_follows_depth() && !(paints > 0.0))
        throw Error("out-of-range",
                    format("the painting depth %.2f mm must be greater than 0, for the width does not follow the depth",
                           paints),
                    "paint_depth_mm", paints, brush.depth_range_mm);
    if (!(paints == 0.0 || (paints >= lo && paints <= hi)))
        throw Error("out-of-range",
                    format("the painting depth %.2f mm is outside the range [%.2f, %.2f] mm", paints, lo, hi),
                    "paint_depth_mm", paints, brush.depth_range_mm);
}

std::vector<Warning> remarks(const Brush& brush) {
    std::vector<Warning> out;
    const auto [lo, hi] = brush.depth_range_mm;
    for (const auto& [profile, where] : laws(brush)) {
        if (profile->assumed) out.push_back(Warning{"law-assumed", where, "the law is assumed, not measured"});
        if (profile->calibrated_mm && ((*profile->calibrated_mm)[0] > lo || (*profile->calibrated_mm)[1] < hi))
            out.push_back(Warning{"depth-not-measured", where,
                                  format("the law was measured between depths %.2f and %.2f mm, the brush may be used ",
                                         (*profile->calibrated_mm)[0], (*profile->calibrated_mm)[1]) +
                                      format("from %.2f to %.2f mm", lo, hi)});
    }
    if (brush.paint && brush.paint->assumed)
        out.push_back(Warning{"law-assumed", "paint", "the law is assumed, not measured"});
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
                        "lag over depth rises somewhere: a landing that presses while running would drag the patch, "
                        "so the brush is pressed down on the spot before it runs"});
        if (!gap)
            out.push_back(Warning{"contact-outside-footprint", "tip_gap",
                                  "the centre of friction is outside the footprint at some depths"});
        const Decrease fall = find_greatest_decrease(brush.lag, lo, hi);
        if (fall.mm > kMaxInvisibleErrorMm)
            out.push_back(
                Warning{"law-falls", "lag",
                        format("the lag falls by %.2f mm from depth %.2f ", fall.mm, fall.from_mm) +
                            format("to %.2f mm: bristles that are pressed deeper usually trail farther", fall.to_mm)});
        for (const Footprint& shape : brush.footprints.dragged) {
            if (shape.outline_mm.rows() == 0) continue;
            const double front = shape.outline_mm.col(0).maxCoeff(), contact = brush.tip_gap(shape.depth_mm);
            if (!(shape.depth_mm <= hi && contact > front + kMaxInvisibleErrorMm)) continue;
            out.push_back(Warning{"contact-outside-footprint", "tip_gap",
                                  format("at depth %.2f mm the centre of friction is %.2f mm from the tip, "
                                         "beyond the footprint, which is %.2f mm long",
                                         shape.depth_mm, contact, front)});
            break;
        }
    }
    for (const auto& [profile, where] : laws(brush)) {
        const double largest = std::max(std::abs((*profile)(lo)), std::abs((*profile)(hi)));
        if (profile->rmse_mm && *profile->rmse_mm > kMaxRmseShare * largest)
            out.push_back(
                Warning{"law-scatters", where,
                        format("what was measured scatters by %.2f mm about a law of at most %.2f mm: measure "
                               "again, or more often",
                               *profile->rmse_mm, largest)});
    }
    if (!brush.width_follows_depth())
        out.push_back(Warning{"widths-ignored", "half_width",
                              format("the width does not depend on depth: drawn widths are ignored and every stroke is "
                                     "%.2f mm wide",
                                     2.0 * brush.half_width(hi))});
    if (brush.footprints.pressed.empty())
        out.push_back(Warning{"footprint-assumed", "footprints.pressed",
                              "no outline for a brush pressed straight down: the dragged one is used"});
    return out;
}

}  // namespace brushsvg
