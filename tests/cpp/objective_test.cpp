#include "brushsvg/objective.hpp"

#include <doctest/doctest.h>

#include "brushsvg/error.hpp"

using namespace brushsvg;

TEST_CASE("the more detail, the less a stroke costs") {
    const double draft = weights_for(detail_named("draft")).stroke, fine = weights_for(detail_named("fine")).stroke;
    CHECK(weights_for(Detail::normal).stroke == ObjectiveWeights().stroke);
    CHECK(draft > ObjectiveWeights().stroke);
    CHECK(fine < ObjectiveWeights().stroke);
}

TEST_CASE("an unknown detail setting is refused") {
    try {
        detail_named("high");
        FAIL("taken");
    } catch (const Error& refusal) {
        CHECK(refusal.code() == "choice-unknown");
    }
}
