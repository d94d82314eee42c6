"""A flatbed scan of strokes on plain paper is read by the strokes themselves.

The sheet may be anywhere on the glass. An unreadable scan is refused with a sentence that says what to do.
"""

import re
from functools import cache, lru_cache

import cv2
import numpy as np
import painter
import photograph
import pytest
import shapely
from diagnostics import gives
from photograph import BLUE
from sampling import sample

from brushsvg import _core, find_brush
from brushsvg.calibration.chart.file import write_chart
from brushsvg.calibration.chart.layout import chart
from brushsvg.calibration.chart.photograph import describe_reading, read_chart_photos, report_reading_notices
from brushsvg.cli import main
from brushsvg.errors import Error
from brushsvg.photo.place_by_strokes import _match_turn_and_shift

pytestmark = pytest.mark.long

A5 = (148.0, 210.0)
TRUTH = painter.TrueBrush(
    10.0, np.array([2.6, 1.3, 0.1, -0.009]), np.array([0.0, 0.45]), np.array([0.0, 0.5, -0.005]), 1.6, 0.9
)
FAULTS = painter.Faults(noise=0.05, noise_length=0.5, displacement=0.2, placement=0.8, turn=0.008, height=0.1)
DEPTHS = np.linspace(1, 10, 10)
GLASS = (232.0, 240.0)  # mm


@cache
def a5():
    return chart(find_brush("round-6"), A5, "few")


@cache
def marks():
    strokes = [(one.stroke, np.array(one.poses_mm)) for one in a5().plan.passes]
    painted = painter.paint(np.random.default_rng(7), TRUTH, strokes, FAULTS)
    return {stroke: rings for stroke, _, rings in painted.marks}


@cache
def sheet(paper=0.85, colour=tuple(BLUE)):
    made = photograph.Sheet(A5)
    made.shown *= paper / 0.85
    for rings in marks().values():
        made.paint(rings, colour)
    return made


def placed(points_mm, turn_deg):
    """Return places of the sheet on the glass, both y up.

    The sheet's middle is near the middle of the glass.
    """
    turn = np.radians(turn_deg)
    to = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    return (np.asarray(points_mm) - np.array(A5) / 2) @ to + np.array(GLASS) / 2 + [2.0, -3.0]


@lru_cache(maxsize=1)  # one result needs hundreds of megabytes
def blurred(dpi, **how):
    """Return the sheet as the scanner's lens shows it, for any pose."""
    made = sheet(**how)
    return cv2.GaussianBlur(made.shown, None, 0.4 * photograph.TEXELS * 25.4 / dpi)


@lru_cache(maxsize=1)
def grain(shape):
    return np.random.default_rng(3).standard_normal(size=shape, dtype=np.float32) * np.float32(0.006)


@lru_cache(maxsize=1)  # all refusals use one scan; more scans would need hundreds of megabytes
def scanned(dpi=300, turn_deg=0.0, **how):
    """Return the pixels of a scan, red first.

    Each pixel is the mean light over its area with some noise. A grey lid is next to the sheet.
    """
    made, fine = blurred(dpi, **how), dpi / 25.4
    texels = np.array([(0, 0), (made.shape[1], 0), (0, made.shape[0])], float)
    corners = placed([(0, A5[1]), A5, (0, 0)], turn_deg)
    pixels = np.column_stack([corners[:, 0], GLASS[1] - corners[:, 1]]) * fine
    to = cv2.getAffineTransform(np.float32(texels - 0.5), np.float32(pixels - 0.5))
    size = tuple(round(side * fine) for side in GLASS)
    light = cv2.warpAffine(made, to, size, borderValue=(0.8, 0.8, 0.8))
    light += grain(light.shape)
    pixels = photograph.coded(light)
    pixels.flags.writeable = False
    return pixels


def read(pixels, dpi=300, made=None):
    return read_chart_photos(made or a5(), [("scan.jpg", photograph.encoded(pixels))], dpi=dpi)


def code_of(*how, **more):
    with pytest.raises(Error) as refusal:
        read(*how, **more)
    assert refusal.value.file == "scan.jpg"
    return refusal.value.code, refusal.value.sentence


def shape(rings):
    return shapely.unary_union([shapely.Polygon(ring).buffer(0) for ring in rings])


def similarity_off(found) -> tuple[float, float, float]:
    """Return turn [degrees], scale and shift [mm] from painted to read marks.

    The last value is the rms distance [mm] that remains.
    """
    both = [stroke for stroke in marks() if stroke in found.marks.outlines_mm]
    was, seen = (
        np.array([complex(*shape(rings[stroke]).centroid.coords[0]) for stroke in both])
        for rings in (marks(), found.marks.outlines_mm)
    )
    (a, b), *_ = np.linalg.lstsq(np.column_stack([was, np.ones(len(was))]), seen, rcond=None)
    left = float(np.sqrt(np.mean(np.abs(a * was + b - seen) ** 2)))
    middle = complex(*A5) / 2
    return np.degrees(np.angle(a)), abs(a), abs(a * middle + b - middle), left


@sample(
    ("turn_deg", "dpi"),
    [(0, 300), (90, 300), (180, 300), (2, 300), (268, 150), (-1, 600)],
    keep=2,
)
def test_marks_are_found_for_any_pose_of_the_sheet(turn_deg, dpi):
    """Marks are found for any pose of the sheet.

    They are found up to a turn and shift of the whole sheet, which the fit finds on any sheet.
    """
    found = read(scanned(dpi, turn_deg), dpi)
    assert not found.marks.missing and not found.marks.joined and not report_reading_notices(found)
    turn, scale, shift, left = similarity_off(found)
    assert abs(turn) < 0.6 and shift < 0.7, (turn, shift)
    assert abs(scale - 1) < 5e-4 and left < 0.03, (scale, left)
    degrees, right = re.search(r"turned by (\d+\.\d) degrees( to the right)?", describe_reading(found)).groups()
    shown = float(degrees) * (-1 if right else 1)
    assert abs((shown - turn_deg + 180) % 360 - 180) < 0.6 and "24 strokes" in describe_reading(found)


@pytest.mark.parametrize("margin_mm", [0, 10, 20])
def test_light_paint_on_dark_paper_is_read_with_any_share_of_bare_paper(margin_mm):
    """Light paint on dark paper is read, however much paper is bare.

    With 10 mm of bare paper around, the dark paper between marks was once read as paint.
    """
    fine = 300 / 25.4
    light = blurred(300, paper=0.06, colour=(0.5, 0.5, 0.5))
    light = cv2.resize(light, None, fx=fine / photograph.TEXELS, fy=fine / photograph.TEXELS)
    margin = [round(margin_mm * fine)] * 4
    light = cv2.copyMakeBorder(light, *margin, cv2.BORDER_CONSTANT, value=(0.06, 0.06, 0.06))
    light += np.float32(0.02) * grain(light.shape)
    found = read(photograph.coded(light))
    assert not found.marks.missing and not found.marks.joined
    _, scale, _, left = similarity_off(found)
    assert abs(scale - 1) < 5e-4 and left < 0.03, (scale, left)


@pytest.mark.parametrize("at_mm", [(12, 10), (150, 10), (12, 150), (150, 140)])
def test_a_small_sheet_is_found_anywhere_on_a_large_glass(at_mm):
    """A small sheet is found anywhere on a large glass.

    The match is periodic. A shift of more than half of its period is not a shift back.
    """
    ways = [np.array(points, float) for points in ([(0, 0), (38, 0), (38, 30)], [(5, 22), (20, 22)])]
    paint = np.zeros((600, 600), np.uint8)
    for way in ways:
        line = np.round(3 * (way * [1, -1] + at_mm + [0, 30])).astype(np.int32)
        cv2.polylines(paint, [line[:, None]], False, 1, 9)
    turn, shift = _match_turn_and_shift(paint > 0, ways)
    assert abs(turn) < 1e-9 and abs(shift - complex(at_mm[0], at_mm[1] + 30)) < 1.5, (turn, shift)


def test_light_paint_on_dark_paper_is_read():
    found = read(scanned(turn_deg=91, paper=0.04, colour=(0.8, 0.8, 0.75)))
    assert not found.marks.missing and not found.marks.joined
    assert similarity_off(found)[3] < 0.03
    areas = [shape(found.marks.outlines_mm[each]).area / shape(marks()[each]).area for each in marks()]
    assert np.ptp(areas) < 0.08 and abs(np.mean(areas) - 1) < 0.02, areas


def test_paper_that_is_nearly_black_is_refused():
    """Paper that is nearly black is refused; its marks were once 0.4 mm off."""
    code, sentence = code_of(scanned(paper=0.03, colour=(0.8, 0.8, 0.75)))
    assert code == "photo-too-dark" and "3.5" in sentence


@pytest.mark.parametrize("paper", [0.85, 1.05])
def test_a_missing_scan_resolution_is_reported(paper):
    """A user who forgets the resolution of a scan is reminded.

    White paper on the glass has the largest values, which was once reported as overexposed.
    """
    with pytest.raises(Error) as refusal:
        read(scanned(paper=paper), dpi=None)
    assert refusal.value.code == ("photo-markers-missing" if paper < 1 else "photo-overexposed")
    assert "--dpi" in refusal.value.advice


@pytest.mark.parametrize(("turn_deg", "side"), [(2, "left"), (-3, "right"), (180, ""), (180.5, "")])
def test_the_rotation_of_a_scan_is_reported_without_a_sign(turn_deg, side):
    sentence = describe_reading(read(scanned(turn_deg=turn_deg)))
    degrees = re.search(r"turned by (\S+) degrees( to the )?(\w*)", sentence)
    assert float(degrees[1]) == pytest.approx(abs(turn_deg), abs=1.5) and degrees[3] == side, sentence


def test_a_mirrored_scan_is_refused():
    assert code_of(np.ascontiguousarray(scanned()[:, ::-1]))[0] == "photo-mirrored"


@pytest.mark.parametrize("dpi", [200, 290, 600])
def test_another_resolution_is_refused(dpi):
    code, sentence = code_of(scanned(300), dpi=dpi)
    assert code == "scan-resolution" and "300" in sentence


def test_a_scan_that_is_too_coarse_is_refused():
    assert code_of(scanned(300), dpi=75)[0] == "photo-too-coarse"


def test_a_picture_of_no_sheet_is_refused():
    assert code_of(np.full((1, 1, 3), 255, np.uint8))[0] == "scan-resolution"


def test_another_chart_is_refused():
    other = chart(find_brush("round-6"), A5, "few", deepest_mm=6.0)
    assert code_of(scanned(), made=other)[0] in ("photo-paint-elsewhere", "scan-resolution")


def test_the_mirrored_scan_of_another_chart_is_refused_as_another_chart():
    """The mirrored scan of another chart is refused as another chart.

    It was once reported as mirrored, like every second picture.
    """
    other = chart(find_brush("round-6"), A5, "few", deepest_mm=9.0)
    assert code_of(np.ascontiguousarray(scanned()[:, ::-1]), made=other)[0] == "photo-paint-elsewhere"


def test_an_empty_sheet_is_refused():
    plain = np.full((2800, 2700, 3), 235, np.uint8)
    plain[::7, ::5] = 232
    assert code_of(plain)[0] == "photo-without-paint"


def test_half_a_sheet_is_refused():
    pixels = scanned().copy()
    pixels[: pixels.shape[0] // 2] = 230
    assert code_of(pixels)[0] in ("photo-paint-elsewhere", "scan-resolution")


def test_a_printed_page_is_read_without_resolution():
    camera = photograph.Camera(size_px=(1200, 1700))
    page = photograph.page(a5())
    for rings in marks().values():
        page.paint(rings, BLUE)
    code, sentence = code_of(photograph.exposed(page, camera))
    assert code == "scan-with-markers" and "--dpi" in sentence


@pytest.mark.skipif(not hasattr(_core, "fit_marks"), reason="built without Ceres")
def test_a_scan_recovers_the_brush(tmp_path, capsys):
    (tmp_path / "scan.png").write_bytes(cv2.imencode(".png", scanned(300, 92)[..., ::-1])[1].tobytes())
    (tmp_path / "chart.json").write_text(write_chart(a5()))
    photo, made, out = (str(tmp_path / name) for name in ("scan.png", "chart.json", "own.json"))
    assert main(["calibrate", "--force", photo, "--chart", made, "--dpi", "300", "-o", out]) == 0
    found = find_brush(out)
    for law in ("lag", "half_width"):
        off = [abs(getattr(found, law)(depth) / TRUTH.law(law)(depth) - 1) for depth in DEPTHS]
        assert max(off) < 0.03, (law, off)
    assert gives(capsys.readouterr().err, "24")
    marks_file, again = str(tmp_path / "marks.json"), str(tmp_path / "again.json")
    assert main(["calibrate", photo, "--scan", "--chart", made, "--dpi", "300", "-o", marks_file]) == 0
    assert main(["calibrate", "--force", marks_file, "-o", again]) == 0
    off = [abs(find_brush(again).lag(depth) / TRUTH.law("lag")(depth) - 1) for depth in DEPTHS]
    assert max(off) < 0.03, off
