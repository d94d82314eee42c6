"""Whose fault the differences are, in words and as JSON."""

from __future__ import annotations

from ...machine.cells.cell import Machine
from ..job_marks import PAINT_A_CHART
from .corrected_cell import as_table
from .faults import DRY, OWN, Faults, Found, Share
from .model import BRUSH, MACHINE, PAPER, SHEET

REMEDY = {
    SHEET: "teach the paper anew, or lay the sheet where it was taught",
    MACHINE: "give convert the cell of --corrected-cell, or fix the machine",
    PAPER: "give convert the cell of --corrected-cell, or level the paper",
    BRUSH: "update the brush: calibrate --plan --prior",
    OWN: "correct each stroke: convert --corrections; several sheets tell what of it repeats (compare --sheets)",
    DRY: "let the brush fetch paint earlier: [paint] of the cell",
}
NONE_ALONE = f"no stroke of this sheet lies alone with its paint whole, to learn from; {PAINT_A_CHART}"


def describe(share: Share) -> str:
    return f"{share.cause}: {share.gain:+.3f} ({share.low:+.3f} to {share.high:+.3f})"


def in_words(faults: Faults | None, machine: Machine | None, any_alone: bool = True) -> list[str]:
    """machine: of the cell, as the next job should be told it; any_alone: whether a brush could learn from a stroke of
    this sheet."""
    if faults is None:
        sentence = (
            "What the difference is made of is not told: too few strokes, or too few edges that lie free."
        )
        return ["", sentence]
    lines = [
        "",
        f"What lies between paint and drawing, from {faults.edges} places on edges; in brackets what holds by 95 %.",
        f"Paint with these faults alone would overlap by {faults.overlap:.3f}; mending one of them gains:",
    ]
    width = max(len(share.cause) for share in faults.shares)
    for share in sorted(faults.shares, key=lambda one: -one.gain):
        interval = f"({share.low:+.3f} to {share.high:+.3f})"
        lines.append(f"  {share.cause.ljust(width)}  {share.gain + 0.0:+.3f}  {interval}")
    lines += [
        "",
        *(f"  {_number(one)}" for one in faults.found),
        f"  each stroke's own place: {faults.own_mm:.2f} mm (rms); one sheet does not tell what of it repeats",
        f"  edges beyond all that: {faults.rest_mm:.3f} mm (rms)",
        "",
    ]
    for one, other in faults.alike:
        lines.append(
            f"Hard to tell apart on these marks: {one}, and {other}; their sum is surer than either."
        )
    if faults.first is None:
        lines.append("No single fix is certain to help: use the corrections.")
    else:
        gain = next(share.gain for share in faults.shares if share.cause == faults.first)
        how = REMEDY[faults.first] if any_alone or faults.first != BRUSH else NONE_ALONE
        lines.append(f"Fix first: {faults.first}, which gains {gain:.3f}: {how}.")
    if machine:
        lines += [
            "",
            "The cell's table for the next job: what is certain, and what it undid before:",
            *as_table(machine),
        ]
    return lines


def _number(one: Found) -> str:
    small = one.number.unit in ("mm per mm", "mm in x per mm in y", "")
    digits = 5 if small else 3
    value = f"{one.value:+.{digits}f} +- {one.half:.{digits}f} {one.number.unit}".rstrip()
    return f"{one.number.cause}: {one.number.name} {value}"


def in_json(faults: Faults | None) -> dict | None:
    if faults is None:
        return None
    return {
        "overlap": faults.overlap,
        "mend_first": faults.first,
        "causes": [
            {"cause": one.cause, "gain": one.gain, "gain_95": [one.low, one.high]} for one in faults.shares
        ],
        "numbers": [
            {
                "cause": one.number.cause,
                "name": one.number.name,
                "value": round(one.value, 6),
                "half_95": round(one.half, 6),
                "unit": one.number.unit,
            }
            for one in faults.found
        ],
        "own_places_mm": faults.own_mm,
        "rest_mm": faults.rest_mm,
        "edges": faults.edges,
        "hard_to_tell_apart": [list(pair) for pair in faults.alike],
    }
