#include "brushsvg/objective.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "brushsvg/error.hpp"
#include "refusal.hpp"

using namespace brushsvg;

TEST_CASE("the more detail, the less a stroke costs") {
    const double draft = weights_for(parse_detail("draft")).stroke, fine = weights_for(parse_detail("fine")).stroke;
    CHECK(weights_for(Detail::normal).stroke == ObjectiveWeights().stroke);
    CHECK(draft > ObjectiveWeights().stroke);
    CHECK(fine < ObjectiveWeights().stroke);
}

TEST_CASE("weights and depths outside their ranges are refused") {
    check(ObjectiveWeights());
    check(weights_for(Detail::fine));
    ObjectiveWeights weights;
    weights.seen_mm = -1.0;
    CHECK(agrees(refusal([&] { check(weights); }), "out-of-range", "seen_mm", {"-1", "0", "1000"}));
    weights = {};
    weights.missing = std::nan("");
    CHECK(agrees(refusal([&] { check(weights); }), "out-of-range", "missing", {"nan"}));
}

TEST_CASE("an unknown detail setting is refused") {
    try {
        parse_detail("high");
        FAIL("taken");
    } catch (const Error& refusal) {
        CHECK(refusal.code() == "choice-unknown");
    }
}
