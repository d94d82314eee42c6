"""A photograph of a painted chart: the strokes on it as marks in mm, and what the picture was like."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace

import numpy as np

from ... import _core
from ...errors import Error, Notice
from ...photo.edges import Marks, StrokeBox, assign_marks, find_marks, printed_pixels
from ...photo.flatten import Flat, flatten
from ...photo.markers import TOO_WHITE, Printed, View, find_view
from ...photo.photo import grey_light, jpeg_quality, read_photo, refuse_dark_paper, refuse_twice
from ...photo.place_by_strokes import find_scan_view
from ...photo.print_scale import find_paint
from ...photo.whole_page import refuse_cropped, refuse_unsure
from .layout import Chart
from .page import bar_rings, label_box

ANOTHER_SIZE = (0.9, 1.1)  # of the page, which --bar corrects; beyond, strokes run into labels and markers
MARGIN = 1 / 5  # of a marker's side around it: blur
# Standard deviation of the shift of all edges of a picture together: dark paint is 0.02 to 0.08 px outward, yellow,
# of which JPEG keeps one colour for four pixels, 0.11 to 0.19. With 0.2 the lag of a narrow brush, whose width the
# paper's height changes as little, had intervals five times as wide as its errors.
EDGE_PX = 0.1
WORST_QUALITY = 12.0  # of a JPEG: its squares of 8 pixels take the places of edges
UNSURE_MM = 0.1  # of a place on the sheet: remarked on
# Standard deviation of a sheet's place on a scan, by rooms that hold the marks of brushes that trail as thought
SCAN_PLACEMENT_MM = 3.0
HALF_TURN_DEG = 179.0  # from here on it is upside down, whichever way it was turned
# Refusals of paint that is not where the page has its strokes: then the page may have been printed at another scale
OF_ANOTHER_PLACE = ("photo-paint-elsewhere", "photo-covered", "mark-missing")
LEAST_SCALE_SEEN = (
    0.01  # of the paint against its page: brushes that trail otherwise scatter what strokes show of it
)
ALIKE_MM = 0.15  # photographs of one flat sheet; a robot paints a second one less alike


@dataclass(frozen=True)
class Read:
    """What a photograph shows: the flattened picture, the camera's view, marks by stroke.

    is_rescaled: the page was not printed at 100 %, so its place is known by its strokes only.
    """

    chart: Chart
    flat: Flat
    view: View
    marks: Marks
    photos: int = 1
    is_rescaled: bool = False


def read_chart_photos(
    chart: Chart,
    photos: list[tuple[str, bytes]],
    bar_mm: float | None = None,
    dpi: float | None = None,
    mirrored: bool = False,
) -> Read:
    """photos: names and what their files hold, of one painted sheet; bar_mm: how long the printed bar is by a ruler,
    where the page was not printed at 100 %; dpi: of a flatbed's scan of a sheet on which nothing is printed; mirrored:
    taken from below, through a clear sheet and glass. Several
    photographs must agree; their paint is averaged, and the view is that of the one whose markers are farthest off.
    Error in one sentence, with the file."""
    size = _size(chart, bar_mm)
    page = _page(chart, size)
    stroke_boxes = [StrokeBox(stroke.id, stroke.box_mm, stroke.depth_mm) for stroke in chart.strokes]
    refuse_twice(photos)
    reads: list[Read] = []
    for name, data in photos:
        try:
            pixels = read_photo(data)
            _refuse_compressed(data)
            if mirrored:
                pixels = np.ascontiguousarray(pixels[:, ::-1])
            fine = reads[0].flat.px_per_mm if reads else None
            if dpi is not None:
                pixels, view = find_scan_view(
                    pixels, dpi, chart.plan.sheet_mm, stroke_boxes, _pressed(chart), chart.dictionary
                )
                reads.append(
                    _read(chart, replace(page, rings=(), labels=()), stroke_boxes, pixels, view, fine)
                )
                continue
            view = _view(pixels, page.printed, mirrored)
            try:
                reads.append(_read(chart, page, stroke_boxes, pixels, view, fine))
            except Error as refusal:
                if refusal.code not in OF_ANOTHER_PLACE or reads:  # photographs of one sheet have one place
                    raise
                page = _moved_page(chart, page, size, stroke_boxes, pixels, view, refusal)
                view = _view(pixels, page.printed, mirrored)
                reads.append(_read(chart, page, stroke_boxes, pixels, view, fine))
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
    marks = assign_marks(
        np.mean([each.marks.paint for each in reads], axis=0), reads[0].flat, stroke_boxes, page.labels
    )
    for (name, _), each in zip(photos, reads, strict=True):
        _refuse_another_sheet(each.marks, marks, name)
    worst = max((each.view for each in reads), key=lambda view: view.residual_mm)
    return Read(chart, reads[0].flat, worst, marks, len(reads), page.is_rescaled)


@dataclass(frozen=True)
class _Page:
    """What is printed, where it is on the sheet: markers; rings round all that is as dark as paint; boxes of labels.
    is_rescaled: at another scale than 100 %, about a point that is not known."""

    printed: Printed
    rings: tuple
    labels: tuple
    is_rescaled: bool = False


def _page(chart: Chart, size: float, shift_mm=None) -> _Page:
    """Print the page at `size` about its middle, then move it."""
    middle = np.array(chart.plan.sheet_mm) / 2

    def placed(points) -> np.ndarray:
        return (np.asarray(points, float) - middle) * size + middle + (0.0 if shift_mm is None else shift_mm)

    corners = {marker.id: placed(marker.corners_mm) for marker in chart.markers}
    rings = [each.mean(axis=0) + (each - each.mean(axis=0)) * (1 + 2 * MARGIN) for each in corners.values()]
    rings += [placed(ring) for ring in bar_rings(chart.bar, beyond_mm=0.5)] if chart.bar else []
    labels = [placed(np.reshape(label_box(label), (2, 2))).ravel() for label in chart.labels]
    printed = Printed(chart.plan.sheet_mm, corners, chart.dictionary, chart.id)
    return _Page(printed, tuple(rings), tuple(labels), size != 1.0)


def _read(
    chart: Chart, page: _Page, stroke_boxes: list[StrokeBox], pixels: np.ndarray, view: View, fine
) -> Read:
    refuse_cropped(pixels, view, stroke_boxes)
    refuse_unsure(pixels, view, page.printed.corners_mm)
    flat = flatten(pixels, view, chart.plan.sheet_mm, fine)
    refuse_dark_paper(float(np.median(grey_light(flat.pixels[::3, ::3]))))
    marks = find_marks(flat, stroke_boxes, page.rings, page.labels)
    return Read(chart, flat, view, marks, is_rescaled=page.is_rescaled)


def _moved_page(
    chart: Chart, page: _Page, size: float, stroke_boxes, pixels, view: View, refusal: Error
) -> _Page:
    """Where strokes are not where the page has them: the page of a known size that was printed about another point than
    its middle. Error naming the scale where the page seems to have been printed at another one; else the refusal."""
    flat = flatten(pixels, view, chart.plan.sheet_mm)
    known = 1.0 if size != 1.0 else None
    found = find_paint(flat, printed_pixels(flat, page.rings), stroke_boxes, _pressed(chart), known)
    if found is None:
        raise refusal
    if known is not None:
        return _page(chart, size, -np.array(found.shift_mm))
    if abs(found.scale - 1) < LEAST_SCALE_SEEN:
        raise refusal
    share = f"{100 * abs(found.scale - 1):.0f} % {'larger' if found.scale > 1 else 'smaller'}"
    sentence = f"the paint is {share} than the printed page: the page was printed at about {100 / found.scale:.0f} %. "
    if chart.bar is None:
        sentence += "Print it again at 100 %"
    else:
        full = chart.bar.length_mm
        sentence += (
            f"Measure the bar on the page and give its length, as in --bar {full / found.scale:.0f}. "
            f"If it is {full:g} mm long, the machine moves too {'far' if found.scale > 1 else 'little'}: correct its "
            "steps per mm"
        )
    raise Error(sentence, "bar", 1 / found.scale, code="page-scale") from None


def _view(pixels: np.ndarray, shown: Printed, mirrored: bool) -> View:
    try:
        return find_view(pixels, shown)
    except Error as refusal:
        if not mirrored or refusal.code != "photo-mirrored":
            raise
        sentence = (
            "the picture shows the page from above, not mirrored as from below through glass: no --mirrored"
        )
        raise Error(sentence, code="photo-mirrored") from None


def _pressed(chart: Chart) -> list[np.ndarray]:
    """The TCP's way along each stroke on the paper."""
    return [np.array(one.poses_mm)[:, :2] for one in chart.plan.passes]


def _refuse_compressed(data: bytes) -> None:
    quality = jpeg_quality(data)
    if quality is not None and quality < WORST_QUALITY:
        raise Error(
            f"the JPEG was saved at quality {quality:.0f} of 100, at least {WORST_QUALITY:g} is needed: give the "
            "picture as the camera wrote it, not as a messenger sent it on",
            value=quality,
            code="photo-compressed",
        )


def _refuse_another_sheet(one: Marks, all_: Marks, name: str) -> None:
    """Sort by the distance of their marks from the mean of all photographs."""
    both = [stroke for stroke in one.outlines_mm if stroke in all_.outlines_mm]
    off = [
        np.vstack(one.outlines_mm[stroke]).mean(axis=0) - np.vstack(all_.outlines_mm[stroke]).mean(axis=0)
        for stroke in both
    ]
    away = float(np.sqrt(np.mean(np.sum(np.square(off), axis=1)))) if off else np.inf
    if away > ALIKE_MM:
        raise Error(
            f"its marks are {away:.2f} mm (rms) from where all photographs have them on average, more than "
            f"{ALIKE_MM:g}: are they of one flat sheet?",
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
    """Return by how much all edges may be off together, as a standard deviation."""
    return EDGE_PX / read.view.px_per_mm


def marks_of(read: Read) -> list[dict]:
    """As a measurement file lists them."""
    return [
        {"stroke": stroke, "outline_mm": [ring.round(3).tolist() for ring in rings]}
        for stroke, rings in read.marks.outlines_mm.items()
    ]


def expected(read: Read) -> dict:
    """How far the sheet may be off, as a measurement file says it."""
    return {} if read.view.seen and not read.is_rescaled else {"placement_mm": SCAN_PLACEMENT_MM}


def write_marks(read: Read) -> str:
    """A measurement file, which `brushsvg calibrate` takes."""
    plan = _core.write_plan(read.chart.plan).strip()
    rows = ",\n  ".join(json.dumps(row) for row in marks_of(read))
    head = '"format": "brushsvg/measurements", "version": 1'
    if off := expected(read):
        head += f',\n "expected": {json.dumps(off)}'
    return f'{{{head},\n "plan": {plan},\n "marks": [\n  {rows}]}}\n'


def describe_reading(read: Read) -> str:
    """How well it could be read, in one line."""
    view, count, found = read.view, len(read.chart.strokes), len(read.marks.outlines_mm)
    strokes = f"{found} strokes" if found == count else f"{found} of {count} strokes"
    strokes += f" read from {read.photos} photographs" if read.photos > 1 else " read"
    if not view.seen:
        across, down = view.homography[:2, 0]
        turn = math.degrees(math.atan2(-down, across))
        side = " to the left" if turn > 0 else " to the right"
        turned = f"{abs(turn):.1f} degrees{side if abs(turn) < HALF_TURN_DEG else ''}"
        return f"{strokes} from a scan, turned by {turned}, {view.px_per_mm:.1f} pixels per mm"
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
            f"the markers are {view.residual_mm:.2f} mm (rms) off, marker {view.worst[0]} most: the paper may not be "
            "flat, or the picture is noisy, and marks may be off by more than that"
        )
        out.append(Notice("", sentence, code="photo-not-flat"))
    if view.white > TOO_WHITE:
        sentence = (
            f"{100 * view.white:.0f} % of the brightest parts are as white as can be: the picture is overexposed, and "
            "edges may be too far out"
        )
        out.append(Notice("", sentence, code="photo-overexposed"))
    if missing := read.marks.missing:
        each = "stroke" if len(missing) == 1 else "strokes"
        sentence = f"no paint is found of {each} {', '.join(missing)}, left out{_left_at(read, missing)}"
        out.append(Notice("", sentence, code="mark-missing"))
    for one, other in read.marks.joined:
        sentence = f"its mark touches that of {other}: they are cut apart half way between their places"
        out.append(Notice(one, sentence, code="marks-touch"))
    unseen = [marker.id for marker in read.chart.markers if marker.id not in view.seen]
    if unseen and view.seen:
        sentence = f"marker{'s' * (len(unseen) > 1)} {', '.join(map(str, unseen))} cannot be seen whole"
        if view.unsure_mm > UNSURE_MM:
            sentence += f": places on the sheet may be off by {view.unsure_mm:.2f} mm (standard deviation)"
        out.append(Notice("", sentence, code="photo-markers-missing"))
    return out


def _left_at(read: Read, missing: list[str]) -> str:
    """What is left of the depths at which strokes are missing."""
    strokes = read.chart.strokes
    depths = sorted({stroke.depth_mm for stroke in strokes if stroke.id in missing})
    of = {depth: [stroke.id for stroke in strokes if stroke.depth_mm == depth] for depth in depths}
    parts = [
        f"{sum(name not in missing for name in names)} of {len(names)} at {depth:g} mm"
        for depth, names in of.items()
    ]
    return f"; strokes that are left: {', '.join(parts)} depth"
