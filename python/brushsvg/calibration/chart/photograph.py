"""A photograph of a painted chart: the strokes on it as marks in mm, and what the picture was like."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error, Notice
from ...scan.edges import Marks, Room, find_marks, told_apart
from ...scan.flatten import Flat, flatten
from ...scan.markers import Printed, View, find_view
from ...scan.photo import read_photo
from .layout import Chart
from .page import bar_rings, label_box

ANOTHER_SIZE = (0.9, 1.1)  # of the page, which --bar corrects; beyond, strokes run into labels and markers
MARGIN = 1 / 5  # of a marker's side around it: blur
# Standard deviation of where all edges of a picture lie off together: blue paint lies 0.1 px outward, yellow, of which
# JPEG keeps one colour for four pixels, 0.2 to 0.3
EDGE_PX = 0.2
ALIKE_MM = 0.15  # photographs of one flat sheet; a robot paints a second one less alike


@dataclass(frozen=True)
class Read:
    """What a photograph told: the flattened picture, the camera's view, marks by stroke."""

    chart: Chart
    flat: Flat
    view: View
    marks: Marks
    photos: int = 1


def read_chart_photos(chart: Chart, photos: list[tuple[str, bytes]], bar_mm: float | None = None) -> Read:
    """photos: names and what their files hold, of one painted sheet; bar_mm: how long the printed bar is by a ruler,
    where the page was not printed at 100 %. Several photographs must agree; their paint is averaged, and the view is
    that of the one whose markers lie farthest off. Error in one sentence, with the file."""
    size = _size(chart, bar_mm)
    middle = np.array(chart.plan.sheet_mm) / 2

    def lies(points) -> np.ndarray:
        return (np.asarray(points, float) - middle) * size + middle

    corners = {marker.id: lies(marker.corners_mm) for marker in chart.markers}
    shown = Printed(chart.plan.sheet_mm, corners, chart.dictionary, chart.id)
    printed = [each.mean(axis=0) + (each - each.mean(axis=0)) * (1 + 2 * MARGIN) for each in corners.values()]
    printed += [lies(ring) for ring in bar_rings(chart.bar, beyond_mm=0.5)] if chart.bar else []
    labels = [lies(np.reshape(label_box(label), (2, 2))).ravel() for label in chart.labels]
    rooms = [Room(stroke.id, stroke.box_mm) for stroke in chart.strokes]
    reads: list[Read] = []
    for name, data in photos:
        try:
            pixels = read_photo(data)
            view = find_view(pixels, shown)
            fine = reads[0].flat.px_per_mm if reads else None
            flat = flatten(pixels, view, chart.plan.sheet_mm, fine)
            reads.append(Read(chart, flat, view, find_marks(flat, rooms, printed, labels)))
        except Error as refusal:
            raise Error(
                refusal.sentence,
                refusal.where,
                refusal.value,
                refusal.range,
                name,
                code=refusal.code,
                advice=refusal.advice,
            ) from None
    if len(reads) == 1:
        return reads[0]
    marks = told_apart(np.mean([each.marks.paint for each in reads], axis=0), reads[0].flat, rooms, labels)
    for (name, _), each in zip(photos, reads, strict=True):
        _refuse_another_sheet(each.marks, marks, name)
    worst = max((each.view for each in reads), key=lambda view: view.residual_mm)
    return Read(chart, reads[0].flat, worst, marks, len(reads))


def _refuse_another_sheet(one: Marks, all_: Marks, name: str) -> None:
    """By how far its marks lie from the mean of all photographs."""
    both = [stroke for stroke in one.outlines_mm if stroke in all_.outlines_mm]
    off = [
        np.vstack(one.outlines_mm[stroke]).mean(axis=0) - np.vstack(all_.outlines_mm[stroke]).mean(axis=0)
        for stroke in both
    ]
    away = float(np.sqrt(np.mean(np.sum(np.square(off), axis=1)))) if off else np.inf
    if away > ALIKE_MM:
        raise Error(
            f"its marks lie {away:.2f} mm (rms) from where all photographs have them on average, more than "
            f"{ALIKE_MM:g}: are they of one sheet, which lay flat?",
            file=name,
            code="photos-differ",
        )


def _size(chart: Chart, bar_mm: float | None) -> float:
    if bar_mm is None:
        return 1.0
    if chart.bar is None:
        raise Error(
            "this chart.json has no bar to measure: print a page of today's `brushsvg chart`",
            "bar",
            code="bar-missing",
        )
    size = bar_mm / chart.bar.length_mm
    if not ANOTHER_SIZE[0] <= size <= ANOTHER_SIZE[1]:
        raise Error(
            f"the bar measures {bar_mm:g} mm instead of {chart.bar.length_mm:g} mm, the range is "
            f"[{ANOTHER_SIZE[0] * chart.bar.length_mm:g}, {ANOTHER_SIZE[1] * chart.bar.length_mm:g}] mm: print the "
            "page again, at 100 %",
            "bar",
            bar_mm,
            code="page-scale",
        )
    return size


def edge_mm(read: Read) -> float:
    """By how much all edges may lie off together, as a standard deviation."""
    return EDGE_PX / read.view.px_per_mm


def marks_of(read: Read) -> list[dict]:
    """As a measurement file lists them."""
    return [
        {"stroke": stroke, "outline_mm": [ring.round(3).tolist() for ring in rings]}
        for stroke, rings in read.marks.outlines_mm.items()
    ]


def write_marks(read: Read) -> str:
    """A measurement file, which `brushsvg calibrate` takes."""
    plan = _core.write_plan(read.chart.plan).strip()
    rows = ",\n  ".join(json.dumps(row) for row in marks_of(read))
    head = '"format": "brushsvg/measurements", "version": 1'
    return f'{{{head},\n "plan": {plan},\n "marks": [\n  {rows}]}}\n'


def told(read: Read) -> str:
    """How well it could be read, in one line."""
    view, count, found = read.view, len(read.chart.strokes), len(read.marks.outlines_mm)
    strokes = f"{found} strokes" if found == count else f"{found} of {count} strokes"
    strokes += f" read from {read.photos} photographs" if read.photos > 1 else " read"
    return (
        f"{strokes}, {len(view.seen)} markers within {view.residual_mm:.3f} mm (rms), "
        f"{view.px_per_mm:.1f} pixels per mm, edges blurred over {view.blur_mm:.2f} mm"
    )


def remarks(read: Read) -> list[Notice]:
    """What a person should know of before a brush is made of it."""
    out = []
    view = read.view
    if view.residual_mm > 0.5 * view.most_residual_mm:
        sentence = (
            f"the markers lie {view.residual_mm:.2f} mm (rms) off, marker {view.worst[0]} most: the paper may not be "
            "flat, and marks may lie off by more than that"
        )
        out.append(Notice("", sentence, code="photo-not-flat"))
    if missing := read.marks.missing:
        each = "stroke" if len(missing) == 1 else "strokes"
        sentence = f"no paint is found of {each} {', '.join(missing)}, left out"
        out.append(Notice("", sentence, code="mark-missing"))
    for one, other in read.marks.joined:
        sentence = f"its mark touches that of {other}: they are cut apart half way between their places"
        out.append(Notice(one, sentence, code="marks-touch"))
    unseen = [marker.id for marker in read.chart.markers if marker.id not in view.seen]
    if unseen:
        sentence = f"marker{'s' * (len(unseen) > 1)} {', '.join(map(str, unseen))} cannot be seen"
        out.append(Notice("", sentence, code="photo-markers-missing"))
    return out
