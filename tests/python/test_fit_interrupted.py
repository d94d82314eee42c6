"""Ctrl-C in a long fit raises KeyboardInterrupt and leaves the inputs unchanged."""

import os
import signal
import threading

import numpy as np
import pytest

from brushsvg import _core, find_brush

ROUND = find_brush("round-6")


def marks(count):
    """Return painted marks of corners at many depths."""
    passes = []
    for k in range(count):
        depth, x = 2.0 + 6.0 * (k % 30) / 30, 60.0 * (k % 20)
        way = [(0, 0, 0), (12, 0, -depth), (40, 0, -depth), (40, 30, -depth)]
        passes.append(_core.Pass(f"s{k}", np.add(way, [x, 60.0 * (k // 20), 0.0])))
    painted = _core.simulate(_core.Plan("round-6", "", (2000, 2000), passes), ROUND)
    _core.trace_outlines(painted, ROUND)
    return [
        _core.PaintedMark(one.stroke, one.poses_mm, mark.outline_mm)
        for one, mark in zip(passes, painted.passes, strict=True)
    ]


def law():
    depth = np.linspace(1, 9, 20000)
    shape = _core.LawShape((0, 10), 3, floor=0.0, norm=_core.Norm.absolute)
    return lambda: _core.fit_law(np.round(depth, 1), 3 * np.sin(9 * depth) + depth - 4, shape)


def fit_of_marks():
    given = marks(300)
    before = [each.poses_mm.copy() for each in given]

    def call():
        try:
            _core.fit_marks(given)
        finally:
            assert all(np.array_equal(a, b.poses_mm) for a, b in zip(before, given, strict=True))

    return call


def union():
    turn = np.linspace(0, 2 * np.pi, 400_000, endpoint=False)
    radius = 80 + 0.01 * np.random.default_rng(1).uniform(-1, 1, turn.size)
    ring = np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])
    return lambda: _core.unite([ring, np.add(ring, [10.0, 0.0])])


@pytest.mark.slow
@pytest.mark.parametrize("made", [law, fit_of_marks, union])
def test_ctrl_c_interrupts_a_fit(made):
    call = made()
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job ignores SIGINT
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
    finally:
        timer.cancel()
        timer.join()
        signal.signal(signal.SIGINT, before)
