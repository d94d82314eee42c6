"""Convert random drawings for random machines, then judge and check the programs."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import shapely

from brushsvg import _core
from brushsvg.errors import Error
from brushsvg.machine.arm.place import move_paper_of_cell
from brushsvg.machine.cells.cell import robot_from_paper, unit_mm
from brushsvg.machine.cells.cell_file import find_cell, write_cell

from .checked import CRASHED, converted, put
from .random_works import random_brush, random_cell, random_flags, random_svg
from .verdict import Job, Way, broken, unlike, way_of
from .works import CELLS, PENS, job_for


@dataclass(frozen=True)
class Tried:
    """One random job and its outcome.

    refused: why brushsvg wrote no program.
    wrong: the errors that the judge found in the program.
    denied: the errors that `brushsvg check` reported.
    """

    dialect: str
    number: int
    refused: tuple[str, ...] = ()
    wrong: tuple[str, ...] = ()
    denied: tuple[str, ...] = ()


def tried(dialect: str, number: int, folder: Path, check) -> Tried:
    """Try one random job, which depends on the dialect and the number alone.

    check comes from `checked.quick_check`.
    """
    random = np.random.default_rng([number, *dialect.encode()])
    cell, svg, flags = random_cell(random, dialect), random_svg(random), random_flags(random, dialect)
    folder.mkdir(parents=True, exist_ok=True)
    source = put(folder / "drawing.svg", svg)
    brush = put(folder / "mine.json", _core.write_brush(random_brush(random)))
    flags += ("--brush", "rigid" if dialect in PENS else str(brush))  # a pen has one height
    found = judged(dialect, cell, source, flags, folder, check)
    return Tried(dialect, number, found.refused, found.wrong, found.denied)


@dataclass(frozen=True)
class Judged:
    """The outcome of a drawing on a machine, with the fields of Tried.

    job is the requested job if brushsvg wrote a program.
    """

    refused: tuple[str, ...] = ()
    wrong: tuple[str, ...] = ()
    denied: tuple[str, ...] = ()
    job: Job | None = None


REQUESTED = ("--brush", "--corners")  # check needs these options as well


def judged(
    dialect: str,
    cell,
    source: Path,
    flags: tuple[str, ...],
    folder: Path,
    check,
    requested: tuple = REQUESTED,
) -> Judged:
    """Convert a drawing, then run the program through the judge and `brushsvg check`.

    The folder gets mine.toml, a program and plan.json.
    """
    suffix = CELLS[dialect][1]
    toml = put(folder / "mine.toml", write_cell(cell))
    program, plan = folder / f"program{suffix}", folder / "plan.json"
    for left in [program, *_parts(program)]:
        left.unlink(missing_ok=True)
    plan.unlink(missing_ok=True)
    try:
        find_cell(toml)
    except Error as refusal:
        return Judged((str(refusal),))
    if refusals := converted(source, program, "--cell", toml, *flags):
        wrong = (f"refused, and written: {refusals}",) if program.exists() else ()
        return Judged(tuple(refusals), wrong)
    text = _whole(program)
    # convert writes the plan's file without the limits of the machine. The program has passed these limits. A plan
    # has no --z-offset, but its automatic ends depend on the height of the paper.
    raised = put(folder / "raised.toml", write_cell(with_raised_paper(cell, flags)))
    if refusals := converted(source, plan, "--cell", raised, *without(flags, "--z-offset")):
        if "--z-offset" in flags and cell.servo:  # the paper of the plan is lower and may be out of reach
            return Judged(tuple(refusals))
        return Judged((), (f"no plan: {refusals}",))
    job = job_for(toml.read_text(encoding="utf-8"), plan.read_text(), said_of(flags, "--brush")[1], flags)
    run = job.interpret(text)
    wrong = [f"the controller stops: {run.refused}"] if run.refused else []
    wrong += [f"acts: {what}" for what in run.acts]
    way = way_of(run, job)
    wrong += broken(way, job)
    is_counted = bool(cell.reload) and cell.reload.when == "length"
    if not is_counted and max(job.servo_mm) <= 0.1 and not (cell.servo and has_steep_ways(job)):
        # A stroke that is split into loads has another plan, and a coarse servo has another path.
        wrong += unlike(way, job)
    if any((job.machine or {}).get("backlash_mm", ())):
        exact_cell = without_backlash(cell)
        exact = put(folder / "exact.toml", write_cell(exact_cell))
        twin = folder / f"exact{suffix}"
        if refusals := converted(source, twin, "--cell", exact, *flags):
            wrong.append(f"no program without backlash: {refusals}")
        elif not is_counted or _plan_of(source, exact_cell, flags, folder) == plan.read_text():
            # Backlash splits arcs. This moves the start of a load, and a brush that runs dry is pressed deeper there.
            of = job_for(exact.read_text(encoding="utf-8"), plan.read_text(), said_of(flags, "--brush")[1], flags)
            has_circles = re.search(r"^G[23] ", text, re.MULTILINE) is not None
            wrong += apart(way, way_of(of.interpret(_whole(twin)), of), cell, has_circles)
    words = [word for flag in requested for word in said_of(flags, flag)]
    drawing = () if source.suffix == ".json" else (source,)
    denied = check(program, *drawing, "--cell", toml, *words)
    assert not any(CRASHED in refusals for refusals in denied), denied
    return Judged((), tuple(wrong), tuple(denied), job)


def _plan_of(source: Path, cell, flags: tuple[str, ...], folder: Path) -> str:
    plan = folder / "exact.json"
    raised = put(folder / "exact-raised.toml", write_cell(with_raised_paper(cell, flags)))
    converted(source, plan, "--cell", raised, *without(flags, "--z-offset"))
    return plan.read_text() if plan.exists() else ""


def _parts(program: Path) -> list[Path]:
    """Return the files in which a long program continues.

    The files of a Fanuc and a KUKA have names of eight letters and digits.
    """
    if program.suffix in (".ls", ".src"):
        return sorted(program.parent.glob(f"[A-Z]*[0-9][0-9][0-9]{program.suffix}"))
    found = program.parent.glob(f"{program.stem}-part*{program.suffix}")
    return sorted(found, key=lambda path: int(path.stem.rpartition("part")[2]))


def _whole(program: Path) -> str:
    return "".join(each.read_text(encoding="latin-1") for each in [program, *_parts(program)])


def has_steep_ways(job: Job) -> bool:
    """Return whether a move of the plan is steeper than 3 : 2.

    A servo changes its height in steps along a move. It presses the brush before a steep move, or lifts it
    after, where the motors' shortest parts of the move would each change the height by more than two steps.
    """
    ways = np.vstack([np.abs(np.diff(each["poses_mm"], axis=0))[:, :3] for each in job.plan["passes"]])
    flat_mm = np.hypot(ways[:, 0], ways[:, 1])
    return bool(((flat_mm > 1e-6) & (ways[:, 2] > 1.5 * flat_mm)).any())


def with_raised_paper(cell, flags: tuple[str, ...]):
    """Return the cell with its paper raised by --z-offset. The paper of a servo stays at z 0."""
    if "--z-offset" not in flags or cell.servo:
        return cell
    return move_paper_of_cell(cell, robot_from_paper(cell, float(said_of(flags, "--z-offset")[1])))


def without_backlash(cell):
    return replace(cell, machine=replace(cell.machine, backlash_mm=(0.0, 0.0)))


def apart(way: Way, exact: Way, cell, has_circles: bool) -> list[str]:
    """Find where a machine with backlash paints elsewhere than a machine without it.

    Each machine runs a program of its own. While a machine takes up play, the brush stands in one place. It
    is in that place on both machines.
    """
    # Half of the backlash is rounded. Both programs round the centre of a circle, and the start that the centre counts
    # from. A servo splits a way with rounded ends. A rounded height displaces a tool that leans.
    leans = np.abs(cell.machine.lean_mm_per_mm)
    units = 2.0 if has_circles else 1.5 if cell.servo else 1.0
    near_mm = unit_mm(cell) * (units * 2**0.5 + np.hypot(*leans)) + CHORDS_MM
    if len(way.touches) != len(exact.touches):
        return [f"{len(way.touches)} touches, {len(exact.touches)} without backlash"]
    lines = [shapely.LineString(each.samples[:, :2]) for each in (way, exact)]
    shapely.prepare(lines)
    touches = zip(way.touches, exact.touches, strict=True)
    for number, both in enumerate(touches, 1):
        for touch, line in zip(both, lines[::-1], strict=True):
            points = shapely.points(touch[:, :2])
            if not shapely.dwithin(line, points, near_mm).all():
                far_mm = shapely.distance(points, line).max()
                return [f"touch {number} is {far_mm:.4g} mm from where it is without backlash"]
    return []


CHORDS_MM = 2e-4  # error of the judge's own chords of circles


def said_of(flags: tuple[str, ...], name: str) -> tuple[str, ...]:
    """Return a flag and its value, or nothing if it was not given."""
    at = flags.index(name) if name in flags else len(flags)
    return flags[at : at + 2]


def without(flags: tuple[str, ...], name: str) -> tuple[str, ...]:
    """Return all flags but one and its value."""
    at = flags.index(name) if name in flags else len(flags)
    return flags[:at] + flags[at + 2 :]
