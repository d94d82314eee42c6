#pragma once

#include <Eigen/Core>
#include <cmath>

/// A dual number with one derivative, like those of a solver.
struct Dual {
    double a = 0.0, v = 0.0;
    Dual() = default;
    Dual(double x) : a(x) {}  // NOLINT: a constant is a dual number
    Dual(double x, double dx) : a(x), v(dx) {}
    Dual& operator+=(const Dual& o) { return *this = {a + o.a, v + o.v}; }
    Dual& operator-=(const Dual& o) { return *this = {a - o.a, v - o.v}; }
    Dual& operator*=(const Dual& o) { return *this = {a * o.a, v * o.a + a * o.v}; }
    Dual& operator/=(const Dual& o) { return *this = {a / o.a, (v - a / o.a * o.v) / o.a}; }
    friend Dual operator+(Dual x, const Dual& y) { return x += y; }
    friend Dual operator-(Dual x, const Dual& y) { return x -= y; }
    friend Dual operator*(Dual x, const Dual& y) { return x *= y; }
    friend Dual operator/(Dual x, const Dual& y) { return x /= y; }
    friend Dual operator-(const Dual& x) { return {-x.a, -x.v}; }
    friend bool operator<(const Dual& x, const Dual& y) { return x.a < y.a; }
    friend bool operator>(const Dual& x, const Dual& y) { return x.a > y.a; }
    friend bool operator<=(const Dual& x, const Dual& y) { return x.a <= y.a; }
    friend bool operator>=(const Dual& x, const Dual& y) { return x.a >= y.a; }
    friend Dual sin(const Dual& x) { return {std::sin(x.a), std::cos(x.a) * x.v}; }
    friend Dual cos(const Dual& x) { return {std::cos(x.a), -std::sin(x.a) * x.v}; }
    friend Dual tanh(const Dual& x) { return {std::tanh(x.a), (1.0 - std::tanh(x.a) * std::tanh(x.a)) * x.v}; }
    friend Dual atan2(const Dual& y, const Dual& x) {
        return {std::atan2(y.a, x.a), (x.a * y.v - y.a * x.v) / (x.a * x.a + y.a * y.a)};
    }
    friend Dual exp(const Dual& x) { return {std::exp(x.a), std::exp(x.a) * x.v}; }
    friend Dual sqrt(const Dual& x) { return {std::sqrt(x.a), 0.5 / std::sqrt(x.a) * x.v}; }
};

namespace Eigen {
template <>
struct NumTraits<Dual> : NumTraits<double> {
    using Real = Dual;
    using NonInteger = Dual;
    using Nested = Dual;
    enum {
        IsComplex = 0,
        IsInteger = 0,
        IsSigned = 1,
        RequireInitialization = 1,
        ReadCost = 2,
        AddCost = 2,
        MulCost = 3
    };
};
}  // namespace Eigen
