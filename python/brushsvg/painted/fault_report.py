"""Whose fault the differences are, in words and as JSON."""

from __future__ import annotations

import numpy as np

from .fault_model import BRUSH, MACHINE, PAPER, SHEET
from .faults import DRY, OWN, Faults, Found, Share

MEND = {
    SHEET: "teach the paper anew, or lay the sheet where it was taught",
    MACHINE: "give the cell the table below, or mend the machine",
    PAPER: "give the cell the table below, or level the paper",
    BRUSH: "update the brush: calibrate --plan --prior",
    OWN: "correct each stroke: convert --corrections; several sheets tell what of it repeats (compare --sheets)",
    DRY: "let the brush fetch paint earlier: [paint] of the cell",
}
SURE = 1.0  # half intervals from 0, from where on a number goes into a cell


def told(share: Share) -> str:
    return f"{share.cause}: {share.gain:+.3f} ({share.low:+.3f} to {share.high:+.3f})"


def in_words(faults: Faults | None, middle_mm) -> list[str]:
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
        lines.append("Nothing is certain to gain anything when it is mended alone.")
    else:
        gain = next(share.gain for share in faults.shares if share.cause == faults.first)
        lines.append(f"Mend first: {faults.first}, which gains {gain:.3f}: {MEND[faults.first]}.")
    if table := cell_table(faults, middle_mm):
        lines += [
            "",
            "For the cell, of what is certain (backlash is not undone, it needs a mechanic):",
            *table,
        ]
    return lines


def _number(one: Found) -> str:
    small = one.number.unit in ("mm per mm", "mm in x per mm in y", "")
    digits = 5 if small else 3
    value = f"{one.value:+.{digits}f} +- {one.half:.{digits}f} {one.number.unit}".rstrip()
    return f"{one.number.cause}: {one.number.name} {value}"


def cell_table(faults: Faults, middle_mm) -> list[str]:
    """The lines of a cell's table [machine] that undoes what is certain; none where nothing is."""
    sure = {
        one.number.name: one.value if abs(one.value) > SURE * one.half else 0.0
        for one in faults.found
        if one.number.cause in (MACHINE, PAPER)
    }
    lean, tilt = (np.array([sure[f"{name} in {axis}"] for axis in "xy"]) for name in ("lean", "tilt"))
    scale = np.array([sure[f"scale in {axis}"] for axis in "xy"])
    lines = []
    if lean.any():
        lines.append(f"lean_mm_per_mm = [{lean[0]:.5f}, {lean[1]:.5f}]")
    if scale.any() or sure["skew"]:
        lines.append(f"scale = [{1 + scale[0]:.5f}, {1 + scale[1]:.5f}]")
        lines.append(f"skew = {sure['skew']:.5f}")
    if tilt.any() or sure["height"]:
        lines.append(f"height_mm = {sure['height'] - tilt @ np.asarray(middle_mm):.3f}")
        lines.append(f"tilt_mm_per_mm = [{tilt[0]:.5f}, {tilt[1]:.5f}]")
    return ["[machine]", *lines] if lines else []


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
