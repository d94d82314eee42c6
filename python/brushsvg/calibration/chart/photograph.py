"""Read the marks of a painted chart from photographs.

The quality of the pictures is checked as well.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace

import numpy as np

from ... import _core
from ...errors import Error, Notice
from ...photo.edges import Marks, assign_marks, find_marks, printed_pixels
from ...photo.flatten import Flat, flatten
from ...photo.markers import TOO_WHITE, Printed, View, find_view
from ...photo.photo import grey_light, jpeg_quality, read_photo, refuse_dark_paper, refuse_twice
from ...photo.photo_checks import refuse_cropped, refuse_unsure
from ...photo.place_by_strokes import find_scan_view
from ...photo.print_scale import find_paint
from ...photo.stroke_boxes import StrokeBox
from .layout import Chart
from .page import bar_rings, label_box

PAGE_SCALE_RANGE = (0.9, 1.1)  # scales of the page that --bar corrects; beyond them, strokes meet labels and markers
MARKER_MARGIN = 1 / 5  # margin around a marker for blur, as a share of its side
# Standard deviation of a common shift of all edges of a picture. Dark paint is 0.02 to 0.08 px outward. Yellow paint,
# for which JPEG keeps one colour for four pixels, is 0.11 to 0.19 px outward. With 0.2, the lag of a narrow brush had
# intervals five times as wide as its errors, because the paper height hardly changes its width.
EDGE_PX = 0.1
MIN_JPEG_QUALITY = 12.0  # least quality of a JPEG; below it, its blocks of 8 pixels hide the edges
MAX_PLACE_ERROR_MM = 0.1  # standard deviation of a place on the sheet from which a remark warns
# Standard deviation of the position of a sheet on a scan, from boxes that contain the marks of brushes that trail as
# expected.
SCAN_PLACEMENT_MM = 3.0
UPSIDE_DOWN_DEG = 179.0  # from this turn on, the sheet is upside down and the direction of the turn is not reported
# Codes of errors about paint outside the strokes of the page. The page may then have been printed at another scale.
DISPLACED_PAGE_CODES = ("photo-paint-elsewhere", "photo-covered", "mark-missing")
# Least visible difference between the scale of the paint and of its page. Brushes that trail differently scatter the
# scale that strokes show.
MIN_VISIBLE_SCALE_CHANGE = 0.01
# Largest rms distance between photographs of one flat sheet; a second painted sheet differs more.
MAX_SHEET_DIFFERENCE_MM = 0.15


@dataclass(frozen=True)
class ChartReading:
    """The contents of a photograph.

    flat: the flattened picture. view: the view of the camera. marks: the marks of the strokes.

    is_rescaled: the page was not printed at 100 %, so only its strokes show its position.
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
) -> ChartReading:
    """Read one or more photographs of one painted sheet.

    photos: names and contents of the files. bar_mm: length of the printed bar, measured with a ruler, if the page was
    not printed at 100 %. dpi: resolution of a flatbed scan of a sheet without print. mirrored: the pictures were taken
    from below, through a clear sheet and glass.

    Several photographs must agree. Their paint is averaged, and the view is taken from the photograph with the largest
    residual of its markers.

    Raises Error with one sentence and the name of the file.
    """
    size = _page_scale(chart, bar_mm)
    page = _make_page(chart, size)
    stroke_boxes = [StrokeBox(stroke.id, stroke.box_mm, stroke.depth_mm) for stroke in chart.strokes]
    refuse_twice(photos)
    reads: list[ChartReading] = []
    for name, data in photos:
        try:
            pixels = read_photo(data)
            _refuse_compressed(data)
            if mirrored:
                pixels = np.ascontiguousarray(pixels[:, ::-1])
            fine = reads[0].flat.px_per_mm if reads else None
            if dpi is not None:
                pixels, view = find_scan_view(
                    pixels, dpi, chart.plan.sheet_mm, stroke_boxes, _stroke_paths(chart), chart.dictionary
                )
                reads.append(_read_photo(chart, replace(page, rings=(), labels=()), stroke_boxes, pixels, view, fine))
                continue
            view = _find_view(pixels, page.printed, mirrored)
            try:
                reads.append(_read_photo(chart, page, stroke_boxes, pixels, view, fine))
            except Error as refusal:
                # All photographs of one sheet have the same place.
                if refusal.code not in DISPLACED_PAGE_CODES or reads:
                    raise
                page = _moved_page(chart, page, size, stroke_boxes, pixels, view, refusal)
                view = _find_view(pixels, page.printed, mirrored)
                reads.append(_read_photo(chart, page, stroke_boxes, pixels, view, fine))
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
    marks = assign_marks(np.mean([read.marks.paint for read in reads], axis=0), reads[0].flat, stroke_boxes)
    for (name, _), read in zip(photos, reads, strict=True):
        _refuse_another_sheet(read.marks, marks, name)
    worst = max((read.view for read in reads), key=lambda view: view.residual_mm)
    return ChartReading(chart, reads[0].flat, worst, marks, len(reads), page.is_rescaled)


@dataclass(frozen=True)
class _Page:
    """The print on the sheet, with its positions.

    printed: the markers. rings: outlines around everything that is as dark as paint. labels: boxes of labels.
    is_rescaled: the page was not printed at 100 %, and the fixed point of the scaling is unknown.
    """

    printed: Printed
    rings: tuple
    labels: tuple
    is_rescaled: bool = False


def _make_page(chart: Chart, size: float, shift_mm=None) -> _Page:
    """Return the page, scaled by `size` about its middle and then shifted."""
    middle = np.array(chart.plan.sheet_mm) / 2

    def placed(points) -> np.ndarray:
        return (np.asarray(points, float) - middle) * size + middle + (0.0 if shift_mm is None else shift_mm)

    corners = {marker.id: placed(marker.corners_mm) for marker in chart.markers}
    rings = [
        square.mean(axis=0) + (square - square.mean(axis=0)) * (1 + 2 * MARKER_MARGIN) for square in corners.values()
    ]
    rings += [placed(ring) for ring in bar_rings(chart.bar, beyond_mm=0.5)] if chart.bar else []
    labels = [placed(np.reshape(label_box(label), (2, 2))).ravel() for label in chart.labels]
    printed = Printed(chart.plan.sheet_mm, corners, chart.dictionary, chart.id)
    return _Page(printed, tuple(rings), tuple(labels), size != 1.0)


def _read_photo(
    chart: Chart, page: _Page, stroke_boxes: list[StrokeBox], pixels: np.ndarray, view: View, fine
) -> ChartReading:
    refuse_cropped(pixels, view, stroke_boxes)
    refuse_unsure(pixels, view, page.printed.corners_mm)
    flat = flatten(pixels, view, chart.plan.sheet_mm, fine)
    refuse_dark_paper(float(np.median(grey_light(flat.pixels[::3, ::3]))))
    marks = find_marks(flat, stroke_boxes, page.rings, page.labels)
    return ChartReading(chart, flat, view, marks, is_rescaled=page.is_rescaled)


def _moved_page(chart: Chart, page: _Page, size: float, stroke_boxes, pixels, view: View, refusal: Error) -> _Page:
    """Return the page at the position of its strokes, if the strokes are displaced from the printed page.

    A page of a known size may have been scaled about a point other than its middle. Raises Error with the scale if the
    page seems to have been printed at another scale, and the refusal in all other cases.
    """
    flat = flatten(pixels, view, chart.plan.sheet_mm)
    known_scale = 1.0 if size != 1.0 else None
    pose = find_paint(flat, printed_pixels(flat, page.rings), stroke_boxes, _stroke_paths(chart), known_scale)
    if pose is None:
        raise refusal
    if known_scale is not None:
        return _make_page(chart, size, -np.array(pose.shift_mm))
    if abs(pose.scale - 1) < MIN_VISIBLE_SCALE_CHANGE:
        raise refusal
    share = f"{100 * abs(pose.scale - 1):.0f} % {'larger' if pose.scale > 1 else 'smaller'}"
    sentence = f"the paint is {share} than the printed page: the page was printed at about {100 / pose.scale:.0f} %. "
    if chart.bar is None:
        sentence += "Print it again at 100 %"
    else:
        full = chart.bar.length_mm
        sentence += (
            f"Measure the bar on the page and give its length, as in --bar {full / pose.scale:.0f}. "
            f"If it is {full:g} mm long, the machine moves too {'far' if pose.scale > 1 else 'little'}: correct its "
            "steps per mm"
        )
    raise Error(sentence, "bar", 1 / pose.scale, code="page-scale") from None


def _find_view(pixels: np.ndarray, shown: Printed, mirrored: bool) -> View:
    try:
        return find_view(pixels, shown)
    except Error as refusal:
        if not mirrored or refusal.code != "photo-mirrored":
            raise
        sentence = "the picture shows the page from above, but --mirrored is for pictures from below through glass"
        raise Error(sentence, code="photo-mirrored") from None


def _stroke_paths(chart: Chart) -> list[np.ndarray]:
    """Return the path of the TCP on the paper for each stroke."""
    return [np.array(stroke_pass.poses_mm)[:, :2] for stroke_pass in chart.plan.passes]


def _refuse_compressed(data: bytes) -> None:
    quality = jpeg_quality(data)
    if quality is not None and quality < MIN_JPEG_QUALITY:
        raise Error(
            f"the JPEG was saved at quality {quality:.0f} of 100, at least {MIN_JPEG_QUALITY:g} is needed: use the "
            "original file of the camera, not one that a messenger sent",
            value=quality,
            code="photo-compressed",
        )


def _refuse_another_sheet(photo_marks: Marks, mean_marks: Marks, name: str) -> None:
    """Raise Error if the positions of marks in one photograph differ from the mean of all photographs."""
    both = [stroke for stroke in photo_marks.outlines_mm if stroke in mean_marks.outlines_mm]
    offsets = [
        np.vstack(photo_marks.outlines_mm[stroke]).mean(axis=0) - np.vstack(mean_marks.outlines_mm[stroke]).mean(axis=0)
        for stroke in both
    ]
    distance = float(np.sqrt(np.mean(np.sum(np.square(offsets), axis=1)))) if offsets else np.inf
    if distance > MAX_SHEET_DIFFERENCE_MM:
        raise Error(
            f"its marks are {distance:.2f} mm (rms) from their mean places in all photographs, more than "
            f"{MAX_SHEET_DIFFERENCE_MM:g} mm: pass only photographs of one sheet that was flat",
            file=name,
            code="photos-differ",
        )


def _page_scale(chart: Chart, bar_mm: float | None) -> float:
    if bar_mm is None:
        return 1.0
    if chart.bar is None:
        sentence = "this chart.json has no bar to measure: print a new page with `brushsvg chart`"
        raise Error(sentence, "bar", code="bar-missing")
    size = bar_mm / chart.bar.length_mm
    if not PAGE_SCALE_RANGE[0] <= size <= PAGE_SCALE_RANGE[1]:
        sentence = (
            f"the bar measures {bar_mm:g} mm instead of {chart.bar.length_mm:g} mm, outside the range "
            f"[{PAGE_SCALE_RANGE[0] * chart.bar.length_mm:g}, {PAGE_SCALE_RANGE[1] * chart.bar.length_mm:g}] mm: print "
            "the page again at 100 %"
        )
        raise Error(sentence, "bar", bar_mm, code="page-scale")
    return size


def edge_mm(read: ChartReading) -> float:
    """Return the standard deviation of a common shift of all edges [mm]."""
    return EDGE_PX / read.view.px_per_mm


def list_measured_marks(read: ChartReading) -> list[dict]:
    """Return the marks as a measurement file lists them."""
    return [
        {"stroke": stroke, "outline_mm": [ring.round(3).tolist() for ring in rings]}
        for stroke, rings in read.marks.outlines_mm.items()
    ]


def get_expected_errors(read: ChartReading) -> dict:
    """Return the expected error of the sheet position, as a key of a measurement file."""
    return {} if read.view.seen and not read.is_rescaled else {"placement_mm": SCAN_PLACEMENT_MM}


def write_measurements(read: ChartReading) -> str:
    """Return a measurement file for `brushsvg calibrate`."""
    plan = _core.write_plan(read.chart.plan).strip()
    rows = ",\n  ".join(json.dumps(row) for row in list_measured_marks(read))
    head = '"format": "brushsvg/measurements", "version": 1'
    if errors := get_expected_errors(read):
        head += f',\n "expected": {json.dumps(errors)}'
    return f'{{{head},\n "plan": {plan},\n "marks": [\n  {rows}]}}\n'


def describe_reading(read: ChartReading) -> str:
    """Describe in one line how well the photograph could be read."""
    view, count, found_count = read.view, len(read.chart.strokes), len(read.marks.outlines_mm)
    strokes = f"{found_count} strokes" if found_count == count else f"{found_count} of {count} strokes"
    strokes += f" read from {read.photos} photographs" if read.photos > 1 else " read"
    if not view.seen:
        across, down = view.homography[:2, 0]
        turn = math.degrees(math.atan2(-down, across))
        side = " to the left" if turn > 0 else " to the right"
        turned = f"{abs(turn):.1f} degrees{side if abs(turn) < UPSIDE_DOWN_DEG else ''}"
        return f"{strokes} from a scan, turned by {turned}, {view.px_per_mm:.1f} pixels per mm"
    return (
        f"{strokes}, {len(view.seen)} markers within {view.residual_mm:.3f} mm (rms), "
        f"{view.px_per_mm:.1f} pixels per mm, edges blurred over {view.blur_mm:.2f} mm"
    )


def report_reading_notices(read: ChartReading) -> list[Notice]:
    """Return notices to read before a brush is made from the photograph."""
    notices = []
    view = read.view
    if view.residual_mm > 0.5 * view.most_residual_mm:
        sentence = (
            f"the markers are {view.residual_mm:.2f} mm (rms) from where flat paper would have them, marker "
            f"{view.worst[0]} most: the paper may not be flat, or the picture is noisy. Marks may be off by more"
        )
        notices.append(Notice("", sentence, code="photo-not-flat"))
    if view.white > TOO_WHITE:
        sentence = (
            f"the picture is overexposed ({100 * view.white:.0f} % of its brightest parts are pure white), so edges "
            "may be too far out: take it with less light"
        )
        notices.append(Notice("", sentence, code="photo-overexposed"))
    if missing := read.marks.missing:
        each = "stroke" if len(missing) == 1 else "strokes"
        sentence = (
            f"no paint of {each} {', '.join(missing)} was found. The calibration continues "
            f"without {'it' if len(missing) == 1 else 'them'}{_describe_remaining(read, missing)}"
        )
        notices.append(Notice("", sentence, code="mark-missing"))
    for stroke, other in read.marks.joined:
        sentence = f"its mark touches the mark of {other}: the paint is divided half way between the two strokes"
        notices.append(Notice(stroke, sentence, code="marks-touch"))
    unseen = [marker.id for marker in read.chart.markers if marker.id not in view.seen]
    if unseen and view.seen:
        sentence = f"marker{'s' * (len(unseen) > 1)} {', '.join(map(str, unseen))} cannot be seen completely"
        if view.unsure_mm > MAX_PLACE_ERROR_MM:
            sentence += f": places on the sheet may be off by {view.unsure_mm:.2f} mm (standard deviation)"
        notices.append(Notice("", sentence, code="photo-markers-missing"))
    return notices


def _describe_remaining(read: ChartReading, missing: list[str]) -> str:
    """Describe how many strokes are left at the depths where strokes are missing."""
    strokes = read.chart.strokes
    depths = sorted({stroke.depth_mm for stroke in strokes if stroke.id in missing})
    strokes_by_depth = {depth: [stroke.id for stroke in strokes if stroke.depth_mm == depth] for depth in depths}
    parts = [
        f"{sum(name not in missing for name in names)} of {len(names)} at {depth:g} mm"
        for depth, names in strokes_by_depth.items()
    ]
    return f"; remaining strokes: {', '.join(parts)} depth"
