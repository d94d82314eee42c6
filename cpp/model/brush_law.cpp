#include "brushsvg/brush_law.hpp"

#include <algorithm>
#include <cmath>

#include "base/format_text.hpp"
#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

/// Limit of the terms of a polynomial whose roots are searched, because all its derivatives have to be solved first.
constexpr std::size_t kMaxTerms = 64;
constexpr double kDepthRoundingMm = 1e-6;  // rounding error of depths that were computed or read from a plan

double evaluate(const std::vector<double>& c, double x) {
    double y = 0.0;
    for (std::size_t i = c.size(); i-- > 0;) y = y * x + c[i];
    return y;
}

}  // namespace

double Profile::at(double depth_mm) const {
    if (depth_range_mm) {
        // A brush passes smaller depths than its range has when it is set down and lifted.
        const double deepest = (*depth_range_mm)[1];
        if (!(depth_mm >= -kDepthRoundingMm && depth_mm <= deepest + kDepthRoundingMm)) {
            throw Error("depth-out-of-range",
                        format_text("depth %.4g mm is outside the range [0, %.4g] mm of the brush", depth_mm, deepest),
                        "", depth_mm, std::array<double, 2>{0.0, deepest});
        }
        depth_mm = std::clamp(depth_mm, 0.0, deepest);
    }
    return (*this)(depth_mm);
}

void require_law_degree(const std::vector<double>& coefficients, const std::string& where) {
    constexpr int most = kMaxLawDegree + 1;
    const std::size_t count = coefficients.size();
    if (count >= 1 && count <= std::size_t(most)) return;
    throw Error("law-terms",
                "the law has " + std::to_string(count) + " coefficients, outside the range [1, " +
                    std::to_string(most) + "]: " + (count == 0 ? "add one" : "use a polynomial of lower degree"),
                where, double(count), std::array<double, 2>{1.0, double(most)});
}

std::vector<double> real_roots(const std::vector<double>& coefficients, double lo, double hi) {
    std::vector<double> c = coefficients;
    while (!c.empty() && c.back() == 0.0) c.pop_back();
    if (c.size() < 2) return {};
    if (c.size() > kMaxTerms)
        throw Error("law-terms",
                    "the polynomial has " + std::to_string(c.size()) +
                        " coefficients, but roots are found of at most " + std::to_string(kMaxTerms),
                    "", double(c.size()));
    // A polynomial is monotonic between the roots of its derivative.
    std::vector<double> slope(c.size() - 1);
    for (std::size_t i = 1; i < c.size(); ++i) slope[i - 1] = double(i) * c[i];
    std::vector<double> ends = real_roots(slope, lo, hi);
    ends.insert(ends.begin(), lo);
    ends.push_back(hi);
    std::vector<double> roots;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        double a = ends[i], b = ends[i + 1];
        const double fa = evaluate(c, a), fb = evaluate(c, b);
        if (fa == 0.0) {
            roots.push_back(a);
            continue;
        }
        if (fb == 0.0 || (fa < 0.0) == (fb < 0.0)) continue;
        while (true) {
            const double middle = 0.5 * (a + b);
            if (!(a < middle && middle < b)) break;
            ((evaluate(c, middle) < 0.0) == (fa < 0.0) ? a : b) = middle;
        }
        roots.push_back(b);
    }
    if (evaluate(c, hi) == 0.0) roots.push_back(hi);
    roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
    return roots;
}

std::vector<PolynomialPiece> pieces(const Profile& profile, double lo, double hi) {
    if (std::isinf(profile.floor)) return {{lo, hi, profile.coefficients}};
    std::vector<double> above = profile.coefficients;
    if (above.size() < 2) above.resize(2, 0.0);
    above[0] -= profile.floor;
    above[1] -= profile.floor_slope;
    std::vector<double> ends = real_roots(above, lo, hi);
    ends.insert(ends.begin(), lo);
    ends.push_back(hi);
    std::vector<PolynomialPiece> out;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        if (!(ends[i] < ends[i + 1])) continue;
        const bool floored = evaluate(above, 0.5 * (ends[i] + ends[i + 1])) < 0.0;
        out.push_back({ends[i], ends[i + 1],
                       floored ? std::vector<double>{profile.floor, profile.floor_slope} : profile.coefficients});
    }
    if (out.empty()) out.push_back({lo, hi, {profile(lo)}});
    return out;
}

std::vector<PolynomialPiece> difference(const Profile& a, const Profile& b, double lo, double hi) {
    std::vector<PolynomialPiece> out;
    for (const PolynomialPiece& pa : pieces(a, lo, hi))
        for (const PolynomialPiece& pb : pieces(b, lo, hi)) {
            const double from = std::max(pa.lo, pb.lo), to = std::min(pa.hi, pb.hi);
            if (!(from < to)) continue;
            PolynomialPiece both{from, to, pa.coefficients};
            both.coefficients.resize(std::max(pa.coefficients.size(), pb.coefficients.size()), 0.0);
            for (std::size_t k = 0; k < pb.coefficients.size(); ++k) both.coefficients[k] -= pb.coefficients[k];
            out.push_back(std::move(both));
        }
    return out;
}

}  // namespace brushsvg
