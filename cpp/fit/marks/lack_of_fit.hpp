#pragma once

#include <vector>

#include "mark_problem.hpp"

namespace brushsvg::fit {

/// Lets laws depart from the coefficients that the options give them, unless the marks are likelier without departures.
///
/// Laws depart by further polynomials, whose prior mean is 0. Their size is a share of the law that is estimated
/// from the marks by marginal likelihood, in addition to the solution. Where laws clearly depart, the half width may
/// also rise with another power of the depth. If laws may depart, the problem must be solved again. Returns the log of
/// the likelihood ratio of the marks for departing laws.
double allow_departures(MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options);

/// Returns the same solution with another prior: laws depart as much as curves of other forms do, unless the marks
/// contradict it. The laws must depart.
MarkProblem with_typical_departures(const MarkProblem& fit, const MarkOptions& options);

/// Returns the factor by which variances grow for this log likelihood ratio of departing.
///
/// The factor follows from Student's t, because the size of departures is estimated from few numbers. It is smaller the
/// more certain it is that laws do not depart, and 1 for laws that were never tested.
double variance_factor(double log_likelihood_ratio);

/// Returns the same solution with a prior by which laws do not depart from the coefficients of the options.
MarkProblem without_departures(const MarkProblem& fit, const MarkOptions& options);

/// Returns the probability that a brush departs, from the log likelihood ratio of its marks.
double departure_probability(double log_likelihood_ratio);

/// Returns the same solution with as many coefficients per law as in the options, or the nearest laws with fewer.
MarkProblem with_terms(const MarkProblem& fit, const std::vector<PaintedMark>& marks, const MarkOptions& options);

}  // namespace brushsvg::fit
