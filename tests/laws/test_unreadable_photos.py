"""Unreadable photographs are refused or reported with the code of their cause.

They are damaged in twenty ways, wholly or in part. Marks that are still read are at their painted places.
"""

from functools import cache

import cv2
import numpy as np
import photograph
import pytest
from photograph import BLUE, INK, Camera, replace
from sampling import sample
from test_scan import A5, a5, hide, off_mm, painted_marks, painted_sheet

from brushsvg import _core, find_brush
from brushsvg.calibration.chart.layout import chart
from brushsvg.calibration.chart.photograph import read_chart_photos, report_reading_notices
from brushsvg.errors import Error
from brushsvg.photo.markers import Printed, find_view

CAMERA = Camera(size_px=(950, 1300), blur_px=0.6)


def shot(marks=None, things=(), **camera):
    sheet = painted_sheet((marks or painted_marks()).values())
    for ring, colour in things:
        sheet.paint([ring], colour)
    return photograph.exposed(sheet, replace(CAMERA, **camera))


@cache
def good():
    return shot()


def part(top, bottom, left, right):
    rows, columns = good().shape[:2]
    return good()[int(top * rows) : int(bottom * rows), int(left * columns) : int(right * columns)].copy()


def round_(x, y, radius):
    turn = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    return np.column_stack([x + radius * np.cos(turn), y + radius * np.sin(turn)])


def moved(by):
    return {stroke: [ring + np.array(by) for ring in rings] for stroke, rings in painted_marks().items()}


def of_another_chart():
    other, brush = chart(find_brush("round-6"), A5, "few", deepest_mm=9.0), find_brush("round-6")
    marks = _core.simulate(other.plan, brush)
    _core.trace_outlines(marks, brush)
    return {one.stroke: [np.array(ring) for ring in one.outline_mm] for one in marks.passes}


def without_markers(kept):
    pixels = good().copy()
    for marker in a5().markers[kept:]:
        hide(pixels, marker.corners_mm)
    return pixels


def with_a_marker_twice():
    pixels = good().copy()
    around = photograph.corners_seen(CAMERA, A5, np.array(a5().markers[0].corners_mm))
    (left, top), (right, bottom) = around.min(axis=0).astype(int) - 8, around.max(axis=0).astype(int) + 8
    pixels[600 : 600 + bottom - top, 300 : 300 + right - left] = pixels[top:bottom, left:right]
    return pixels


def noise(pixels, deviation: float):
    """Add Gaussian noise, independent for each colour of each pixel."""
    rng = np.random.default_rng(7)
    return np.uint8(np.clip(pixels + rng.normal(0, deviation, pixels.shape), 0, 255))


WHITE = np.array([0.9, 0.9, 0.88])
REFUSED = {
    "nothing on it": (lambda: np.full_like(good(), 120), "photo-markers-missing"),
    "two markers left": (lambda: without_markers(2), "photo-markers-missing"),
    "a marker twice": (with_a_marker_twice, "photo-marker-twice"),
    "mirrored": (lambda: np.ascontiguousarray(good()[:, ::-1]), "photo-mirrored"),
    "right side cropped": (lambda: part(0, 1, 0, 0.75), "photo-cropped"),
    "lower markers cropped": (lambda: part(0, 0.9, 0, 1), "photo-cropped"),
    "too coarse": (
        lambda: cv2.resize(good(), None, fx=0.6, fy=0.6, interpolation=cv2.INTER_AREA),
        "photo-too-coarse",
    ),
    "out of focus": (lambda: shot(blur_px=2.5), "photo-blurred"),
    "far out of focus": (lambda: shot(blur_px=9.0), "photo-blurred"),
    "camera moved": (lambda: shot(motion_px=(15.0, 5.0)), "photo-blurred"),
    "overexposed": (lambda: shot(exposure=8.0), "photo-overexposed"),
    "hard shadow": (lambda: shot(edge=0.8), "photo-covered"),
    "a thing on the page": (lambda: shot(things=[(photograph.box(30, 90, 110, 130), INK)]), "photo-covered"),
    "noise alone": (lambda: noise(np.full_like(good(), 120), 60.0), "photo-noisy"),
    "black or white at random": (lambda: noise(np.full_like(good(), 120), 1e4), "photo-noisy"),
    "noise that moves the markers": (lambda: noise(good(), 60.0), "photo-noisy"),
    "noise that hides the paint": (lambda: noise(good(), 40.0), "photo-noisy"),
    "bulging": (lambda: shot(sag_mm=3.0), "photo-not-flat"),
    "not painted": (lambda: photograph.exposed(photograph.page(a5()), CAMERA), "photo-without-paint"),
    "painted the wrong way round": (
        lambda: shot({stroke: [np.array(A5) - ring for ring in rings] for stroke, rings in painted_marks().items()}),
        "photo-paint-elsewhere",
    ),
    "another chart painted": (lambda: shot(of_another_chart()), "photo-paint-elsewhere"),
    "painted twice": (
        lambda: shot(painted_marks() | {f"{k}-again": rings for k, rings in moved((4.0, 4.0)).items()}),
        "photo-paint-elsewhere",
    ),
    "page not at its stop": (lambda: shot(moved((8.0, 3.0))), "photo-paint-elsewhere"),
    "few strokes painted": (
        lambda: shot({k: rings for k, rings in painted_marks().items() if k.startswith("straight")}),
        "mark-missing",
    ),
}
REPORTED = {
    "two strokes missing": (
        lambda: shot({k: rings for k, rings in painted_marks().items() if k not in ("arc-2", "straight-1")}),
        "mark-missing",
    ),
    "a marker covered": (lambda: without_markers(5), "photo-markers-missing"),
    "glare on a marker": (lambda: shot(glare=(10.0, 200.0, 12.0)), "photo-markers-missing"),
    "a blot over two strokes": (
        lambda: shot(things=[(round_(*np.vstack(painted_marks()["reference-1"]).mean(axis=0), 7.0), BLUE)]),
        "marks-touch",
    ),
    "a bit overexposed": (lambda: shot(exposure=1.5), "photo-overexposed"),
}


def code_of(data):
    with pytest.raises(Error) as refusal:
        read_chart_photos(a5(), [("photo.jpg", data)])
    assert refusal.value.file == "photo.jpg" and len(refusal.value.sentence) > 40
    return refusal.value.code


@sample("kind", REFUSED, keep=8)
def test_a_picture_that_cannot_be_read_is_refused_for_its_cause(kind):
    make, code = REFUSED[kind]
    assert code_of(photograph.encoded(make())) == code


@pytest.mark.parametrize("shape", [(1, 84), (84, 1), (1, 1)])
def test_a_picture_one_pixel_wide_is_refused(shape):
    pixels = np.resize(np.linspace(0, 255, 84).astype(np.uint8), shape)
    assert code_of(photograph.encoded(cv2.cvtColor(pixels, cv2.COLOR_GRAY2BGR)))


def test_a_picture_that_was_saved_too_small_is_refused():
    assert code_of(photograph.encoded(good(), 5)) == "photo-compressed"
    found = read_chart_photos(a5(), [("", photograph.encoded(good(), 30))])
    assert not found.marks.missing and not report_reading_notices(found)


@pytest.mark.parametrize("kind", REPORTED)
def test_partly_readable_pictures_are_reported(kind):
    make, code = REPORTED[kind]
    found = read_chart_photos(a5(), [("", photograph.encoded(make()))])
    reported = {notice.code for notice in report_reading_notices(found)}
    assert code in reported
    touched = {stroke for pair in found.marks.joined for stroke in pair}
    for stroke, rings in painted_marks().items():
        if stroke not in touched and stroke not in found.marks.missing:
            assert off_mm(found.marks.outlines_mm[stroke], rings)[1] < 0.15, stroke


def test_an_object_over_one_marker_does_not_make_the_sheet_bulge():
    """An object over the edge of one marker does not bend the sheet.

    It was once reported as paper that is not flat.
    """
    x, y = np.mean(a5().markers[2].corners_mm, axis=0)
    found = read_chart_photos(
        a5(), [("", photograph.encoded(shot(things=[(photograph.box(x - 12, y - 3, x - 4.5, y + 3), BLUE)])))]
    )
    assert found.view.residual_mm < 0.04
    for stroke, rings in painted_marks().items():
        assert off_mm(found.marks.outlines_mm[stroke], rings)[1] < 0.15, stroke


@pytest.mark.parametrize("deg", [8, 30])
def test_white_around_a_rotated_picture_does_not_affect_the_lighting(deg):
    """White around a turned picture does not count as light of the page.

    Programs fill the corners with white, which was once reported as overexposed.
    """
    rows, columns = good().shape[:2]
    wide = int(np.hypot(rows, columns))
    turn = cv2.getRotationMatrix2D((columns / 2, rows / 2), deg, 1)
    turn[:, 2] += [(wide - columns) / 2, (wide - rows) / 2]
    turned = cv2.warpAffine(good(), turn, (wide, wide), flags=cv2.INTER_CUBIC, borderValue=(255, 255, 255))
    found = read_chart_photos(a5(), [("", photograph.encoded(turned))])
    assert not report_reading_notices(found) and not found.marks.missing


@sample(
    ("cut", "sag_mm", "code"),
    [
        ((0, 1350), 0.0, "photo-cropped"),
        ((210, 1500), 0.0, "photo-cropped"),
        ((0, 1350), 1.5, "photo-not-flat"),
    ],
    keep=1,
)
def test_a_cropped_picture_is_not_reported_as_bulging_paper(cut, sag_mm, code):
    """A picture that was cut on one side is not reported as bulging paper.

    All markers are still on it, but the middle of the lens is not in the picture's middle.
    """
    a4 = chart(find_brush("round-6"), (210.0, 297.0))
    corners = {marker.id: np.array(marker.corners_mm) for marker in a4.markers}
    printed = Printed((210.0, 297.0), corners, a4.dictionary)
    camera = Camera(size_px=(1500, 2100), blur_px=0.6, fill=0.8, bend=-0.07, tilt_deg=(3.0, 2.0), sag_mm=sag_mm)
    whole = photograph.exposed(photograph.page(a4), camera)
    assert sag_mm or len(find_view(whole, printed).seen) == 8
    if cut[0]:
        whole = np.ascontiguousarray(whole[cut[0] :])
    with pytest.raises(Error) as refusal:
        find_view(np.ascontiguousarray(whole[:, : cut[1]]), printed)
    assert refusal.value.code == code


def test_the_thin_marks_of_a_displaced_sheet_are_read():
    """Marks of a liner are 1 to 2 mm wide. On a displaced sheet they are outside of their boxes."""
    made = chart(find_brush("liner-1"), A5, "few")
    marks = _core.simulate(made.plan, find_brush("liner-1"))
    _core.trace_outlines(marks, find_brush("liner-1"))
    painted = {one.stroke: [np.array(ring) + np.array((2.0, 1.5)) for ring in one.outline_mm] for one in marks.passes}
    sheet = photograph.page(made)
    for rings in painted.values():
        sheet.paint(rings, BLUE)
    read = read_chart_photos(made, [("photo.jpg", photograph.encoded(photograph.exposed(sheet, CAMERA)))])
    assert not read.marks.missing and not read.marks.joined
    for stroke, rings in read.marks.outlines_mm.items():
        for end in (np.min, np.max):
            assert end(np.vstack(rings), axis=0) == pytest.approx(end(np.vstack(painted[stroke]), axis=0), abs=1.0)
