"""The page of `preview -o FILE.html` paints the predicted marks in Chromium."""

import json
import re
import subprocess

import cv2
import numpy as np
import pytest
from command import OPEN, SOUND, brush_file, brushsvg

import brushsvg as package
from brushsvg import _core
from brushsvg.jobs import outputs, prediction
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation import preparation
from brushsvg.machine.cells.cell_file import SHIPPED, find_cell
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.machine.writer import whole_program
from brushsvg.show.timeline import timeline

SIZE = (1300, 860)
COLOUR = "1b1b3a"  # colour of all strokes of the demo's drawing


class Browser:
    """Chromium without a window and network, in a separate profile.

    Only messages of the page are kept.
    """

    def __init__(self, folder):
        self.folder = folder

    def shown(self, page, moment: str, size=SIZE) -> tuple[np.ndarray, list[str]]:
        """Return the picture (h, w, 3) at a moment, and the page's console messages.

        The moment is the text after # in the address.
        """
        picture = self.folder / "shown.png"
        picture.unlink(missing_ok=True)
        messages = self._run(page, moment, f"--screenshot={picture}", "--window-size={},{}".format(*size)).stderr
        image = cv2.imread(str(picture))
        assert image is not None, messages
        return image, re.findall(r"CONSOLE.*", messages)

    def text(self, page, moment: str) -> str:
        """Return the document after its script has run."""
        return self._run(page, moment, "--dump-dom").stdout

    def _run(self, page, moment: str, *words):
        return subprocess.run(
            [
                *("chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"),
                *("--force-device-scale-factor=1", "--virtual-time-budget=2000", "--enable-logging=stderr"),
                *("--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={self.folder / 'profile'}"),
                *(*words, f"{page.as_uri()}#{moment}"),
            ],
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=120,
            check=True,
        )


def loads_of(work):
    return split_into_loads(work.plan, work.brush, find_cell())


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    return Browser(tmp_path_factory.mktemp("browser"))


@pytest.fixture(scope="module")
def page(tmp_path_factory, drawing):
    folder = tmp_path_factory.mktemp("animation")
    brushsvg("preview", drawing("vincent"), "-o", "page.html", cwd=folder, status=0)
    return folder / "page.html"


@pytest.fixture(scope="module")
def played(drawing):
    """Return work, marks and timeline of the demo's drawing."""
    work = preparation.prepare(drawing("vincent"))
    marks = prediction.predict(work, outlines=False)
    return (
        work,
        marks,
        timeline(whole_program(loads_of(work), work.brush, find_cell()), marks),
    )


def painted(image: np.ndarray) -> np.ndarray:
    """Return the share (h, w) of the strokes' colour in the pixels of the sheet.

    The sheet is the largest white area.
    """
    white = (image == 255).all(axis=2)
    rows, columns = (np.flatnonzero(white.mean(axis=1 - axis) > 0.3) for axis in (0, 1))
    sheet = image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1].astype(float)
    colour = np.array([int(COLOUR[k : k + 2], 16) for k in (4, 2, 0)])
    # The share by which a mixture of white and the colour fits best.
    return np.clip((255 - sheet) @ (255 - colour) / ((255 - colour) ** 2).sum(), 0, 1)


def overlap(image: np.ndarray, marks, work) -> float:
    seen = painted(image)
    width, height = work.plan.sheet_mm
    px_per_mm = seen.shape[1] / width
    assert seen.shape[0] == pytest.approx(height * px_per_mm, abs=1.5)
    target = package.coverage(marks, work.brush, (0.0, 0.0, width, height), px_per_mm)
    h, w = (min(a, b) for a, b in zip(seen.shape, target.shape, strict=True))
    seen, target = seen[:h, :w], target[:h, :w]
    return float(np.minimum(seen, target).sum() / np.maximum(seen, target).sum())


def until(marks, number: int, pose: float):
    """Return the paint up to the time when the tool reaches a pose of a pass."""
    cut = json.loads(_core.write_marks(marks))
    cut["passes"] = cut["passes"][: number + 1]
    last = cut["passes"][number]
    rows = sum(at <= pose for at in last["pose"])
    last |= {name: values[:rows] for name, values in last.items() if name not in ("stroke", "outline_mm")}
    return _core.read_marks(json.dumps(cut))


def test_the_first_frame_has_no_paint(page, browser):
    image, messages = browser.shown(page, "t=0&bare")
    assert messages == []
    assert painted(image).max() < 0.02


def test_the_last_frame_equals_the_prediction(page, browser, played):
    work, marks, rows = played
    image, messages = browser.shown(page, f"t={rows.time_s[-1]:.3f}&bare")
    assert messages == []
    assert overlap(image, marks, work) > 0.98


@pytest.mark.parametrize("number, share", [(0, 0.5), (3, 0.9), (6, 0.7)])
def test_a_middle_frame_shows_the_paint_so_far(page, browser, played, number, share):
    work, marks, rows = played
    poses_mm = work.plan.passes[number].poses_mm
    pose = int(share * len(poses_mm))
    chapter = next(chapter for chapter in rows.chapters if chapter.trace == number)
    after = [each.first_row for each in rows.chapters if each.first_row > chapter.first_row]
    part = slice(chapter.first_row, min(after, default=len(rows.time_s)))
    near = np.linalg.norm(rows.tcp_mm[part] - poses_mm[pose], axis=1)
    moment = rows.time_s[
        chapter.first_row + int(np.flatnonzero(near < 1e-6)[-1])
    ]  # a moment that occurs twice counts the second time
    image, messages = browser.shown(page, f"t={moment:.3f}&bare")
    assert messages == []
    assert overlap(image, until(marks, number, pose), work) > 0.98


@pytest.mark.parametrize("notch", [0.0, 0.4], ids=["convex", "notched"])
def test_the_footprint_is_swept_between_distant_rows(tmp_path, browser, notch):
    """Between rows that are far apart, the page sweeps the footprint.

    A straight line has few rows. The region that a notched footprint sweeps is not a hull.
    """
    brush = brush_file("round-6")
    for footprint in brush["footprints"]["dragged"]:
        outline = np.array(footprint["outline_mm"])
        front = np.clip(1 - np.abs(outline[:, 1]) / outline[:, 1].max(), 0, 1) * (outline[:, 0] > 0)
        outline[:, 0] -= notch * outline[:, 1].max() * front
        footprint["outline_mm"] = outline.tolist()
    (tmp_path / "brush.json").write_text(json.dumps(brush))
    (tmp_path / "a.svg").write_text(f'{OPEN}<path id="p" d="M15 30H105" stroke="#{COLOUR}" stroke-width="6"/></svg>')
    work = preparation.prepare(
        tmp_path / "a.svg",
        Options(brush=package.find_brush(tmp_path / "brush.json"), start="pointed", end="round"),
    )
    marks = prediction.predict(work)
    step_mm = np.linalg.norm(np.diff(marks.passes[0].contact_mm, axis=0), axis=1)
    row = int(step_mm.argmax()) + 1
    assert step_mm.max() > 30
    rows = timeline(whole_program(loads_of(work), work.brush, find_cell()), marks)
    moment = rows.time_s[np.flatnonzero(~np.isnan(rows.depth_mm))[row]]
    (tmp_path / "a.html").write_bytes(outputs.make_animation(work, loads_of(work), marks, find_cell()))
    image, messages = browser.shown(tmp_path / "a.html", f"t={moment:.3f}&bare")
    assert messages == []
    assert overlap(image, until(marks, 0, marks.passes[0].pose[row]), work) > 0.98
    half, _ = browser.shown(tmp_path / "a.html", f"t={(moment + rows.time_s[0]) / 2:.3f}&bare")
    assert 0.2 < painted(half).sum() / painted(image).sum() < 0.8


def test_target_mark_and_path_are_shown_on_a_narrow_screen(page, browser):
    with_all, messages = browser.shown(page, "t=31.3", (500, 800))
    bare, _ = browser.shown(page, "t=31.3&bare", (500, 800))
    assert messages == []
    assert with_all.shape == bare.shape
    blue, grey = np.array([0xD9, 0x8F, 0x3F]), np.array([0xDB, 0xE2, 0xE4])
    for colour, tolerance, least in ((blue, 60, 50), (grey, 2, 500)):
        counts = [(np.abs(each.astype(int) - colour).max(axis=2) < tolerance).sum() for each in (with_all, bare)]
        assert counts[0] > counts[1] + least


def test_the_text_shows_the_stroke_and_the_time(page, browser):
    text = browser.text(page, "t=31.3")
    assert '<h1 id="title">Vincent</h1>' in text
    assert re.search(r'<b id="what">stroke \d+ of 13: ', text)
    assert '<output id="clock">0:31.3 / 1:' in text


# A browser without a window and with virtual time shows only one frame.
FRAMES = "<script>requestAnimationFrame = (f) => setTimeout(() => f(performance.now()), 16);</script>"
KEYS = """<script>
const reported = [];
const text = (id) => document.getElementById(id).textContent;
const press = (key) => {
  const event = new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true });
  document.getElementById("slider").dispatchEvent(event);
  reported.push(text("clock").split(" ")[0] + " " + text("what"));
};
["ArrowRight", "ArrowRight", "ArrowLeft", "ArrowDown", "ArrowUp", "End", "Home", " "].forEach(press);
setTimeout(() => { press(" "); document.body.append("reported " + JSON.stringify(reported)); }, 1500);
</script></body>"""


def test_keys_control_position_and_playback(page, browser, played):
    _, _, rows = played
    keyed = page.with_name("keyed.html")
    keyed.write_text(page.read_text().replace("<head>", f"<head>{FRAMES}").replace("</body>", KEYS))
    reported = json.loads(re.search(r"reported (\[.*\])", browser.text(keyed, ""))[1])
    first, second, last = (f"stroke {number} of 13" for number in (1, 2, 13))
    second_s = rows.time_s[rows.chapters[1].first_row]
    clocks, words = zip(*(each.split(" ", 1) for each in reported), strict=True)
    assert clocks[:3] == ("0:01.0", "0:02.0", "0:01.0")
    assert float(clocks[3][2:]) == pytest.approx(second_s, abs=0.1)
    assert clocks[5] == f"1:{np.floor((rows.time_s[-1] - 60) * 10) / 10:04.1f}"
    assert clocks[4] == clocks[6] == clocks[7] == "0:00.0"
    assert 0.5 < float(clocks[8][2:]) < 2  # the animation has played in the meantime
    assert [word.split(":")[0] for word in words] == [first] * 3 + [second, first, last] + [first] * 3


def test_a_hostile_title_is_shown_as_text(tmp_path, browser):
    title = "</script><script>document.body.id='taken'</script>"
    escaped = title.replace("<", "&lt;")
    (tmp_path / "a.svg").write_text(SOUND.replace("A line", escaped))
    brushsvg("preview", "a.svg", "-o", "a.html", cwd=tmp_path, status=0)
    text = browser.text(tmp_path / "a.html", "t=1")
    assert 'id="taken"' not in text
    assert f'<h1 id="title">{escaped.replace(">", "&gt;")}</h1>' in text
    assert json.dumps(title).replace("<", "\\u003c") in (tmp_path / "a.html").read_text()


def test_a_job_of_hours_has_a_clock_with_hours(tmp_path, browser):
    cell = (SHIPPED / "linuxcnc-3axis.toml").read_text()
    slow = re.sub(r"(?m)^(travel|approach|press|paint)_mm_s = \S+", r"\1_mm_s = 0.01", cell)
    (tmp_path / "slow.toml").write_text(slow)
    (tmp_path / "a.svg").write_text(SOUND)
    brushsvg("preview", "a.svg", "-o", "a.html", "--cell", "slow.toml", cwd=tmp_path, status=0)
    text = browser.text(tmp_path / "a.html", "t=754.2")
    assert re.search(r'<output id="clock">0:12:34\.2 / [1-9]:[0-5]\d:[0-5]\d\.\d<', text)


def test_names_of_stations_fit_a_narrow_page(tmp_path, browser):
    """Names of stations are visible on a narrow page.

    They were once cut at its edge, and hidden by the next vessel.
    """
    cell = (SHIPPED / "linuxcnc-3axis.toml").read_text()
    station = '[[stations]]\nname = "{}"\nplace_mm = [-15, {}]\nby_hand = true\n'
    pictures = []
    for name in ("W" * 12, ""):
        stations = station.format(name or " ", 30)
        (tmp_path / "pots.toml").write_text(f'{cell}\n[reload]\nwhen = "stroke"\n{stations}')
        (tmp_path / "a.svg").write_text(SOUND)
        brushsvg("preview", "a.svg", "-o", "a.html", "--cell", "pots.toml", cwd=tmp_path, status=0)
        pictures.append(browser.shown(tmp_path / "a.html", "t=0", (500, 800))[0].astype(int))
    columns = np.flatnonzero((np.abs(pictures[0] - pictures[1])[200:500] > 20).any(axis=(0, 2)))
    assert 140 < np.ptp(columns) < 180, "all of the letters"
    assert columns.min() >= 11
