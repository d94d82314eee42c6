"""Random drawings on random machines: what is written, judged and checked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from brushsvg.errors import Error
from brushsvg.machine.cell_file import find_cell, write_cell

from .checked import CRASHED, converted, put
from .random_works import random_cell, random_flags, random_svg
from .verdict import broken, unlike, way_of
from .works import CELLS, job_for


@dataclass(frozen=True)
class Tried:
    """One random job. refused: why no program was written; else wrong: what the judge says of it, and denied: what
    check says of it."""

    dialect: str
    number: int
    refused: tuple[str, ...] = ()
    wrong: tuple[str, ...] = ()
    denied: tuple[str, ...] = ()


def tried(dialect: str, number: int, folder: Path, check) -> Tried:
    """check: of `checked.quick_check`. Everything hangs on dialect and number alone."""
    random = np.random.default_rng([number, *dialect.encode()])
    cell, svg, flags = random_cell(random, dialect), random_svg(random), random_flags(random, dialect)
    folder.mkdir(parents=True, exist_ok=True)
    suffix = CELLS[dialect][1]
    source, toml = put(folder / "drawing.svg", svg), put(folder / "mine.toml", write_cell(cell))
    program, plan = folder / f"program{suffix}", folder / "plan.json"
    program.unlink(missing_ok=True)
    try:
        find_cell(toml)
    except Error as refusal:
        return Tried(dialect, number, (str(refusal),))
    if said := converted(source, program, "--cell", toml, *flags):
        return Tried(dialect, number, tuple(said))
    planned = [flag for k, flag in enumerate(flags) if "--z-offset" not in flags[max(0, k - 1) : k + 1]]
    wrong: list[str] = []
    text = program.read_text(encoding="latin-1")
    # the plan's own file is written without the machine's limits, which the program has passed
    if said := converted(source, plan, "--cell", toml, *planned):
        wrong.append(f"no plan: {said}")
        return Tried(dialect, number, (), tuple(wrong))
    job = job_for(toml.read_text(encoding="utf-8"), plan.read_text(), "round-6", flags)
    run = job.interpret(text)
    wrong += [f"the controller stops: {run.refused}"] if run.refused else []
    wrong += [f"acts: {what}" for what in run.acts]
    way = way_of(run, job)
    wrong += broken(way, job)
    if not (cell.reload and cell.reload.when == "length") and max(job.servo_mm) <= 0.1:
        wrong += unlike(way, job)  # a stroke in loads is another plan, and a coarse servo another path
    denied = check(program, source, "--cell", toml)
    assert not any(CRASHED in said for said in denied), denied
    return Tried(dialect, number, (), tuple(wrong), tuple(denied))
