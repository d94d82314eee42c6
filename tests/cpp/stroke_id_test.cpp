#include "brushsvg/stroke_id.hpp"

#include <doctest/doctest.h>

#include <string>

using brushsvg::StrokeId;

TEST_CASE("a name has only the parts that distinguish a stroke from others") {
    CHECK(StrokeId("a").name() == "a");
    CHECK(StrokeId("a", 2).name() == "a/2");
    CHECK(StrokeId("a", 2, 3).name() == "a/2#3");
    CHECK(StrokeId("a", 2, 3, 4, 5).name() == "a/2#3~4+5");
    CHECK(StrokeId("a", 0, 1, 1, 2).name() == "a+2");
    const std::string told = StrokeId("a", 1);
    CHECK(told == "a/1");
}

TEST_CASE("a name that looks like a part still belongs to an element") {
    const StrokeId id = "icon/1";
    CHECK(id.element == "icon/1");
    CHECK(id.part == 0);
    CHECK(id.name() == "icon/1");
}
