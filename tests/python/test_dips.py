"""Strokes of another tool's program that fetch paint are recognized."""

import tracemalloc

import numpy as np

from brushsvg.read.gcode import dips


def at_pots_by_definition(begins: np.ndarray) -> list[bool]:
    """Return which strokes fetch paint, from the definition, by comparing all pairs.

    A pot is a place that is visited at least three times, and never twice in a row.
    """
    near = np.hypot(*(begins[:, None] - begins[None]).transpose(2, 0, 1)) <= dips.SAME_PLACE_MM
    follows = np.array([False, *(near[k, k + 1] for k in range(len(begins) - 1))])
    return ((near.sum(axis=1) >= dips.MIN_POT_VISITS) & ~(near & follows[None]).any(axis=1)).tolist()


def test_dips_found_among_many_strokes_match_their_definition(monkeypatch):
    monkeypatch.setattr(dips, "_find_outside_others", lambda strokes, chosen: chosen)
    random = np.random.default_rng(5)
    for count in (1, 2, 40, 700):
        begins = random.uniform(0, 25, (count, 2))
        begins[::9] = begins[0]
        assert dips._find_pot_dips([begin[None] for begin in begins]) == at_pots_by_definition(begins)


def test_memory_does_not_grow_with_the_square_of_the_strokes():
    begins = np.random.default_rng(6).uniform(0, 100, (8000, 2))
    tracemalloc.start()
    try:
        dips._find_pot_dips([begin[None] for begin in begins])
        assert tracemalloc.get_traced_memory()[1] < 100e6
    finally:
        tracemalloc.stop()
