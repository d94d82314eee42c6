#pragma once

#include <vector>

#include "mark_problem.hpp"

namespace brushsvg::fit {

/// Lets laws depart from the numbers that the options give them, unless the marks are likelier where they do not: by
/// further polynomials, which are known beforehand to be about 0, to a share of the law that is found from the marks
/// (marginal likelihood, in addition to the solution), and where they clearly do, the half width by another power of
/// the depth. Where they may, it must be solved again. Log of how much likelier the marks are if laws depart.
double depart(MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options);

/// The same solution, its laws expected to depart by as much as curves of other forms do, unless the marks speak
/// against it; not by any order of magnitude alike. They must depart.
MarkProblem of_usual_departures(const MarkProblem& fit, const MarkOptions& options);

/// What variances are multiplied by where departing is as much likelier: by Student's t, for by how much laws depart is
/// found from few numbers; by the less, the surer it is that they do not. Of laws that were never tested: 1.
double unsurer(double likelier);

/// The same solution, its laws expected to keep to the few numbers of the options.
MarkProblem of_least_departures(const MarkProblem& fit, const MarkOptions& options);

/// That a brush departs of which the marks say that it is as much likelier.
double chance_of_departing(double likelier);

/// The same solution with as many numbers a law as the options say, nearest where those are fewer.
MarkProblem with_terms(const MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options);

}  // namespace brushsvg::fit
