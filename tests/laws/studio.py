"""A studio whose machine, brush and paper have faults.

The simulator of `painter` paints in small steps. It uses nothing of the library but the plan and the page.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import numpy as np
import painter
import photograph
from photograph import BLUE, INK, Camera
from shapely import affinity
from shapely.geometry import Polygon
from shapely.ops import unary_union

from brushsvg._core import MarkLaws
from brushsvg.calibration.marks.from_marks import brush_of
from brushsvg.comparison.job_page import job_page

WORD = """<svg xmlns="http://www.w3.org/2000/svg" width="150mm" height="90mm" viewBox="0 0 150 90">
<title>word</title><g fill="none" stroke="#000" stroke-linecap="round">
<path id="bow" d="M14 34 C24 8 48 8 56 32" stroke-width="5"/>
<path id="line" d="M60 78 L14 74" stroke-width="3"/>
<path id="wave" d="M72 76 C84 56 96 92 110 72 S128 66 132 76" stroke-width="2.5"/>
<path id="hook" d="M70 12 L98 12 C106 12 106 34 92 34 L78 34" stroke-width="4"/>
<path id="loop" d="M34 46 a9 9 0 1 1 -0.01 0" stroke-width="2"/>
<path id="slash" d="M58 24 L30 20" stroke-width="3"/>
<path id="stem" d="M124 20 L126 52" stroke-width="4"/>
<path id="knee" d="M70 48 L94 48 L112 24" stroke-width="5.5"/></g></svg>"""
LAG, GAP, HALF = np.array([2.6, 1.3, 0.1, -0.009]), np.array([0.0, 0.45]), np.array([0.0, 0.5, -0.005])
AIR_MM = 0.9  # no paper is higher
WIDEST, FRONT, DEEPEST = 1.6, 0.95, 10.0


def known_brush(sure=0.08, lag=1.0, half=1.0):
    """Return the brush of its file, with lag and half width multiplied by factors.

    Each number is known to a share `sure` of its value (standard deviation).
    """
    laws = MarkLaws((lag * LAG).tolist(), GAP.tolist(), (half * HALF).tolist(), WIDEST, FRONT)
    numbers = np.array([*LAG, GAP[1], *HALF[1:], WIDEST, FRONT, 1e-9, 1e-9, 1e-9, 1e-9])
    brush = brush_of(laws, "mine", (0.0, DEEPEST), np.diag((sure * numbers) ** 2))
    brush.max_speed_mm_s = 25.0
    return brush


@dataclass(frozen=True)
class Faults:
    """The faults of a studio.

    The brush has factors for lag and half width. The machine has scale - 1, skew (from the work zero, the
    sheet's corner), lean and backlash. The paper is higher at the sheet's middle and tilted about it. The
    sheet has a place. own holds the constant displacement of each stroke, random_mm is the sigma of random
    ones. lasts_mm is the way that a load of paint lasts.
    """

    lag: float = 1.0
    half: float = 1.0
    scale: tuple = (0.0, 0.0)
    skew: float = 0.0
    lean: tuple = (0.0, 0.0)
    backlash: tuple = (0.0, 0.0)
    height: float = 0.0
    tilt: tuple = (0.0, 0.0)
    shift: tuple = (0.0, 0.0)
    turn: float = 0.0
    own: dict = field(default_factory=dict)
    random_mm: float = 0.0
    lasts_mm: float = np.inf

    def corrected(self, cause):
        """Return the faults without one cause, named as compare names it."""
        good = Faults()
        keys = {
            "place of the sheet": ("shift", "turn"),
            "machine": ("scale", "skew", "lean", "backlash"),
            "height and tilt of the paper": ("height", "tilt"),
            "brush": ("lag", "half"),
            "each stroke's own place": ("own", "random_mm"),
            "missing paint": ("lasts_mm",),
        }[cause]
        return replace(self, **{key: getattr(good, key) for key in keys})


def random_faults(rng, names, sheet_mm):
    """Return random faults.

    The brush is up to 20 % off. The sheet has up to 2 mm of tilt, the machine up to 0.5 mm of backlash and 1
    % of scale.
    """
    tilt = rng.uniform(-1, 1, 2) * rng.dirichlet([1, 1]) * 2 / np.array(sheet_mm)
    return Faults(
        *(1 + rng.uniform(-0.2, 0.2, 2)),
        scale=tuple(rng.uniform(-0.01, 0.01, 2)),
        backlash=tuple(rng.uniform(0, 0.5, 2)),
        tilt=tuple(tilt),
        own={name: rng.normal(0, 0.1, 2) for name in names},
        random_mm=0.1,
    )


def commanded_by(program, sheet_mm):
    """Return the commanded places of each stroke in a program for LinuxCNC.

    They begin in the air. Circles have close places.
    """
    at, found = np.array([0.0, 0.0, 50.0]), []
    for line in program.splitlines():
        if title := re.match(r"\(stroke \d+ of \d+: (.*)\)", line):
            found.append(SimpleNamespace(stroke=title[1], poses_mm=[], arcs=()))
        words = {key: float(value) for key, value in re.findall(r"([GXYZIJ])(-?[\d.]+)", line.split("(")[0])}
        if not {"X", "Y", "Z"} & set(words):
            continue
        end, places = np.array([words.get(key, old) for key, old in zip("XYZ", at, strict=True)]), []
        if "I" in words:
            centre = at[:2] + np.array([words["I"], words["J"]])
            a, b = ((each[:2] - centre) @ [1, 1j] for each in (at, end))
            turn = np.angle(b / a) % (2 * np.pi) - (0 if words["G"] == 3 else 2 * np.pi)
            share = np.linspace(0, 1, 2 + int(abs(turn * a) / 0.3))[1:-1]
            on = a * np.exp(1j * turn * share)
            places = [(centre[0] + each.real, centre[1] + each.imag, end[2]) for each in on]
        if found:
            found[-1].poses_mm += [*places, end]
        at = end
    return SimpleNamespace(passes=found, sheet_mm=tuple(sheet_mm))


def ran(plan, fault_values):
    """Return [(stroke, poses)], the places of the tool, z over the true paper."""
    middle = 0.5 * np.array(plan.sheet_mm)
    play, last, out = np.zeros(2), None, []
    for one in plan.passes:
        poses = painter.dense(np.array(one.poses_mm), one.arcs)
        place = poses[:, :2].copy()
        for k, here in enumerate(poses[:, :2]):  # the slide stands while the screw crosses its play
            play = np.clip(
                play + (here - (here if last is None else last)),
                *np.outer([-0.5, 0.5], fault_values.backlash),
            )
            place[k] -= play
            last = here
        at = place - middle
        z = poses[:, 2] - fault_values.height - at @ fault_values.tilt
        at = place + place * fault_values.scale + np.outer(place[:, 1], [fault_values.skew, 0.0])
        at += np.outer(np.maximum(-z, 0), fault_values.lean)
        low = np.flatnonzero(z < AIR_MM)  # in the air, a program moves the slides and paints nothing
        poses = np.column_stack([at, z])[low[0] : low[-1] + 1]
        poses[[0, -1], 2] = np.minimum(poses[[0, -1], 2], 0.0)
        out.append((one.stroke, poses if len(low) < len(z) else np.column_stack([at, z])))
    return out


def painted(plan, fault_values, seed=0, strokes_a_load=1):
    """Return the painted region of each stroke on the sheet."""
    return laid(swept(plan, fault_values, strokes_a_load), plan, fault_values, seed)


def swept(plan, fault_values, strokes_a_load=1):
    """Return the region that the machine paints for each stroke.

    Constant and random displacements of strokes are left out.
    """
    brush = painter.TrueBrush(DEEPEST, fault_values.lag * LAG, GAP, fault_values.half * HALF, WIDEST, FRONT)
    ways, lasts, come = ran(plan, fault_values), [], 0.0
    for k, (_, poses) in enumerate(ways):
        come = come if k % strokes_a_load else 0.0
        lasts.append(max(fault_values.lasts_mm - come, 2.0))
        come += float(np.hypot(*np.diff(poses[:, :2], axis=0).T).sum())
    regions = painter.swept(brush, ways, 0.0, lasts=lasts)
    return {name: region for (name, _), region in zip(ways, regions, strict=True) if region is not None}


def laid(regions, plan, fault_values, seed):
    """Return the regions at their places on a sheet."""
    rng = np.random.default_rng(seed)
    middle = tuple(0.5 * np.array(plan.sheet_mm))
    out = {}
    for name, region in regions.items():
        displaced = fault_values.own.get(name, np.zeros(2)) + rng.normal(0, fault_values.random_mm, 2)
        region = affinity.rotate(affinity.translate(region, *displaced), fault_values.turn, middle)
        out[name] = affinity.translate(region, *fault_values.shift)
    return out


def photographed(plan, regions, title="", camera=None, seed=1):
    """Return a photograph of the sheet as JPEG bytes."""
    page = job_page(plan, title)
    sheet = photograph.page(page.printed)
    for tick in page.ticks:
        sheet.paint([tick], INK)
    for region in regions.values():
        rings = [ring for part in getattr(region, "geoms", [region]) for ring in (part.exterior, *part.interiors)]
        sheet.paint([np.array(ring.coords)[:-1] + page.frame_mm for ring in rings], BLUE)
    camera = camera or Camera(size_px=(1800, round(1800 * page.size_mm[1] / page.size_mm[0])), fill=0.93)
    return photograph.photograph(sheet, camera, seed)


def overlap(regions, target):
    one, other = (unary_union(list(each.values())) for each in (regions, target))
    return one.intersection(other).area / one.union(other).area


def as_region(rings):
    """Return a region from rings: outer rings counter-clockwise, holes clockwise."""
    shapes = [Polygon(ring) for ring in rings]
    outer, holes = (
        unary_union([shape.buffer(0) for shape in shapes if shape.exterior.is_ccw == side]) for side in (True, False)
    )
    return outer.difference(holes)
