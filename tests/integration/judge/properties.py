"""Random cases of drawing, brush file, cell and options, and their properties."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import oracle
from desk import BRUSHES, brush_file

import brushsvg
from brushsvg import _core
from brushsvg.cli.arguments.parser import parse
from brushsvg.cli.steps.options import make_choices, make_options
from brushsvg.jobs.preparation import preparation
from brushsvg.model.library import find_brush

from .checked import CRASHED, converted, put
from .random_jobs import REQUESTED, judged, said_of, without
from .random_works import SHEET, follows_ends, random_brush, random_cell, random_flags, random_svg
from .works import CELLS, PENS

EDGE_MM = 0.02  # marks may leave the sheet by this much, because they are followed in steps
STEP_MM = 0.1
MOST_OFF = 0.05, 0.02  # share and mm by which a tracking error may exceed its reported value
TURNED_IN_PLACE = 0.25  # where the contact moves less than this share of the tool's way, the brush turns in place
STEPPED = 8  # one in 8 cases runs in the stepping simulator, and one in 8 is written twice


@dataclass(frozen=True)
class Case:
    """A tried case and its outcome.

    refused: why brushsvg wrote no program.
    wrong: the properties that do not hold.
    """

    number: int
    drawing: str
    brush: str
    dialect: str
    refused: str = ""
    wrong: tuple[str, ...] = ()


# drawings -------------------------------------------------------------------------------------------------------------


def sheet_of(body: str) -> str:
    size = f'width="{SHEET[0]:g}mm" height="{SHEET[1]:g}mm" viewBox="0 0 {SHEET[0]:g} {SHEET[1]:g}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}><title>random</title>{body}</svg>'


def ring(random, middle, reach: tuple[float, float], count: int) -> str:
    """Return a star-shaped polygon or a closed curve around a point."""
    angles = np.sort(random.uniform(0, 2 * np.pi, count))
    points = middle + (random.uniform(*reach, count) * np.exp(1j * angles)).view(float).reshape(-1, 2)
    texts = [f"{x:.3f} {y:.3f}" for x, y in points]
    if random.random() < 0.5:
        return f"M{texts[0]} L{' L'.join(texts[1:])} Z"
    return f"M{texts[0]} " + " ".join(f"Q{a} {b}" for a, b in zip(texts[1::2], texts[2::2], strict=False)) + " Z"


def outlines(random, at: Path) -> Path:
    """Write the parts that letters have: bars, stars, blobs with and without a hole."""
    body = []
    for _ in range(int(random.integers(1, 4))):
        middle, reach = random.uniform((20, 18), (60, 42)), random.uniform(1.0, 14.0)
        kind = int(random.integers(4))
        if kind == 0:
            w, h = random.uniform(0.3, 9), random.uniform(2, 25)
            x, y = middle - (w / 2, h / 2)
            turn = f"rotate({random.uniform(0, 180):.1f} {middle[0]:.2f} {middle[1]:.2f})"
            data = f'transform="{turn}" d="M{x:.3f} {y:.3f}h{w:.3f}v{h:.3f}h{-w:.3f}Z"'
        elif kind == 1:
            data = f'd="{ring(random, middle, (0.4 * reach, reach), int(random.integers(3, 12)))}"'
        elif kind == 2:
            outer = ring(random, middle, (0.7 * reach, reach), 9)
            inner = ring(random, middle, (0.2 * reach, 0.5 * reach), 7)
            data = f'fill-rule="evenodd" d="{outer} {inner}"'
        else:
            a, b = middle, middle + random.uniform(-12, 12, 2)
            thin = random.uniform(0.01, 0.6)
            data = f'd="M{a[0]:.3f} {a[1]:.3f}L{b[0]:.3f} {b[1]:.3f}L{b[0]:.3f} {b[1] + thin:.3f}Z"'
        body.append(f'<path fill="{random.choice(("#000", "#c00"))}" {data}/>')
        if random.random() < 0.3:  # as a text repeats its letters
            x, y = random.uniform(-9, 9, 2)
            body.append(f'<g transform="translate({x:.3f} {y:.3f})">{body[-1]}</g>')
    return put(at.with_suffix(".svg"), sheet_of("".join(body)))


def lines(random, at: Path) -> Path:
    text = random_svg(random)
    if random.random() < 0.3:
        x, y = random.uniform(-5, 5, 2)
        text = text.replace("</svg>", f'<use href="#s0" transform="translate({x:.3f} {y:.3f})"/></svg>')
    return put(at.with_suffix(".svg"), text)


def dots(random, at: Path) -> Path:
    body = "".join(
        f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{random.uniform(0.05, 3):.3f}"/>'
        for x, y in random.uniform((15, 15), (65, 45), (int(random.integers(1, 6)), 2))
    )
    return put(at.with_suffix(".svg"), sheet_of(body))


def dxf(random, at: Path) -> Path:
    import ezdxf

    document = ezdxf.new("R2010", units=4)
    space = document.modelspace()
    for _ in range(int(random.integers(1, 5))):
        x, y = random.uniform((15, 15), (50, 35))
        kind = int(random.integers(4))
        if kind == 0:
            points = [(x + dx, y + dy, 0, 0, b) for dx, dy, b in random.uniform(-10, 10, (4, 3)) * (1, 1, 0.1)]
            space.add_lwpolyline(points, format="xyseb", close=bool(random.integers(2)))
        elif kind == 1:
            space.add_circle((x, y), float(random.uniform(0.5, 10)))
        elif kind == 2:
            space.add_arc((x, y), float(random.uniform(1, 10)), *random.uniform(0, 360, 2).tolist())
        else:
            space.add_spline([(x + dx, y + dy) for dx, dy in random.uniform(-10, 10, (5, 2))])
    document.saveas(at.with_suffix(".dxf"))
    return at.with_suffix(".dxf")


def gcode(random, at: Path) -> Path:
    """Write a program of a pen plotter."""
    text = ["G21", "G90"]
    for _ in range(int(random.integers(1, 5))):
        points = random.uniform((15, 15), (60, 40), (int(random.integers(2, 7)), 2))
        text += ["G0 Z5", "G0 X{:.3f} Y{:.3f}".format(*points[0]), "G1 Z-1 F300"]
        text += ["G1 X{:.3f} Y{:.3f} F1200".format(*each) for each in points[1:]]
    return put(at.with_suffix(".gcode"), "\n".join([*text, "G0 Z5", "M2", ""]))


def plan(random, at: Path) -> Path:
    """Write the plan that convert makes from lines with the shipped brush."""
    source = lines(random, at)
    return at.with_suffix(".json") if not converted(source, at.with_suffix(".json")) else source


DRAWINGS = {"lines": lines, "outlines": outlines, "dots": dots, "dxf": dxf, "gcode": gcode, "plan": plan}
WEIGHTS = {"lines": 3, "outlines": 4, "dots": 1, "dxf": 1, "gcode": 1, "plan": 1}


LAYOUT = ("--wide", "--width", "--fit")  # check needs these options as well, like --corners


def more_flags(random, kind: str, with_end: bool) -> tuple[str, ...]:
    """Return options in addition to the options of random_flags. with_end: whether an end may be requested."""
    flags: tuple[str, ...] = ()
    if kind == "plan":
        return flags
    if random.random() < 0.2:
        flags += ("--wide", str(random.choice(("clamp", "passes", "refuse"))))
    if random.random() < 0.15:
        flags += ("--width", f"{random.uniform(0.8, 4):.2f}")
    if random.random() < 0.15:
        flags += ("--fit", f"{random.uniform(20, 60):.0f}x{random.uniform(15, 45):.0f}")
    if random.random() < 0.1:
        end = str(random.choice(("round", "butt")))
        flags += ("--end", end) if with_end else ()
    return flags


# one case -------------------------------------------------------------------------------------------------------------


def one(number: int, folder: Path, shelf: Path, check: Callable, dialects: Sequence[str] = ()) -> Case:
    """Try one case. It depends on the number and the dialects alone.

    check comes from `checked.quick_check`. shelf is a folder for brush files. An empty dialects means all
    dialects.
    """
    random = np.random.default_rng([number, 53])
    dialect, kind = str(random.choice(list(dialects or CELLS))), _kind(random)
    cell = random_cell(random, dialect)
    brush, name = _brush(random, dialect, folder, shelf)
    if dialect in PENS and kind == "plan":  # a plan presses a brush, which a pen cannot
        kind = "lines"
    folder.mkdir(parents=True, exist_ok=True)
    tried = Case(number, kind, name, dialect)
    try:
        source = DRAWINGS[kind](random, folder / "drawing")
        flags = () if kind == "plan" else random_flags(random, dialect)
        flags = (*flags, *more_flags(random, kind, follows_ends(flags)), "--brush", brush)
        refused, wrong = _judged(number, dialect, cell, source, flags, folder, check)
    except (Exception, SystemExit) as mistake:
        return _ended(tried, "", [f"{CRASHED}: {type(mistake).__name__} {mistake}"])
    return _ended(tried, refused, wrong)


def _kind(random) -> str:
    weights = np.array([*WEIGHTS.values()]) / sum(WEIGHTS.values())
    return str(random.choice([*WEIGHTS], p=weights))


def _ended(case: Case, refused: str, wrong: list[str]) -> Case:
    return Case(case.number, case.drawing, case.brush, case.dialect, refused, tuple(wrong))


def _brush(random, dialect: str, folder: Path, shelf: Path) -> tuple[str, str]:
    """Return the value of --brush and its kind. A pen has one height."""
    if dialect in PENS:
        return "rigid", "rigid"
    kind = str(random.choice([*BRUSHES, "random"]))
    if kind != "random":
        return str(brush_file(shelf, kind)), kind
    folder.mkdir(parents=True, exist_ok=True)
    return str(put(folder / "mine.json", _core.write_brush(random_brush(random)))), kind


def _judged(number, dialect, cell, source, flags, folder, check) -> tuple[str, list[str]]:
    found = judged(dialect, cell, source, flags, folder, check, (*REQUESTED, *LAYOUT))
    wrong = [*found.wrong, *(f"check: {sentence}" for sentence in found.denied)]
    if found.job is None:
        return next(iter(found.refused), ""), wrong
    brush = find_brush(said_of(flags, "--brush")[1])
    wrong += too_deep(found.job.plan, brush)
    if number % STEPPED == 0:
        toml, program = folder / "mine.toml", folder / f"program{CELLS[dialect][1]}"
        wrong += off_sheet(found.job.plan, brush)
        wrong += untrue_errors(source, brush, toml, without(flags, "--z-offset"))
        again = folder / "again" / program.name  # in some languages, a program has the name of its file
        again.parent.mkdir(exist_ok=True)
        again.unlink(missing_ok=True)
        wrong += [f"second time: {refusal}" for refusal in converted(source, again, "--cell", toml, *flags)]
        if again.exists() and again.read_bytes() != program.read_bytes():
            wrong.append("the same input gives other bytes")
    return "", wrong


def too_deep(plan: dict, brush) -> list[str]:
    deepest = -min(z for each in plan["passes"] for _, _, z, *_ in each["poses_mm"])
    allowed = brush.depth_range_mm[1]
    return [f"{deepest:.4f} mm deep, the brush allows {allowed}"] if deepest > allowed + 1e-6 else []


# the stepping simulator -----------------------------------------------------------------------------------------------


class Lag:
    """A brush's lag with the interface that the stepping simulator needs."""

    def __init__(self, brush):
        self.brush = brush

    def __call__(self, depth):
        return self.brush.lag(np.clip(depth, 0.0, self.brush.depth_range_mm[1]))

    def kinks(self):
        return []


@dataclass(frozen=True)
class SteppedPass:
    """Where the stepping simulator puts the brush, (n, 2) [mm], at the poses at which it has a direction.

    widest: the middle of its widest section. sides: its tip and the two ends of that section. is_taut: (n,)
    whether the lag is as long as the law says. turned: (k, 2) contacts where the brush turns in place.
    """

    widest: np.ndarray
    sides: tuple[np.ndarray, np.ndarray, np.ndarray]
    is_taut: np.ndarray
    turned: np.ndarray


def step(a_pass, brush) -> SteppedPass:
    poses = oracle.subdivide(oracle.chords(a_pass.poses_mm, a_pass.arcs), 1, STEP_MM)
    (contact,) = oracle.step_all(poses[None], [Lag(brush)], 2)
    depth = np.clip(-poses[:, 2], 0.0, brush.depth_range_mm[1])
    lever = poses[:, :2] - contact
    reach = np.hypot(*lever.T)
    has_way = np.isfinite(reach) & (poses[:, 2] <= 0) & (reach > 1e-6)
    u = lever[has_way] / reach[has_way, None]
    across = u[:, ::-1] * (-1, 1)
    e = (brush.tip_to_widest(depth) - brush.tip_gap(depth))[has_way, None]
    widest, half = contact[has_way] + e * u, brush.half_width(depth)[has_way, None]
    tip = contact[has_way] - brush.tip_gap(depth)[has_way, None] * u
    sides = tip, widest - half * across, widest + half * across
    moved, of_tool = (np.hypot(*np.diff(each[has_way], axis=0).T) for each in (contact, poses[:, :2]))
    turned = contact[has_way][1:][moved < TURNED_IN_PLACE * of_tool]
    return SteppedPass(widest, sides, (reach >= brush.lag(depth) - 1e-3)[has_way], turned)


def off_sheet(plan: dict, brush) -> list[str]:
    """Return marks off the sheet."""
    wrong = []
    for k, a_pass in enumerate(_core.read_plan(json.dumps(plan)).passes):
        for points in () if len(a_pass.tool_axes) else step(a_pass, brush).sides:
            off = np.maximum(-points, points - np.array(plan["sheet_mm"])).max(initial=-1.0)
            if off > EDGE_MM:
                wrong.append(f"pass {k + 1} paints {off:.3f} mm off the sheet")
    return wrong


def untrue_errors(source: Path, brush, toml: Path, flags: tuple[str, ...]) -> list[str]:
    """Return tracking errors that are reported too small.

    Butt ends, round starts, refined strokes and other compensations leave the line on purpose. So the strokes
    get a pointed start and a round end. Where the brush turns in place, errors are not counted.
    """
    if {"--corners", "refined", "none", "constant"} & set(flags) or source.suffix == ".json":
        return []
    flags = (*without(without(flags, "--end"), "--start"), "--start", "pointed", "--end", "round")
    args = parse(["convert", str(source), "-o", "x.json", "--cell", str(toml), *flags])
    try:
        work = preparation.prepare(source, make_options(make_choices(args)))
    except brushsvg.Error:  # with other ends, a stroke may have no room
        return []
    strokes = zip(work.plan.passes, work.strokes, work.tracking_errors, strict=True)
    return [wrong for each in strokes for wrong in _untrue(*each, brush)]


def _untrue(a_pass, stroke, reported, brush) -> list[str]:
    # A stroke of a filled shape paints the shape. Its middle line was not drawn, and the search may leave it.
    if reported is None or len(a_pass.tool_axes) or len(stroke.target_mm) or len(stroke.middle_mm) == 0:
        return []
    # Between two taut parts the brush turns over and hardly touches. Tracking errors do not count these
    # places.
    stepped = step(a_pass, brush)
    if not stepped.is_taut.any():
        return []
    points = stepped.widest[stepped.is_taut]
    away, _ = oracle.Middle(_beyond_its_ends(stroke)).nearest(points)
    depths = np.linspace(0.0, brush.depth_range_mm[1], 50)
    reach_mm = np.abs(brush.tip_to_widest(depths) - brush.tip_gap(depths)).max() + STEP_MM
    for contact in stepped.turned:
        away[np.hypot(*(points - contact).T) < reach_mm] = 0.0
    most = reported.largest_mm * (1 + MOST_OFF[0]) + MOST_OFF[1]
    if away.max() <= most:
        return []
    return [f"{a_pass.stroke} is {away.max():.3f} mm off its line, reported are {reported.largest_mm:.3f}"]


def _beyond_its_ends(stroke) -> np.ndarray:
    """Return the middle line, longer by half a width at both ends.

    A blunt footprint has to go beyond both ends.
    """
    cubics = np.asarray(stroke.middle_mm)
    points = cubics.reshape(-1, 2)

    def more(end, others, half_mm) -> np.ndarray:
        inner = next((p for p in others if (p != end).any()), end)
        way = half_mm * (end - inner) / max(np.hypot(*(end - inner)), 1e-12)
        return np.concatenate([end + k / 3 * way for k in range(4)])[None]

    first = more(points[0], points, stroke.half_width[0][1])[:, [6, 7, 4, 5, 2, 3, 0, 1]]
    return np.vstack([first, cubics, more(points[-1], points[::-1], stroke.half_width[-1][1])])


def batches_differ(sources: list[Path], folder: Path) -> list[str]:
    """Return the files that one and two processes write differently."""
    made = {}
    for jobs in (1, 2):
        out = folder / f"jobs-{jobs}"
        brushsvg.batch(sources, out, jobs=jobs)
        programs = out / "programs"
        made[jobs] = {p.relative_to(programs): p.read_bytes() for p in programs.rglob("*") if p.is_file()}
    return [f"{name}: another one from two processes" for name in made[1] if made[1][name] != made[2].get(name)]
