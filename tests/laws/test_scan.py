"""Rendered photographs of charts give back the painted marks.

An unreadable photograph is refused with a sentence that says what to do. The renderer has its own camera
model.
"""

import itertools
import json
import re
import subprocess
import sys
from functools import cache

import cv2
import numpy as np
import photograph
import pytest
import shapely
from diagnostics import agrees, in_json, is_reported, refused
from photograph import BLUE, Camera, replace
from sampling import sample

from brushsvg import _core, find_brush
from brushsvg.calibration.chart.file import read_chart, write_chart
from brushsvg.calibration.chart.layout import chart
from brushsvg.calibration.chart.photograph import get_expected_errors, list_measured_marks, read_chart_photos
from brushsvg.cli import main
from brushsvg.photo.edges import assign_marks, paint_seen
from brushsvg.photo.flatten import Flat
from brushsvg.photo.markers import Printed, find_view
from brushsvg.photo.photo import read_photo
from brushsvg.photo.stroke_boxes import StrokeBox

A5 = (148.0, 210.0)
SMALL = Camera(size_px=(950, 1300), blur_px=0.6)  # 5.5 pixels per mm


@cache
def a5():
    return chart(find_brush("round-6"), A5, "few")


@cache
def painted_marks():
    made = a5()
    brush = find_brush("round-6")
    marks = _core.simulate(made.plan, brush)
    _core.trace_outlines(marks, brush)
    return {one.stroke: [np.array(ring) for ring in one.outline_mm] for one in marks.passes}


@cache
def page():
    return photograph.page(a5())


def painted_sheet(marks, colour=BLUE):
    sheet = photograph.Sheet.__new__(photograph.Sheet)
    sheet.size_mm, sheet.shown = A5, page().shown.copy()
    for rings in marks:
        sheet.paint(rings, colour)
    return sheet


@cache
def sheet():
    return painted_sheet(painted_marks().values())


@cache
def small():
    """Return the pixels of one photograph, which many tests damage."""
    return photograph.exposed(sheet(), SMALL)


def read(pixels, **how):
    return read_chart_photos(a5(), [("photo.jpg", photograph.encoded(pixels))], **how)


def shape(rings):
    return shapely.unary_union([shapely.Polygon(ring).buffer(0) for ring in rings])


def off_mm(read_rings, rings):
    """Return the signed mean distance of the read outline from the painted one.

    The second value is its rms without the tips.
    """
    was = shape(rings)
    points = shapely.points(np.vstack(read_rings))
    distance = shapely.distance(points, was.boundary)
    sign = np.where(shapely.contains(was, points), -1, 1)
    kept = distance < np.quantile(distance, 0.97)
    return float(np.mean((sign * distance)[kept])), float(np.sqrt(np.mean(distance[kept] ** 2)))


# Geometry -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "camera",
    [
        SMALL,
        replace(SMALL, tilt_deg=(-12.0, 9.0), turn_deg=80.0, size_px=(1700, 1400), bend=0.02, fill=0.9),
        replace(SMALL, turn_deg=181.0, bend=-0.05, fill=0.8, displacement_mm=(8.0, 8.0), size_px=(1200, 1500)),
    ],
    ids=["straight above", "tilted", "upside down"],
)
def test_points_of_flat_paper_are_found_within_a_twentieth_of_a_millimetre(camera):
    made = a5()
    jpeg = photograph.photograph(sheet(), camera)
    corners = {marker.id: np.array(marker.corners_mm) for marker in made.markers}
    view = find_view(read_photo(jpeg), Printed(A5, corners, made.dictionary))
    at = np.array([(x, y) for x in np.linspace(5, 143, 12) for y in np.linspace(5, 205, 16)])
    off = np.hypot(*(view.to_px(at) - photograph.corners_seen(camera, A5, at)).T) / view.px_per_mm
    assert np.sqrt(np.mean(off**2)) < 0.05 and off.max() < 0.1, (np.sqrt(np.mean(off**2)), off.max())
    assert view.residual_mm < 0.05 and len(view.seen) == len(made.markers)


def test_three_markers_are_enough():
    pixels = small().copy()
    for marker in a5().markers[3:]:
        hide(pixels, marker.corners_mm)
    found = read(pixels)
    assert len(found.view.seen) == 3
    at = np.array([(x, y) for x in np.linspace(5, 143, 12) for y in np.linspace(5, 205, 16)])
    off = np.hypot(*(found.view.to_px(at) - photograph.corners_seen(SMALL, A5, at)).T) / found.view.px_per_mm
    assert np.sqrt(np.mean(off**2)) < 0.25


# Edges ----------------------------------------------------------------------------------------------


@sample(
    ("camera", "colour", "most_mm"),
    [
        (SMALL, BLUE, 0.03),
        (replace(SMALL, shadow=0.5, light=(0.5, 0.3)), BLUE, 0.03),
        (SMALL, np.array([0.75, 0.12, 0.08]), 0.03),
        (SMALL, np.array([0.82, 0.66, 0.06]), 0.06),  # JPEG stores one colour for four pixels
        (SMALL, np.array([0.5, 0.5, 0.5]), 0.03),
    ],
    ids=["blue", "shadow", "red", "yellow", "pale grey"],
    keep=2,
)
def test_outlines_follow_the_edge_of_the_paint(camera, colour, most_mm):
    marks = painted_marks()
    found = read(photograph.exposed(painted_sheet(marks.values(), colour), camera))
    assert not found.marks.missing and not found.marks.joined
    for stroke, rings in marks.items():
        mean, rms = off_mm(found.marks.outlines_mm[stroke], rings)
        assert abs(mean) < most_mm and rms < 0.09, (stroke, mean, rms)


def test_paint_that_is_lighter_than_the_paper_is_read():
    """Paint that is lighter than coloured paper is read.

    The markers are printed black. Light paint once did not count as paint.
    """
    marks = painted_marks()
    card = photograph.Sheet.__new__(photograph.Sheet)
    card.size_mm, card.shown = A5, page().shown * np.float32([0.45, 0.3, 0.35])
    for rings in marks.values():
        card.paint(rings, np.array([0.85, 0.84, 0.8]))
    found = read(photograph.exposed(card, replace(SMALL, light=(0.2, -0.2))))
    assert not found.marks.missing and not found.marks.joined
    for stroke, rings in marks.items():
        mean, rms = off_mm(found.marks.outlines_mm[stroke], rings)
        assert abs(mean) < 0.03 and rms < 0.09, (stroke, mean, rms)


@pytest.mark.parametrize("is_lighter", [False, True], ids=["dark paint", "light paint"])
def test_a_soft_shadow_over_few_narrow_marks_is_not_read_as_paint(is_lighter):
    """A soft shadow over a few narrow marks is not read as paint.

    Most pixels that differ from the rest of the sheet are then shadow.
    """
    fine, size = 5.0, (210.0, 297.0)
    y, x = np.mgrid[0 : round(size[1] * fine), 0 : round(size[0] * fine)] / fine
    number = np.where(is_lighter, 0.35, 0.8) * (1 - 0.3 / (1 + np.exp(-(x / 210 - y / 297 + 0.1) * 25)))
    lines = [StrokeBox(f"{k}", (20.0 + 25 * k, 220.0, 40.0 + 25 * k, 280.0)) for k in range(7)]
    middles = [room.box_mm[0] + 10 for room in lines]
    for middle in middles:
        number[(np.abs(x - middle) < 0.5) & (y > 20) & (y < 70)] *= np.where(is_lighter, 2.0, 0.3)
    pixels = np.repeat(np.uint8(255 * number)[..., None], 3, axis=2)
    paint = paint_seen(Flat(pixels, fine, size), np.zeros(pixels.shape[:2], np.uint8), lines)
    assert (paint > 0.5).mean() < 0.007
    assert all((paint[110:340, round(middle * fine)] > 0.7).all() for middle in middles)


def test_narrow_marks_of_a_blurred_picture_keep_their_width():
    """Narrow marks of a blurred picture have their painted width.

    Blur also weakens the middle of a narrow mark. The edge at half of this weaker value was once 0.05 mm
    outside.
    """
    marks = dict(painted_marks())
    for stroke, width in (("auxiliary-1", 0.7), ("straight-1", 0.9)):
        left, bottom, right, top = shape(marks[stroke]).bounds
        x, y = (left + right) / 2, (bottom + top) / 2
        marks[stroke] = [photograph.box(x - 8, y - width / 2, x + 8, y + width / 2)]
    camera = replace(SMALL, blur_px=1.5, size_px=(1150, 1580))
    found = read(photograph.exposed(painted_sheet(marks.values()), camera))
    for stroke in ("auxiliary-1", "straight-1", "straight-4", "reference-1"):
        assert abs(off_mm(found.marks.outlines_mm[stroke], marks[stroke])[0]) < 0.02, stroke


def test_a_displaced_mark_stays_whole_and_touching_marks_are_split():
    marks = dict(painted_marks())
    boxes = {stroke.id: shapely.box(*stroke.box_mm) for stroke in a5().strokes}
    marks["straight-4"] = [ring + np.array([1.0, -4.5]) for ring in marks["straight-4"]]
    below = shape(marks["straight-4"]).difference(boxes["straight-4"])
    nearer = below.difference(boxes["straight-4"].buffer(boxes["straight-4"].distance(boxes["straight-3"]) / 2))
    assert nearer.area > 3  # the mark's own box is not the nearest one everywhere
    one, other = "reference-1", "reference-2"
    apart = shape(marks[one]).distance(shape(marks[other]))
    for each, way in ((one, 1), (other, -1)):
        side = np.array([way * (0.5 * apart + 0.2), 0.0])
        marks[each] = [ring + side for ring in marks[each]]
    assert shape(marks[one]).intersects(shape(marks[other]))
    found = read(photograph.exposed(painted_sheet(marks.values()), SMALL))
    assert off_mm(found.marks.outlines_mm["straight-4"], marks["straight-4"])[1] < 0.09
    assert found.marks.joined == [(one, other)]
    for each in (one, other):
        overlap = _core.overlap(found.marks.outlines_mm[each], marks[each])
        assert overlap > 0.85, (each, overlap)


def test_a_mark_displaced_into_the_next_box_stays_whole():
    """A mark that is displaced into the next box stays whole.

    A tool that leans does this. A quarter of each mark is in the box of the next one.
    """
    fine, sheet_mm = 5, (170, 50)
    lefts = {"a": 10, "b": 21} | {str(k): 30 + 15 * k for k in range(1, 9)}
    stroke_boxes = [StrokeBox(name, (left, 10, left + 10, 40)) for name, left in lefts.items()]
    at = {name: left + 1 for name, left in lefts.items()} | {"a": 14.4, "b": 25.4}
    target = {name: np.array([[x, 12], [x + 8, 12], [x + 8, 38], [x, 38.0]]) for name, x in at.items()}
    paint = np.zeros((sheet_mm[1] * fine, sheet_mm[0] * fine), np.float32)
    for ring in target.values():
        (left, bottom), (right, top) = np.int32(ring.min(axis=0) * fine), np.int32(ring.max(axis=0) * fine)
        paint[len(paint) - top : len(paint) - bottom, left:right] = 1
    found = assign_marks(paint, Flat(np.zeros((*paint.shape, 3), np.uint8), fine, sheet_mm), stroke_boxes)
    assert not found.joined and not found.missing
    for name, ring in target.items():
        assert _core.overlap(found.outlines_mm[name], [ring]) > 0.9, name


@pytest.mark.parametrize("lean", [(-0.6, 0.5), (0.0, 0.8)])
def test_marks_of_a_strongly_leaning_tool_belong_to_their_strokes(lean):
    """Marks of a strongly leaning tool belong to their own strokes.

    They are so far displaced that they are in the boxes of others. No mark is lost.
    """
    depth = {one.id: one.depth_mm for one in a5().strokes}
    marks = {name: [ring + np.multiply(lean, depth[name]) for ring in rings] for name, rings in painted_marks().items()}
    assert all(shape(one).disjoint(shape(other)) for one, other in itertools.combinations(marks.values(), 2))
    found = read(photograph.exposed(painted_sheet(marks.values()), SMALL)).marks
    assert not found.missing and not found.joined
    for name, rings in marks.items():
        assert _core.overlap(found.outlines_mm[name], rings) > 0.85, name


def test_splashes_and_labels_are_not_marks_and_a_broken_stroke_is_one_mark():
    marks = dict(painted_marks())
    whole = shape(marks["straight-4"])
    left, bottom, right, top = whole.bounds
    gap = shapely.box(left + 0.6 * (right - left), bottom - 1, left + 0.6 * (right - left) + 1.5, top + 1)
    parts = [shapely.geometry.polygon.orient(part) for part in whole.difference(gap).geoms]
    marks["straight-4"] = [np.array(part.exterior.coords)[:-1] for part in parts]
    splash = [np.array(shapely.Point(left + 20, top + 2).buffer(0.6).exterior.coords)]
    found = read(photograph.exposed(painted_sheet([*marks.values(), splash]), SMALL))
    assert len(found.marks.outlines_mm["straight-4"]) == 2
    assert _core.overlap(found.marks.outlines_mm["straight-4"], marks["straight-4"]) > 0.97
    assert not found.marks.missing


def test_a_stroke_without_paint_is_named(tmp_path, capsys):
    marks = {name: rings for name, rings in painted_marks().items() if name not in ("arc-2", "straight-1")}
    photo, desk = tmp_path / "photo.jpg", tmp_path
    photo.write_bytes(photograph.encoded(photograph.exposed(painted_sheet(marks.values()), SMALL)))
    (desk / "chart.json").write_text(write_chart(a5()))
    words = [
        "calibrate",
        str(photo),
        "--scan",
        "--chart",
        str(desk / "chart.json"),
        "-o",
        str(desk / "marks.json"),
    ]
    assert main([*words, "--marks-picture", str(desk / "read.png")]) == 0
    assert re.search(r"\b22 [a-z]+ 24 .*\b6 [a-z ]+ 0\.0", capsys.readouterr().err)
    status, _, reported = in_json(capsys, *words)
    assert status == 0 and is_reported(reported, "mark-missing straight-1 arc-2"), reported
    content = json.loads((desk / "marks.json").read_text())
    assert [row["stroke"] for row in content["marks"]] == [one.id for one in a5().strokes if one.id in marks]
    assert cv2.imread(str(desk / "read.png")).shape[0] > 1000


# Pictures -------------------------------------------------------------------------------------------


@pytest.mark.thorough
def test_other_formats_and_rotated_cameras_give_the_same_marks():
    there = list_measured_marks(read(small()))
    side = np.ascontiguousarray(small().swapaxes(0, 1)[:, ::-1])  # turned clockwise
    held = photograph.with_turn(photograph.encoded(side), 8)
    files = [held] + [
        cv2.imencode(end, small()[..., ::-1], flags)[1].tobytes()
        for end, flags in ((".png", []), (".tif", []), (".webp", [cv2.IMWRITE_WEBP_QUALITY, 95]))
    ]
    for data in files:
        marks = list_measured_marks(read_chart_photos(a5(), [("", data)]))
        assert [row["stroke"] for row in marks] == [row["stroke"] for row in there]
        for ours, theirs in zip(marks, there, strict=True):
            assert _core.overlap(*(list(map(np.array, row["outline_mm"])) for row in (ours, theirs))) > 0.95
    # Only EXIF has the orientation. Without EXIF, the page is still read by its markers.
    assert read_photo(held).shape == (*SMALL.size_px[::-1], 3) != read_photo(photograph.encoded(side)).shape


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (b"", "photo-format .jpg"),
        (b"no picture", "photo-format .jpg"),
        # OpenCV decodes these 32 bytes into 213 million pixels.
        (b"/\xc0r\xfc\x0f\x0fp\x12\xf8\x93\xc0\x9f\x04~\xfe\xe3\x06\xdd-q\xcdJ\x12-.inv{@\0\0", "photo-format .jpg"),
        (b"\xff\xd8\xff\xe0 no JPEG", "photo-damaged"),
        (b"\x00\x00\x00\x18ftypheic" + b"\x00" * 50, "photo-format HEIC JPEG"),
    ],
)
def test_files_that_are_not_pictures_are_refused(data, expected):
    with refused(expected):
        read_chart_photos(a5(), [("", data)])


@pytest.mark.parametrize("depth", [np.uint8, np.uint16])
@pytest.mark.parametrize("suffix", [".png", ".tif"])
def test_transparent_pixels_are_read_as_white(suffix, depth):
    """Transparent pixels are read as white.

    The black colour below transparent pixels was once read as paint.
    """
    full = np.iinfo(depth).max
    picture = np.zeros((40, 30, 4), depth)
    picture[:20, :, 3] = full
    picture[20:30, :, 3] = full // 2
    picture[:, 10:, 2] = full
    seen = read_photo(cv2.imencode(suffix, picture)[1].tobytes()).astype(int)
    assert [seen[row, 0].tolist() for row in (0, 35)] == [[0, 0, 0], [255, 255, 255]]
    assert seen[25, 0] == pytest.approx(128, abs=1)
    assert seen[25, 20].tolist() == pytest.approx([128, 128, 255], abs=1)


def part_way(data: bytes, harm) -> bytes:
    """Return the data with `harm` applied to everything after the middle."""
    return data[: len(data) // 2] + harm(data[len(data) // 2 :])


DAMAGE = {
    "cut": lambda rest: b"",
    "the last bytes lost": lambda rest: rest[:-20],
    "a hole": lambda rest: rest[500:],
    "zeros": lambda rest: bytes(500) + rest[500:],
    "noise": lambda rest: np.random.default_rng(3).bytes(500) + rest[500:],
}


FILES = [
    (".jpg", []),
    (".jpg", [cv2.IMWRITE_JPEG_PROGRESSIVE, 1]),
    (".jpg", [cv2.IMWRITE_JPEG_RST_INTERVAL, 8]),
    (".png", []),
    (".tif", [cv2.IMWRITE_TIFF_COMPRESSION, cv2.IMWRITE_TIFF_COMPRESSION_LZW]),
    (".tif", [cv2.IMWRITE_TIFF_COMPRESSION, cv2.IMWRITE_TIFF_COMPRESSION_ADOBE_DEFLATE]),
]


@pytest.mark.parametrize(
    ("suffix", "options", "harm"),
    [(*file, harm) for file in FILES for harm in DAMAGE] + [(".webp", [cv2.IMWRITE_WEBP_QUALITY, 90], "cut")],
)
def test_a_picture_damaged_in_the_middle_is_refused_with_one_message(capfd, suffix, options, harm):
    pixels = cv2.GaussianBlur(np.random.default_rng(2).integers(0, 256, (300, 400, 3), np.uint8), None, 2)
    data = cv2.imencode(suffix, pixels, options)[1].tobytes()
    assert read_photo(data).shape == pixels.shape
    with refused("photo-damaged"):
        read_photo(part_way(data, DAMAGE[harm]))
    print("heard again", file=sys.stderr)
    assert capfd.readouterr() == ("", "heard again\n")


def test_padding_bytes_before_the_end_are_not_damage(capfd):
    whole = cv2.imencode(".jpg", np.full((90, 90, 3), 200, np.uint8))[1].tobytes()
    assert whole[-2:] == b"\xff\xd9"
    assert np.array_equal(read_photo(whole[:-2] + b"\0\1\2" + whole[-2:]), read_photo(whole))
    assert capfd.readouterr() == ("", "")


def test_a_picture_is_read_without_standard_error(tmp_path):
    path = tmp_path / "p.jpg"
    path.write_bytes(cv2.imencode(".jpg", np.full((90, 80, 3), 200, np.uint8))[1])
    code = (
        "import os, sys; os.close(2)\n"
        "from brushsvg.photo.photo import read_photo\n"
        "data = open(sys.argv[1], 'rb').read(); print(read_photo(data).shape)\n"
        "try: os.fstat(2)\nexcept OSError: print('closed still')"
    )
    done = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, check=True)
    assert done.stdout == "(90, 80, 3)\nclosed still\n"


def hide(pixels, corners_mm, camera=SMALL, margin=1.5):
    """Cover a marker with a piece of paper."""
    corners = np.array(corners_mm)
    middle = corners.mean(axis=0)
    around = photograph.corners_seen(camera, A5, middle + (corners - middle) * margin)
    (left, top), (right, bottom) = around.min(axis=0).astype(int), around.max(axis=0).astype(int)
    pixels[max(top, 0) : bottom, max(left, 0) : right] = 200


def twice(pixels):
    """Copy the first marker to the middle of the sheet."""
    around = photograph.corners_seen(SMALL, A5, np.array(a5().markers[0].corners_mm))
    (left, top), (right, bottom) = around.min(axis=0).astype(int) - 8, around.max(axis=0).astype(int) + 8
    pixels[600 : 600 + bottom - top, 300 : 300 + right - left] = pixels[top:bottom, left:right]
    return pixels


def only(count):
    def covered(pixels):
        for marker in a5().markers[count:]:
            hide(pixels, marker.corners_mm)
        return pixels

    return covered


@pytest.mark.parametrize(
    ("spoil", "expected", "numbers"),
    [
        (lambda p: np.full_like(p, 120), "photo-markers-missing", "chart [0-9a-f]{8} "),
        (only(2), "photo-markers-missing 2 6 3", r"\(\d+, \d+\)"),
        (twice, "photo-marker-twice", "marker [0-9]+ "),
        (lambda p: np.ascontiguousarray(p[:, ::-1]), "photo-mirrored", ""),
        (
            lambda p: cv2.resize(p, None, fx=0.6, fy=0.6, interpolation=cv2.INTER_AREA),
            "photo-too-coarse 4",
            " 3.[0-9] pixels",
        ),
        (
            lambda p: np.uint8(photograph._blurred(np.float32(p), 2.4)),
            "photo-blurred 0.3",
            " 0.[45][0-9] mm",
        ),
    ],
    ids=["no marker", "two markers", "doubled", "mirrored", "small", "blurred"],
)
def test_unusable_pictures_are_refused(spoil, expected, numbers):
    with refused(expected) as caught:
        read(spoil(small().copy()))
    assert re.search(numbers, caught.value.sentence), caught.value


def test_another_chart_is_refused():
    other = chart(find_brush("round-6"), A5, "few", deepest_mm=9.0)
    with refused(f"photo-of-another-chart {other.id}"):
        read_chart_photos(other, [("", photograph.encoded(small()))])


def test_paper_that_is_not_flat_is_refused():
    bulging = replace(SMALL, sag_mm=5.0, size_px=(1200, 1640))
    with refused("photo-not-flat") as caught:
        read(photograph.exposed(sheet(), bulging))
    assert re.search(r" 0\.\d+ mm \(rms\)", caught.value.sentence)


def test_a_chart_of_an_earlier_version_with_four_markers_is_read():
    content = json.loads(write_chart(a5()))
    content = {key: value for key, value in content.items() if key not in ("id", "bar", "labels")}
    content["markers"] = [row | {"id": k} for k, row in enumerate(content["markers"][:4])]
    before = read_chart(json.dumps(content | {"dictionary": "DICT_4X4_50"}).encode())
    shown = photograph.page(before)
    for rings in painted_marks().values():
        shown.paint(rings, BLUE)
    found = read_chart_photos(before, [("", photograph.photograph(shown, SMALL))])
    assert found.view.seen == (0, 1, 2, 3) and not found.marks.missing
    for stroke, rings in painted_marks().items():
        assert off_mm(found.marks.outlines_mm[stroke], rings)[1] < 0.12, stroke


def test_a_page_without_paint_is_refused():
    with refused("photo-without-paint"):
        read(photograph.exposed(page(), SMALL))


# Several photographs --------------------------------------------------------------------------------


def test_photographs_of_one_sheet_are_averaged_and_must_agree():
    noisy = replace(SMALL, noise=0.06, quality=80)
    other = replace(noisy, tilt_deg=(-5.0, 4.0), turn_deg=-3.0, size_px=(1050, 1350))
    jpegs = [photograph.photograph(sheet(), camera, seed) for seed, camera in enumerate((noisy, other, noisy))]
    photos = [(f"{k}.jpg", data) for k, data in enumerate(jpegs)]
    marks = painted_marks()

    def rms(found):
        assert not found.marks.missing
        return np.mean([off_mm(found.marks.outlines_mm[name], rings)[1] for name, rings in marks.items()])

    alone = [rms(read_chart_photos(a5(), [photo])) for photo in photos]
    together = read_chart_photos(a5(), photos)
    assert together.photos == 3 and rms(together) < min(alone), (rms(together), alone)
    rng = np.random.default_rng(1)
    moved = [
        [ring + side for ring in rings] for rings, side in zip(marks.values(), rng.normal(0, 0.4, (24, 2)), strict=True)
    ]
    second = photograph.photograph(painted_sheet(moved), SMALL)
    with refused("photos-differ") as refusal:
        read_chart_photos(a5(), [photos[0], ("second.jpg", second)])
    assert refusal.value.file in ("0.jpg", "second.jpg")
    assert re.search(r" 0\.[2-9]\d mm \(rms\)", refusal.value.sentence)
    with refused("photo-markers-missing") as refusal:
        read_chart_photos(a5(), [photos[0], ("grey.jpg", photograph.encoded(np.full_like(small(), 120)))])
    assert refusal.value.file == "grey.jpg"
    with refused("photo-twice 0.jpg") as refusal:
        read_chart_photos(a5(), [*photos, ("again.jpg", jpegs[0])])
    assert refusal.value.file == "again.jpg"


# The bar --------------------------------------------------------------------------------------------


def printed_at(size, about):
    """Return the chart's page, printed at another scale about a point.

    The robot still paints in true mm.
    """

    def scaled(points):
        return tuple(map(tuple, (np.array(points) - about) * size + about))

    made = a5()
    markers = tuple(replace(marker, corners_mm=scaled(marker.corners_mm)) for marker in made.markers)
    return replace(made, markers=markers, labels=(), bar=None)


def photo_of(printed, marks=None):
    shown = photograph.page(printed)
    for rings in (marks or painted_marks()).values():
        shown.paint(rings, BLUE)
    return photograph.exposed(shown, SMALL)


def test_a_page_printed_at_another_size_is_read_by_its_bar():
    """A page printed at 97 % is read by its bar.

    It is scaled about the middle of the sheet. The robot still paints in true mm.
    """
    made, size = a5(), 0.97
    printed = printed_at(size, np.array(A5) / 2)
    pixels = photo_of(printed)
    found = read(pixels, bar_mm=size * made.bar.length_mm)
    for stroke, rings in painted_marks().items():
        mean, rms = off_mm(found.marks.outlines_mm[stroke], rings)
        assert abs(mean) < 0.04 and rms < 0.1, (stroke, mean, rms)
    wrong = read(pixels)
    assert off_mm(wrong.marks.outlines_mm["straight-4"], painted_marks()["straight-4"])[1] > 0.5
    with refused("page-scale 55 110 '[99, 121] mm'"):
        read(pixels, bar_mm=55.0)
    with refused("bar-missing"):
        read_chart_photos(printed, [("", b"")], bar_mm=100.0)


@pytest.mark.parametrize("size", [0.97, 1.03])
def test_a_page_printed_about_its_corner_names_its_scale_and_is_read_by_its_bar(size):
    """A page printed about its corner is refused with its scale, and read by its bar.

    The upper end of the page is then 6 mm from its expected place.
    """
    pixels = photo_of(printed_at(size, np.zeros(2)))
    bar_mm = a5().bar.length_mm
    with refused(f"page-scale --bar {bar_mm:g}") as caught:
        read(pixels)
    assert caught.value.value == pytest.approx(size, abs=0.01)
    found = read(pixels, bar_mm=size * bar_mm)
    assert not found.marks.missing and not found.marks.joined
    sigma_mm = get_expected_errors(found)["placement_mm"]
    marks = painted_marks()
    moves = [
        np.array(shape(found.marks.outlines_mm[stroke]).centroid.coords[0]) - shape(rings).centroid.coords[0]
        for stroke, rings in marks.items()
    ]
    common = np.mean(moves, axis=0)
    assert np.hypot(*common) < 2 * sigma_mm, "the fit finds the sheet's place"
    read_mm = found.marks.outlines_mm
    off = {name: off_mm([ring - common for ring in read_mm[name]], rings)[1] for name, rings in marks.items()}
    assert sorted(off.values())[-2] < 0.12, "only one reaches over what is printed, and the fit leaves it out"


# Markers that are covered in part -------------------------------------------------------------------

PAIRS = list(itertools.combinations(range(len(a5().markers)), 2))


def painted_over(pixels, numbers, camera=SMALL):
    """Paint over one edge of each of these markers, at a slant."""
    for number in numbers:
        corners = np.array(a5().markers[number].corners_mm)
        a, b = corners[[number % 4, (number + 1) % 4]]
        out = (a + b) / 2 - corners.mean(axis=0)
        out /= np.hypot(*out)
        ring = np.array([a - 0.8 * out, a + 0.7 * (b - a), a + 0.7 * (b - a) + 4 * out, a + 4 * out])
        at = photograph.corners_seen(camera, A5, ring)
        cv2.fillPoly(pixels, [np.round(16 * at).astype(np.int32)], (170, 170, 170), cv2.LINE_AA, 4)
    return pixels


def view_of(pixels):
    corners = {marker.id: np.array(marker.corners_mm) for marker in a5().markers}
    return find_view(pixels, Printed(A5, corners, a5().dictionary))


@sample("pair", PAIRS, keep=4)
def test_markers_partly_covered_by_paint_are_left_out(pair):
    """Markers that paint covers in part are left out.

    Two covered markers once had the page refused as not flat.
    """
    view = view_of(painted_over(small().copy(), pair))
    covered = {a5().markers[number].id for number in pair}
    assert not covered & set(view.seen) and len(view.seen) == len(a5().markers) - 2
    at = np.array([(x, y) for x in np.linspace(15, 133, 8) for y in np.linspace(15, 195, 10)])
    off = np.hypot(*(view.to_px(at) - photograph.corners_seen(SMALL, A5, at)).T) / view.px_per_mm
    assert np.sqrt(np.mean(off**2)) < 0.15


@cache
def bulging():
    camera = replace(SMALL, sag_mm=3.0)
    return camera, photograph.exposed(page(), camera)


@sample("pair", PAIRS, keep=3)
def test_bulging_paper_is_not_flat_without_any_subset_of_markers(pair):
    camera, pixels = bulging()
    with refused("photo-not-flat"):
        view_of(painted_over(pixels.copy(), pair, camera))


# The commands ---------------------------------------------------------------------------------------


def test_wrong_usage_is_refused(tmp_path, capsys):
    out = str(tmp_path / "out.json")
    for words, flag in (
        (["calibrate", "--force", "a.jpg", "-o", out], "--chart"),
        (["calibrate", "a.json", "--chart", "c.json", "-o", out], "--chart"),
        (["calibrate", "a.json", "--bar", "150", "-o", out], "--bar"),
        (["calibrate", "a.json", "b.json", "-o", out], "brushsvg calibrate --help"),
        (["calibrate", "a.jpg", "b.json", "--chart", "c.json", "-o", out], "b.json"),
        (
            ["calibrate", "a.heic", "--scan", "--chart", "c.json", "-o", out],
            "JPEG",
        ),
        (["calibrate", "a.jpg", "--scan", "-o", out], "--chart"),
        (["calibrate", "a.jpg", "--scan", "--chart", "c.json", "-o", "a.jpg"], ".json"),
        (["calibrate", "a.jpg", "--scan", "--chart", out, "-o", out], out),
        (
            ["calibrate", "a.jpg", "--scan", "--chart", "c.json", "-o", out, "--marks-picture", "p.svg"],
            ".png",
        ),
    ):
        assert main(words) == 2
        assert flag in capsys.readouterr().err, words


def test_refusals_name_the_photograph(tmp_path, capsys):
    photo, file, out = tmp_path / "photo.png", tmp_path / "chart.json", tmp_path / "own.json"
    photo.write_bytes(cv2.imencode(".png", np.full((300, 300, 3), 200, np.uint8))[1].tobytes())
    file.write_text("{")
    words = ["calibrate", "--force", str(photo), "--chart", str(file), "-o", str(out)]
    status, _, ((about, reported),) = in_json(capsys, *words)
    assert (status, about) == (1, str(file)) and agrees(reported, "not-json"), reported
    file.write_text(write_chart(a5()))
    status, _, ((about, reported),) = in_json(capsys, *words)
    assert (status, about) == (1, str(photo)) and agrees(reported, f"photo-markers-missing {a5().id}"), reported
    assert not out.exists()
