#include "brushsvg/lag.hpp"

#include <Eigen/Eigenvalues>

#include "brushsvg/error.hpp"

namespace brushsvg {
namespace {

std::vector<std::complex<double>> find_roots(const std::vector<double>& coefficients) {
    const int n = int(coefficients.size()) - 1;
    if (n < 1) return {};
    Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i + 1 < n; ++i) companion(i + 1, i) = 1.0;
    for (int i = 0; i < n; ++i) companion(i, n - 1) = -coefficients[i] / coefficients[n];
    const Eigen::VectorXcd roots = companion.eigenvalues();
    return {roots.data(), roots.data() + n};
}

/// Returns a bound of the absolute value of a polynomial's derivative of this order on [lo, hi]: the largest Bernstein
/// coefficient.
double derivative_bound(std::vector<double> c, int order, double lo, double hi) {
    for (; order > 0; --order) {
        for (std::size_t i = 1; i < c.size(); ++i) c[i - 1] = double(i) * c[i];
        if (!c.empty()) c.pop_back();
    }
    if (c.empty()) return 0.0;
    const int n = int(c.size()) - 1;
    for (int i = 0; i < n; ++i)
        for (int j = n - 1; j >= i; --j) c[j] += lo * c[j + 1];
    double power = 1.0, largest = 0.0;
    for (int i = 0; i <= n; ++i, power *= hi - lo) c[i] *= power;
    for (int i = 0; i <= n; ++i) {
        double sum = 0.0, ratio = 1.0;
        for (int j = 0; j <= i; ++j) {
            sum += ratio * c[j];
            if (j < n) ratio *= double(i - j) / double(n - j);
        }
        largest = std::max(largest, std::abs(sum));
    }
    return largest;
}

}  // namespace

LagLaw<double> make_law(const std::vector<PolynomialPiece>& pieces, double sign) {
    if (pieces.empty()) throw Error("law-terms", "the law has no pieces, because its depth range is empty");
    LagLaw<double> law;
    law.rigid = true;
    for (const PolynomialPiece& from : pieces) {
        std::vector<double> c = from.coefficients;
        while (c.size() > 1 && c.back() == 0.0) c.pop_back();
        if (c.empty()) c.push_back(0.0);
        for (double& x : c) {
            if (!std::isfinite(x)) throw Error("not-finite", "the law has a coefficient that is not finite", "", x);
            x *= sign;
        }
        require_law_degree(c, "");
        LawPiece<double> piece;
        piece.lo = from.lo;
        piece.hi = from.hi;
        piece.degree = int(c.size()) - 1;
        std::copy(c.begin(), c.end(), piece.coefficients.begin());
        piece.roots = find_roots(c);
        piece.root_distance2 = std::numeric_limits<double>::infinity();
        for (const auto& root : piece.roots)
            piece.root_distance2 =
                std::min(piece.root_distance2, std::norm(root - std::clamp(root.real(), from.lo, from.hi)));
        piece.max_slope = derivative_bound(c, 1, from.lo, from.hi);
        piece.max_third_derivative = derivative_bound(c, 3, from.lo, from.hi);
        law.rigid = law.rigid && c.size() == 1 && c[0] == 0.0;
        law.pieces.push_back(std::move(piece));
    }
    return law;
}

namespace detail {

/// Number of coefficients of the square of a law, which is more than those of a parabola.
constexpr std::size_t kMaxCoefficients = 2 * kMaxLawDegree + 1;

double first_positive(std::vector<double> f) {
    while (f.size() > 1 && f.back() == 0.0) f.pop_back();
    const int n = int(f.size()) - 1;
    using Bernstein = std::array<double, kMaxCoefficients>;
    struct Span {
        double a, b;
        Bernstein c;
    };
    // Intervals are halved again and again, the left half first. One interval waits at each level.
    std::array<Span, 64> stack;
    std::size_t top = 0;
    Span& whole = stack[top++];
    whole.a = 0.0;
    whole.b = 1.0;
    for (int i = 0; i <= n; ++i) {
        double sum = 0.0, ratio = 1.0;
        for (int j = 0; j <= i; ++j) {
            sum += ratio * f[j];
            if (j < n) ratio *= double(i - j) / double(n - j);
        }
        whole.c[i] = sum;
    }
    for (int intervals = 0; top > 0 && intervals < kMaxIntervals; ++intervals) {
        Span& span = stack[top - 1];  // the interval becomes its own right half
        if (std::all_of(span.c.begin(), span.c.begin() + n + 1, [](double c) { return c <= 0.0; })) {
            --top;
            continue;
        }
        const double middle = 0.5 * (span.a + span.b);
        if (span.c[0] > 0.0) return span.a;
        if (span.b - span.a < 1e-16 || !(span.a < middle && middle < span.b)) return span.b;
        Span& left = stack[top++];
        left.a = span.a;
        left.b = span.a = middle;
        for (int i = 0; i <= n; ++i) {
            left.c[i] = span.c[0];
            for (int j = 0; j < n - i; ++j) span.c[j] = 0.5 * (span.c[j] + span.c[j + 1]);
        }
    }
    return 2.0;
}

}  // namespace detail
}  // namespace brushsvg
