from diagnostics import gives

from brushsvg.errors import Notice
from brushsvg.notice_summary import MOST_ALIKE
from brushsvg.notice_summary import summarize_notices as summarized_notices


def notice(where, sentence, code="", **more):
    return Notice(where, sentence, code=code or sentence.split()[0], **more)


def summarized(reported):
    return [tuple(each) for each in summarized_notices(notice(*each) for each in reported)]


def test_few_notices_with_one_code_stay_unchanged():
    reported = [(f"p{k}", f"width {k} mm is odd") for k in range(MOST_ALIKE)] + [("q", "it is dashed")]
    assert summarized(reported) == reported


def test_equal_notices_are_kept_once():
    """Copies of an element have its name, so each notice on a copied element was printed once for each copy."""
    reported = [("text 1", "text is not read"), ("b", "markers are not read")]
    assert summarized(reported * 5) == reported


def test_many_notices_with_one_code_are_counted_at_the_first():
    reported = [("a", "one thing")]
    reported += [(f"p{k}", f"'p{k}' is 1.{k}e-0{k} mm off, x -{k}, range [0, {k}]", "off") for k in range(5)]
    reported[3:3] = [("b", "another thing")]
    one, (counted, first), other = summarized(reported)
    assert (one, other) == (("a", "one thing"), ("b", "another thing"))
    assert gives(counted, "p0", "4") and first == "'p0' is 1.0e-00 mm off, x -0, range [0, 0]"
    assert summarized([]) == []


def test_many_notices_with_a_limit_are_reported_by_the_one_that_exceeds_it_most():
    """The first copy was reported, and a drawing that was moved by that distance was refused again."""
    beyond = [notice(f"p{k}", f"{mm} mm beyond", "off", excess=mm) for k, mm in enumerate((0.1, 4, 0.3, 4, 2))]
    ((where, sentence),) = map(tuple, summarized_notices(beyond))
    assert gives(where, "p1", "4") and sentence == "4 mm beyond"


def test_four_notices_with_one_sentence_are_listed():
    reported = [(law, "measured to 4 mm") for law in ("lag", "tip_gap", "tip_to_widest", "half_width")]
    assert summarized(reported) == [("lag, tip_gap, tip_to_widest and half_width", "measured to 4 mm")]
    for others, count in (
        ([*reported[1:], ("fifth", "measured to 4 mm")], "4"),
        (
            [*reported[1:3], ("half_width", "measured to 5 mm")],
            "3",
        ),
    ):
        ((where, sentence),) = summarized([reported[0], *others])
        assert gives(where, "lag", count) and sentence == "measured to 4 mm"


def test_notices_are_grouped_by_code_for_any_sentence():
    reworded = [notice(f"p{k}", "wide" if k % 2 else "too broad", "width") for k in range(5)]
    (one,) = summarized_notices(reworded)
    assert gives(one.where, "p0", "4") and one.code == "width"
    assert len(summarized_notices([*reworded, notice("q", "wide", "other")])) == 2
    other_property = [
        notice(f"r{k}", "mask is not read", "css-unread", about=name)
        for k in range(3)
        for name in ("mask", "clip-path")
    ]
    assert len(summarized_notices(other_property)) == len(other_property)
    without_codes = [Notice(f"p{k}", f"{k} mm") for k in range(5)]
    assert summarized_notices(without_codes) == without_codes, "only what has a code is of a kind"


def test_many_notices_without_element_are_counted_in_the_sentence():
    reported = [("", f"marker {k} cannot be seen", "marker") for k in range(5)]
    ((where, sentence),) = summarized(reported)
    assert where == "" and gives(sentence, "marker 0 cannot be seen", "4")
