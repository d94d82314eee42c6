"""What the largest overlap made of a brush that edges told, in words and as a picture."""

from __future__ import annotations

import numpy as np

from ...model.describe import LAWS, polynomial
from ...model.plot import brush_picture
from ..marks.mark_report import TABLE_ROWS, overlaps
from ..marks.mark_report import report as of_edges
from ..marks.mark_report import report_picture as picture_of_edges


def report(made, of_photo: bool = False) -> str:
    """The text that `brushsvg calibrate --aim overlap` prints. made: by_overlap.OverlapCalibration; of_photo: see
    mark_report.report."""
    brush, edges, found = made.brush, made.by_edges, made.found
    if found.kind == "edges":
        return of_edges(edges, of_photo) + chosen_in_words(found) + "\n"
    lines = [
        f"brush {brush.name}, depth {brush.depth_range_mm[0]:g} to {brush.depth_range_mm[1]:g} mm, from "
        f"{len(edges.painted.marks)} painted marks, to the largest overlap",
        "",
        *(f"{name} = {polynomial(getattr(brush, name).coefficients)}" for name, _ in LAWS),
        "",
        "  depth" + "".join(f"{name} (edges)".rjust(24) for name, _ in LAWS),
    ]
    for depth in np.linspace(*brush.depth_range_mm, TABLE_ROWS):
        cells = [
            f"{getattr(brush, name)(depth):.2f} ({getattr(edges.brush, name)(depth):.2f})" for name, _ in LAWS
        ]
        lines.append(f"{depth:7.2f}" + "".join(cell.rjust(24) for cell in cells))
    way = "higher" if found.height_mm >= 0 else "lower"
    (in_place, moved), (now_in_place, now_moved) = overlaps(edges), overlaps(made.made)
    lines += [
        "  in brackets: by edges, which calibrate without --aim overlap writes, with intervals",
        "",
        chosen_in_words(found),
        f"the paper lies {abs(found.height_mm):.2f} mm {way} than the plan took it to be "
        f"({edges.fit.height_mm:+.2f} mm by edges)",
        f"painted and predicted marks overlap by {now_in_place:.3f} where they lie, by {now_moved:.3f} with the "
        f"displacements of the edges' fit taken away; by edges {in_place:.3f} and {moved:.3f}",
        *_machine(edges, found.offsets),
        "no intervals: those of the edges' fit do not hold for these laws",
    ]
    return "\n".join([*lines, ""])


KINDS = {
    "edges": "what edges told",
    "disc": "a dragged disc",
    "laws": "laws and footprint",
    "machine": "laws, footprint and machine",
    "lever": "those and the lever of a tilted tool",
}


def chosen_in_words(found) -> str:
    """What the search was to change, and why: found is overlap_choice.Predicting."""
    if not found.left_out:
        return (
            f"changed: {KINDS[found.kind]}; the marks are too few to be parted, so whether that predicts further ones "
            "better than edges do is not known"
        )
    listed = "; ".join(f"{KINDS[kind]} {sum(both) / 2:.3f}" for kind, both in found.left_out.items())
    return (
        f"chosen: {KINDS[found.kind]}, since so marks that had no part in the fit overlap most, each of {found.parts} "
        f"parts predicted by the others (mean of where they lie and where each may move): {listed}"
    )


MOST_LAYOUTS = 3


def describe_displacement(displaced) -> str:
    """By where on their sheets marks lie aside: aside is overlap_field.FoundField."""
    if displaced.won is None:
        return "no field over the sheets: the marks are too few"
    won = (
        f"marks that had no part in it overlap by {displaced.won:+.3f} +- {displaced.error:.3f} more with it"
    )
    if displaced.field is None:
        return f"no field over the sheets, since {won}"
    likely = sorted(displaced.field.layouts, key=lambda one: -one[1])[:MOST_LAYOUTS]
    listed = ", ".join(f"{one.rows} rows of {one.columns} ({weight:.2f})" for one, weight, _ in likely)
    return f"a field over the sheets, since {won}; sheets are averaged over by their probability: {listed}"


def _machine(edges, offsets) -> list[str]:
    """What edges told of it and what came beside."""
    lines, was = [], edges.fit.machine
    if offsets.lean_mm_per_mm.any():
        x, y = offsets.lean_mm_per_mm + was.lean_mm_per_mm
        lines.append(
            f"lean: {x:+.3f} and {y:+.3f} mm per mm of depth in x and y "
            "({:+.3f} and {:+.3f} by edges)".format(*was.lean_mm_per_mm)
        )
    if offsets.map.any():
        axes = np.array([[was.scale[0], was.skew], [0.0, was.scale[1]]])
        (a, b), (c, d) = (np.eye(2) + offsets.map) @ axes - np.eye(2)
        lines.append(
            f"ways: {a:+.4f} and {b:+.4f} mm in x, {c:+.4f} and {d:+.4f} in y per mm in x and y (scale "
            f"{was.scale[0]:.4f} and {was.scale[1]:.4f}, skew {was.skew:+.4f} by edges)"
        )
    return lines


def report_picture(made, suffix: str) -> bytes:
    """The laws, without bands where edges alone were not chosen."""
    if made.found.kind == "edges":
        return picture_of_edges(made.by_edges, suffix)
    return brush_picture(made.brush, suffix)
