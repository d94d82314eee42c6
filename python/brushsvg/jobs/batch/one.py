"""Convert one drawing of a batch, in any process: arguments and results can be pickled."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from importlib import metadata

from ... import _core
from ...errors import Error, Notice, unexpected
from ...machine.program import Job
from ...model.library import parse_brush
from ...read import InMemory
from ...show.evaluation import report
from .. import conversion, outputs
from ..choices import Choices, apply_drawing_settings, check_choices, make_options
from ..preparation import preparation

PICTURE_LONG_SIDE_PX = 480


@dataclass(frozen=True)
class SentBrush:
    """A brush as the bytes of its file."""

    data: bytes
    sha256: str

    def brush(self) -> _core.Brush:
        found = parse_brush(self.data)
        found.sha256 = self.sha256
        return found


@dataclass(frozen=True)
class Task:
    """drawing: what to convert; chosen: how, without brush, a cell as itself; suffix: of the program, "" for the first
    of the cell's language; version: of brushsvg, which must be the worker's."""

    drawing: InMemory
    chosen: Choices
    brush: SentBrush | None
    suffix: str
    order: str
    lenient: bool
    version: str


@dataclass(frozen=True)
class Figures:
    """Of one drawing. time_s: how long the machine takes; lengths in mm, see evaluation.report.Figures."""

    strokes: int
    poses: int
    time_s: float | None
    overlap: float | None
    centre_mean_mm: float | None
    centre_largest_mm: float | None
    width_error_mm: float | None
    widths_out_of_reach: int | None
    drawn_mm: float | None
    painted_mm: float
    warnings: int


@dataclass(frozen=True)
class TaskResult:
    """figures: None for what was refused; texts: of the program, by what they add to its name (see writer.in_parts);
    suffix: of all of them; sentence, code: of a refusal."""

    figures: Figures | None
    texts: dict[str, bytes]
    picture: bytes
    where: str = ""
    sentence: str = ""
    code: str = ""
    notices: tuple[Notice, ...] = ()
    version: str = ""
    suffix: str = ""


def version() -> str:
    """Of brushsvg, as it is installed here."""
    return metadata.version("brushsvg")


def convert_task(task: Task) -> TaskResult:
    here = version()
    if task.version != here:
        return TaskResult(None, {}, b"", version=here)
    try:
        done = _convert(task)
    except Error as refusal:
        done = TaskResult(None, {}, b"", refusal.where, str(refusal), refusal.code, refusal.notices)
    except Exception as mistake:  # of ours: the others are painted all the same
        said = unexpected(mistake)
        done = TaskResult(None, {}, b"", sentence=str(said), code=said.code)
    return replace(done, version=here)


def _convert(task: Task) -> TaskResult:
    chosen = replace(task.chosen, input=task.drawing, brush=task.brush.brush() if task.brush else None)
    if task.drawing.extension in (".svg", ".svgz"):
        chosen = replace(chosen, units=None)  # of those among the drawings that do not say theirs
    chosen = apply_drawing_settings(check_choices(chosen), task.drawing)
    work = preparation.prepare(task.drawing, make_options(chosen))
    suffix = task.suffix or conversion.default_suffix(work.options.cell)
    one = conversion.simulate_and_check(work, suffix, Job(chosen.z_offset or 0.0), task.order, task.lenient)
    if one.problems:
        first, *others = one.problems
        more = f", and {len(others)} more of other kinds" if others else ""
        raise Error(f"{first.sentence}{more}", first.where, code=first.code)
    texts = {
        name: pieces if isinstance(pieces, bytes) else "".join(pieces).encode()
        for name, pieces in one.encoded().items()
    }
    _, total = report.measure(
        report.PaintedPlan(
            one.work.plan,
            one.marks,
            work.brush,
            one.work.strokes,
            work.options.tolerance_mm,
            None,
            work.options.compensation,
            work.unreached,
        )
    )
    of_machine = conversion.list_cell_notices(one.cell) if one.is_program else []
    notices = (*one.work.notices, *one.remarks(), *of_machine)
    figures = Figures(
        len(one.work.plan.passes),
        total.poses,
        one.time_s(),
        total.overlap,
        total.centre_mean_mm,
        total.centre_largest_mm,
        total.width_error_mm,
        total.widths_out_of_reach,
        total.drawn_mm,
        total.painted_mm,
        len(notices),
    )
    picture = outputs.overlap_picture(".png", one.work, one.marks, PICTURE_LONG_SIDE_PX)
    return TaskResult(figures, texts, picture, notices=notices, suffix=suffix)


def sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
