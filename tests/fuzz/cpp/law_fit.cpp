// A law through any measurements: finite, and of the shape that was requested over its range.
#include "law_fit.hpp"

#include "fuzzed_input.hpp"

using namespace brushsvg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in(data, size);
    return fuzz::refusing([&] {
        fit::LawShape shape;
        shape.range_mm = {0.0, in.wild(in.coarse(1.0, 12.0))};
        shape.degree = in.integer(0, 5);
        shape.through_zero = in.chance(3);
        shape.positive = in.chance(3);
        shape.rising = in.chance(3);
        shape.norm = in.chance(2) ? fit::Norm::absolute : fit::Norm::squares;
        if (in.chance(4)) shape.floor = 0.0;
        if (in.chance(4)) shape.smoothing = in.coarse(0.0, 10.0);
        const bool scatters = in.chance(3);
        std::vector<double> depth, value, scatter;
        for (int i = in.integer(1, 20); i > 0; --i) {
            depth.push_back(in.wild(in.coarse(0.0, 12.0)));
            value.push_back(in.wild(in.number(-2.0, 20.0)));
            if (scatters) scatter.push_back(in.wild(in.coarse(0.01, 1.0)));
        }
        const fit::LawFit found = fit::fit_law(depth, value, shape, scatter);
        fuzz::require(fuzz::are_finite(found.law.coefficients) && fuzz::are_finite(found.residual_mm),
                      "the law is finite");
        fuzz::require(found.residual_mm.size() == depth.size(), "each value has its residual");
        for (const auto& row : found.covariance) fuzz::require(fuzz::are_finite(row), "the covariance is finite");
        double size_of_law = 1.0, before = -std::numeric_limits<double>::infinity();
        for (int i = 0; i <= 100; ++i)
            size_of_law = std::max(size_of_law, std::abs(found.law(shape.range_mm[1] * i / 100)));
        for (int i = 0; i <= 100; ++i) {
            const double now = found.law(shape.range_mm[1] * i / 100);
            if (shape.positive && (i > 0 || !shape.through_zero))
                fuzz::require(now > -1e-6 * size_of_law, "a law that is to be positive is", now);
            if (shape.rising)
                fuzz::require(now >= before - 1e-6 * size_of_law, "a law that is to rise does", now - before);
            before = now;
        }
        const fit::LawFit again = fit::fit_law(depth, value, shape, scatter);
        fuzz::require(again.law.coefficients == found.law.coefficients, "the same measurements, the same law");
    });
}
