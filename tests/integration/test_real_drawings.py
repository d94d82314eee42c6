"""Real drawings are planned, predicted and reported well from end to end.

Inkscape renders the target.
"""

import json
import re
import xml.etree.ElementTree as ET

import cv2
import numpy as np
import pytest
from command import brushsvg
from diagnostics import agrees
from drawings import SVG

DRAWN = {f"{SVG}{tag}" for tag in ("path", "line", "circle", "ellipse", "polyline", "rect")}
SHEETS_MM = {
    "vincent": (240, 120),
    "robot": (160, 60),
    "kanji-eternity": (109 * 25.4 / 96, 109 * 25.4 / 96),
    "kanji-write": (163.5, 163.5),
    "inkscape": (150, 100),
    "inkscape-plain": (150, 100),
}
# The smallest overlap with compensation, and the smallest gain over none. The small character is 0.8 mm wide and its
# footprint 3 mm long, so its ends count most. The large character has mostly long straight strokes.
OVERLAP = {"kanji-eternity": (0.93, 0.5), "kanji-write": (0.96, 0.15)}
PIXELS_ACROSS = 2000


def ids_in_order(drawing):
    return [node.get("id") for node in ET.parse(drawing).getroot().iter() if node.tag in DRAWN]


def test_the_plan_contains_every_stroke_in_order(source, drawing, converted):
    plan = json.loads((converted(source) / "plan.json").read_text(encoding="utf-8"))
    assert (plan["format"], plan["version"], plan["brush"]) == ("brushsvg/plan", 1, "round-6")
    assert plan["sheet_mm"] == pytest.approx(SHEETS_MM[source], abs=1e-4)
    assert [each["stroke"] for each in plan["passes"]] == ids_in_order(drawing(source))
    for each in plan["passes"]:
        poses = np.array(each["poses_mm"])
        assert poses.shape[1] == 3
        assert (poses[0, 2], poses[-1, 2]) == (0, 0)
        assert poses[:, 2].min() < -0.5
        assert poses[:, 2].max() <= 0
        assert ((poses[:, :2] > -30) & (poses[:, :2] < np.array(plan["sheet_mm"]) + 30)).all()


def test_strokes_are_painted_in_the_direction_they_were_drawn(source, drawing, converted):
    """Strokes are painted in their drawn direction.

    Without compensation, the tool is set down where the path starts.
    """
    plan = json.loads((converted(source, "--compensation", "none") / "plan.json").read_text(encoding="utf-8"))
    page = ET.parse(drawing(source)).getroot()
    height_mm = plan["sheet_mm"][1]
    scale = plan["sheet_mm"][0] / float(page.get("viewBox").split()[2])
    inside = 1.5 if source == "kanji-write" else 1.0
    starts = {
        node.get("id"): [float(number) for number in found.groups()]
        for node in page.iter(SVG + "path")
        if (found := re.match(r"[Mm]\s*(-?[\d.]+)[\s,]+(-?[\d.]+)", node.get("d")))
    }
    moved = {"wave": (10, 5), "bar": None, "ring": None}  # effect of Inkscape's transforms on the others
    seen = 0
    for each in plan["passes"]:
        shift = moved.get(each["stroke"], (0, 0))
        if each["stroke"] not in starts or shift is None:
            continue
        x, y = (s * inside + d for s, d in zip(starts[each["stroke"]], shift, strict=True))
        assert each["poses_mm"][0][:2] == pytest.approx([x * scale, height_mm - y * scale], abs=2e-4)
        seen += 1
    assert seen == {"robot": 2, "inkscape": 2, "inkscape-plain": 2}.get(source, len(plan["passes"]))


def test_compensation_improves_the_figures(source, reported):
    least, gain = OVERLAP.get(source, (0.96, 0.3))
    closed = reported(source, "--compensation", "closed")
    none = reported(source, "--compensation", "none")
    assert (closed["compensation"], none["compensation"]) == ("closed", "none")
    assert closed["total"]["overlap"] > least
    assert closed["total"]["overlap"] > none["total"]["overlap"] + gain
    assert closed["total"]["centre_largest_mm"] <= closed["tolerance_mm"] == 0.05
    assert closed["total"]["centre_mean_mm"] < 0.1 * none["total"]["centre_mean_mm"]
    assert closed["total"]["width_error_mm"] < 0.05 < none["total"]["width_error_mm"]
    assert closed["total"]["widths_out_of_reach"] == 0
    for with_it, without in zip(closed["strokes"], none["strokes"], strict=True):
        assert with_it["stroke"] == without["stroke"]
        assert with_it["overlap"] > without["overlap"]


def test_the_report_agrees_with_the_plan(source, converted, reported):
    passes = json.loads((converted(source) / "plan.json").read_text(encoding="utf-8"))["passes"]
    found = reported(source, "--compensation", "closed")
    assert [row["stroke"] for row in found["strokes"]] == [each["stroke"] for each in passes]
    for row, each in zip(found["strokes"], passes, strict=True):
        path = np.array(each["poses_mm"])
        length_mm = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
        assert row["poses"] == len(path)
        assert row["painted_mm"] == pytest.approx(length_mm, abs=0.01)
    painting_s = found["total"]["painted_mm"] / 20  # no stroke is faster, and dabs, travel and landing add time
    assert painting_s < found["time_s"] < 3 * painting_s + 5 * len(passes)


def test_warnings_are_only_about_omitted_parts(source, drawing, converted, tmp_path):
    """Warnings are only about parts that are left out.

    These are numbers next to the strokes of a character, and depths at which the brush was not measured.
    """
    words = ("--messages", "json", "convert", drawing(source), "-o", "again.ngc", "--quiet")
    notices = brushsvg(*words, cwd=tmp_path, status=0).reported
    count = 0
    if source == "kanji-eternity":
        (_, texts), (_, depths) = notices  # five notices of one code and five of another, summarized
        assert agrees(texts, "text-unread 'text 1' 4")
        strokes = ids_in_order(drawing(source))
        assert agrees(depths, f"depth-not-measured '{strokes[0]}' {len(strokes) - 1} 0.94")
        count = len(strokes) + 5
    else:
        assert notices == []
    program = (converted(source) / "program.ngc").read_text(encoding="ascii")
    assert f"(warnings: {count})" in program


def test_the_prediction_is_written_in_three_formats(source, drawing, converted, tmp_path):
    for name in ("marks.png", "marks.svg", "marks.json"):
        brushsvg("preview", drawing(source), "-o", name, cwd=tmp_path, status=0)
    passes = json.loads((converted(source) / "plan.json").read_text(encoding="utf-8"))["passes"]
    marks = json.loads((tmp_path / "marks.json").read_text(encoding="utf-8"))
    assert (marks["format"], marks["version"]) == ("brushsvg/marks", 1)
    assert [each["stroke"] for each in marks["passes"]] == [each["stroke"] for each in passes]
    for trace, each in zip(marks["passes"], passes, strict=True):
        assert (trace["pose"][0], trace["pose"][-1]) == (0, len(each["poses_mm"]) - 1)
        rows = {key: len(trace[key]) for key in ("pose", "contact_mm", "heading_rad", "depth_mm", "taut")}
        assert len(set(rows.values())) == 1, rows
        assert trace["outline_mm"]

    root = ET.parse(tmp_path / "marks.svg").getroot()
    assert root.tag == SVG + "svg"
    width_mm, height_mm = SHEETS_MM[source]
    assert float(root.get("width").removesuffix("mm")) == pytest.approx(width_mm, abs=1e-3)
    assert float(root.get("height").removesuffix("mm")) == pytest.approx(height_mm, abs=1e-3)

    picture = cv2.imread(str(tmp_path / "marks.png"))
    assert picture.shape[1] / picture.shape[0] == pytest.approx(width_mm / height_mm, rel=0.01)
    ink = (picture.min(axis=2) < 128).mean()
    painted = area_mm2(marks["outline_mm"]) / (width_mm * height_mm)
    assert ink == pytest.approx(painted, rel=0.05)


@pytest.mark.parametrize("compensation", ["closed", "none"])
def test_the_overlap_agrees_with_inkscapes_rendering(source, compensation, drawing, reported, inkscape, tmp_path):
    """The overlap agrees with Inkscape's rendering of the drawing.

    Inkscape renders the target, and OpenCV fills marks.json. No code of ours is in between.
    """
    width_mm, height_mm = SHEETS_MM[source]
    px_per_mm = PIXELS_ACROSS / width_mm
    target = cv2.imread(str(inkscape.paint(drawing(source), px_per_mm)), cv2.IMREAD_UNCHANGED)[:, :, 3] / 255
    flags = ["--compensation", compensation]
    brushsvg("preview", drawing(source), "-o", "marks.json", *flags, cwd=tmp_path, status=0)
    rings = json.loads((tmp_path / "marks.json").read_text(encoding="utf-8"))["outline_mm"]
    painted = filled(rings, height_mm, px_per_mm, target.shape)
    overlap = np.minimum(painted, target).sum() / np.maximum(painted, target).sum()
    total = reported(source, *flags)["total"]
    assert overlap == pytest.approx(total["overlap"], abs=0.004)


def filled(rings, height_mm, px_per_mm, shape, parts=4):
    """Return the even-odd coverage of rings, parts x parts samples per pixel."""
    fine = np.zeros((shape[0] * parts, shape[1] * parts), np.uint8)
    scale = px_per_mm * parts
    points = [np.round((np.array(ring) * [1, -1] + [0, height_mm]) * scale - 0.5).astype(np.int32) for ring in rings]
    cv2.fillPoly(fine, points, 255)
    return cv2.resize(fine, (shape[1], shape[0]), interpolation=cv2.INTER_AREA) / 255


def area_mm2(rings):
    total = 0.0
    for ring in rings:
        x, y = np.array(ring).T
        total += 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
    return total


def test_layers_and_colours_survive_saving_in_inkscape(converted):
    for source, layers in (
        ("inkscape", ["Letters", "Shapes & more"]),
        ("inkscape-plain", ["layer1", "layer2"]),
    ):  # ids
        plan = json.loads((converted(source) / "plan.json").read_text(encoding="utf-8"))
        found = {each["stroke"]: (each.get("layer", ""), each["colour"]) for each in plan["passes"]}
        assert found == {
            "wave": (layers[0], "#102030"),
            "bar": (layers[0], "#a00000"),
            "spiral": (layers[1], "#0000ff"),
            "ring": (layers[1], "#0000ff"),
            "box": (layers[1], "#0000ff"),
        }


def test_plain_and_inkscape_svg_give_the_same_plan(converted):
    plans = [
        json.loads((converted(name) / "plan.json").read_text(encoding="utf-8"))
        for name in ("inkscape", "inkscape-plain")
    ]
    for with_names, plain in zip(*(plan["passes"] for plan in plans), strict=True):
        assert with_names["poses_mm"] == plain["poses_mm"]
