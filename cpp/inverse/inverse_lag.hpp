#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "brushsvg/lag.hpp"
#include "inverse/middle_line.hpp"

namespace brushsvg {

/// The article's lag law read backwards: q = m + (r - e) u, where m drags P on the lever e.
class InverseLag {
 public:
    InverseLag(const Line& line, const Brush& brush);
    /// Return the depths at which the widest section is over the centre of friction.
    const std::vector<double>& crossings() const { return crossings_; }

    /// Fill in contact, heading and TCP of all samples. `first`: heading at the first sample; none: along the line.
    void operator()(Samples& samples, const std::optional<Eigen::Vector2d>& first = {}) const;

 private:
    int sign_of(const Samples& samples, std::size_t i) const;
    void follow_tangent(Samples& samples, std::size_t begin, std::size_t end) const;
    /// Solve a stretch where the widest section is ahead: apply the forward law with lever e, from the stretch's
    /// beginning.
    void forwards(Samples& samples, std::size_t begin, std::size_t end, const Eigen::Vector2d& heading) const;
    /// Solve a stretch where the widest section trails: unstable forwards, but stable from the end to the beginning.
    void backwards(Samples& samples, std::size_t begin, std::size_t end) const;
    void start(Samples& samples, std::size_t i, const LagLaw<double>& law, double sign, LagState<double>& state) const;
    void step(Samples& samples, std::size_t from, std::size_t to, const LagLaw<double>& law, double sign,
              LagState<double>& state) const;
    static void store(Sample& sample, double sign, const LagState<double>& state);

    const Line& line_;
    const Brush& brush_;
    LagLaw<double> ahead_, behind_;
    std::vector<double> crossings_;
};

}  // namespace brushsvg
