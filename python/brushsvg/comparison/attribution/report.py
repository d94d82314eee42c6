"""Report the causes of differences, in words and as JSON."""

from __future__ import annotations

from ...machine.cells.cell import Machine
from ...reporting.report_text import format_overlap, table
from ..job_marks import PAINT_A_CHART
from .corrected_cell import format_machine_table
from .faults import MISSING_PAINT, OWN_PLACE, EstimatedFault, Faults
from .model import BRUSH, MACHINE, PAPER, SHEET

REMEDIES = {
    SHEET: "teach the paper again, or put the sheet where the paper was taught",
    MACHINE: "use the cell that compare --corrected-cell writes, or fix the machine",
    PAPER: "use the cell that compare --corrected-cell writes, or level the paper",
    BRUSH: "update the brush with calibrate --plan --prior",
    OWN_PLACE: "correct each stroke with convert --corrections. The command compare --sheets shows which part repeats",
    MISSING_PAINT: "let the brush fetch paint earlier, in the table [paint] of the cell",
}
NONE_ALONE = f"{PAINT_A_CHART}. No stroke of this sheet is separate and complete enough to update the brush"


def fix_first(faults: Faults | None, any_alone: bool = True) -> str:
    """Return a sentence on the cause that costs most, with its remedy.

    any_alone: whether a brush could learn from a stroke of this sheet.
    """
    if faults is None:
        return "The cause is unknown, because too few strokes have edges clear of other paint."
    if faults.first is None:
        return "No single fix is certain to help. Use the corrections."
    gain = next(share.gain for share in faults.shares if share.cause == faults.first)
    how = REMEDIES[faults.first] if any_alone or faults.first != BRUSH else NONE_ALONE
    return f"Fix this first: {faults.first} (gain in overlap {gain:.3f}). To fix it, {how}."


def fault_lines(faults: Faults | None, machine: Machine | None) -> list[str]:
    """Return lines with the gain of every cause, and every number.

    They end with the table for a cell. machine: the machine of the cell for the next job.
    """
    if faults is None:
        return []
    gains = [
        (f"  {share.cause}", f"{share.gain + 0.0:+.3f}", f"({share.low:+.3f} to {share.high:+.3f})")
        for share in sorted(faults.shares, key=lambda share: -share.gain)
    ]
    head, *rows = table(("  if only this cause is fixed", "gain", "95 %"), gains)
    lines = [
        "",
        f"Causes of the difference between paint and drawing, estimated at {faults.edges} places on edges. With these",
        f"causes alone, paint and drawing would overlap by {format_overlap(faults.overlap)}:",
        head,
        *rows,
        "",
        *(f"  {_describe_number(fault)}" for fault in faults.found),
        f"  each stroke's own place: {faults.own_mm:.2f} mm (rms); one sheet does not show which part repeats",
        f"  remaining errors of edges: {faults.rest_mm:.3f} mm (rms)",
    ]
    for cause, other in faults.alike:
        lines.append(f"These marks hardly separate two causes: {cause}, and {other}. Their sum is more certain.")
    if machine:
        lines += [
            "",
            "Table for the next cell, with the certain errors and the errors that the cell already corrects:",
            *format_machine_table(machine),
        ]
    return lines


def _describe_number(fault: EstimatedFault) -> str:
    small = fault.number.unit in ("mm per mm", "mm in x per mm in y", "")
    digits = 5 if small else 3
    value = f"{fault.value:+.{digits}f} +- {fault.half:.{digits}f} {fault.number.unit}".rstrip()
    return f"{fault.number.cause}: {fault.number.name} {value}"


def faults_as_json(faults: Faults | None) -> dict | None:
    if faults is None:
        return None
    return {
        "overlap": faults.overlap,
        "mend_first": faults.first,
        "causes": [
            {"cause": item.cause, "gain": item.gain, "gain_95": [item.low, item.high]} for item in faults.shares
        ],
        "numbers": [
            {
                "cause": item.number.cause,
                "name": item.number.name,
                "value": round(item.value, 6),
                "half_95": round(item.half, 6),
                "unit": item.number.unit,
            }
            for item in faults.found
        ],
        "own_places_mm": faults.own_mm,
        "rest_mm": faults.rest_mm,
        "edges": faults.edges,
        "hard_to_tell_apart": [list(pair) for pair in faults.alike],
    }
