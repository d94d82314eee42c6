"""Ask on a terminal for measurements of a brush with a ruler.

The questions come with an explanation of how to measure.
"""

from __future__ import annotations

import argparse
import shlex
import sys

from ...calibration.numbers.from_widths import lag_of_turn
from ...errors import Notice
from ..arguments import values
from ..console import RefusedError, say

# Medians over 12 hidden brushes, see benchmarks/typed_brushes.py.
ACCURACY_GAIN = "paint overlaps a drawn word by 0.87 with lag and width at three depths, by 0.62 with one depth"
HOW_TO_MEASURE = (
    "Choose three press depths, for example a quarter, half and all of your largest depth.",
    "At each depth paint a straight line of 40 mm, turn by 90 degrees, and paint 40 mm more.",
    "Width: measure across the straight part of the mark.",
    "Turn: measure how far before the tool's second line the middle of the mark starts to turn.",
    "Lag: the turn plus 0.3 times the width.",
    f"What it is worth: {ACCURACY_GAIN}.",
)
DEPTH_NAMES = ("shallow", "middle", "deep")
MEASUREMENT_FLAGS = "--lag-at DEPTH=LAG --width-at DEPTH=WIDTH, once for each depth"


def can_answer(args) -> bool:
    """Return whether a person can answer questions.

    This needs a terminal for input and for messages, and messages as text.
    """
    return args.messages == "text" and all(stream is not None and stream.isatty() for stream in (sys.stdin, sys.stderr))


def ask_measurements(name: str) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """Ask for lags and widths, and return both as lists of (depth, length) in mm.

    Raises RefusedError if the answers end too early.
    """
    for line in HOW_TO_MEASURE:
        say(line)
    lags, widths = [], []
    for depth_name in DEPTH_NAMES:
        depth = _ask_length(f"{depth_name} depth [mm]: ")
        width = _ask_length("  width of the mark [mm]: ")
        turn = _ask_length("  turn, before the second line [mm]: ", values.lag)
        widths.append((depth, width))
        lags.append((depth, round(lag_of_turn(turn, width), 2)))
    flags = [
        f"--lag-at {depth:g}={lag:g} --width-at {depth:g}={width:g}"
        for (depth, lag), (_, width) in zip(lags, widths, strict=True)
    ]
    say(f"The same without questions: brushsvg brush new -o {shlex.quote(name)} {' '.join(flags)}")
    return lags, widths


def _ask_length(question: str, read=values.width) -> float:
    """Ask until the answer is a length, in mm."""
    while True:
        sys.stderr.write(question)
        sys.stderr.flush()
        answer = sys.stdin.readline()
        if not answer:
            why = Notice(
                "",
                f"the answers ended. Answer all questions, or give {MEASUREMENT_FLAGS}",
                code="measurement-missing",
            )
            raise RefusedError("brush new", [why])
        try:
            return read(answer.strip().replace(",", "."))
        except argparse.ArgumentTypeError as problem:
            say(str(problem))


def warn_of_few_depths(args, widths) -> list[Notice]:
    """Warn if lag or width is known at fewer depths than three.

    There is no warning for pens and for copies of another brush.
    """
    if args.like is not None or args.lag == 0:
        return []
    depth_count = min(len({depth for depth, _ in each}) for each in (args.lag_at or [(0.0, args.lag)], widths))
    if depth_count >= len(DEPTH_NAMES):
        return []
    sentence = f"lag or width is known at {depth_count} depth{'s' * (depth_count > 1)}. Typically {ACCURACY_GAIN}"
    return [Notice("", sentence, code="few-depths", advice=f"measure at three depths: {MEASUREMENT_FLAGS}")]
