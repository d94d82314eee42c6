#include "bernstein.hpp"

#include <cmath>

namespace brushsvg::fit {

using Eigen::MatrixXd;

MatrixXd powers_from_controls(int degree, double lo, double hi) {
    MatrixXd unit = MatrixXd::Zero(degree + 1, degree + 1);  // powers of t = (d - lo) / (hi - lo)
    const auto binomial = [](int n, int k) {
        double out = 1.0;
        for (int i = 0; i < k; ++i) out = out * (n - i) / (i + 1);
        return out;
    };
    for (int j = 0; j <= degree; ++j)
        for (int k = j; k <= degree; ++k)
            unit(k, j) = binomial(degree, j) * binomial(degree - j, k - j) * ((k - j) % 2 ? -1.0 : 1.0);
    MatrixXd shift = MatrixXd::Zero(degree + 1, degree + 1);  // t^k as powers of d
    for (int k = 0; k <= degree; ++k)
        for (int i = 0; i <= k; ++i) shift(i, k) = binomial(k, i) * std::pow(-lo, k - i) / std::pow(hi - lo, k);
    return shift * unit;
}

MatrixXd powers_from_legendre(int degree, double hi) {
    MatrixXd out = MatrixXd::Zero(degree + 1, degree + 1);
    out(0, 0) = 1.0;
    for (int k = 0; k < degree; ++k) {  // (k + 1) P' = (2 k + 1) t P - k P_before, t = 2 d / hi - 1
        Eigen::VectorXd next = -(2.0 * k + 1.0) * out.col(k);
        next.tail(degree) += (2.0 * k + 1.0) * (2.0 / hi) * out.col(k).head(degree);
        if (k) next -= double(k) * out.col(k - 1);
        out.col(k + 1) = next / (k + 1.0);
    }
    return out;
}

}  // namespace brushsvg::fit
