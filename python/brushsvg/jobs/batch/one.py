"""Convert one drawing of a batch, in any process.

All arguments and results can be pickled.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, fields, replace
from importlib import metadata

from ... import _core
from ...errors import Error, Notice, describe_unexpected
from ...machine.job_program import Job
from ...machine.writer import join_pieces, list_cell_notices
from ...model.library import parse_brush
from ...read import InMemory
from ...show.evaluation.figures import PaintedPlan, measure_figures
from .. import conversion, outputs
from ..choices.choice_checks import check_choices
from ..choices.choices import Choices
from ..choices.drawing_settings import fill_from_drawing
from ..choices.ineffective_flags import report_ineffective_flags
from ..options import make_options
from ..preparation import preparation

PICTURE_LONG_SIDE_PX = 480


@dataclass(frozen=True)
class SentBrush:
    """A brush as the bytes of its file."""

    data: bytes
    sha256: str

    def brush(self) -> _core.Brush:
        brush = parse_brush(self.data)
        brush.sha256 = self.sha256
        return brush


@dataclass(frozen=True)
class Task:
    """A drawing to convert, with everything that a worker needs.

    chosen: the choices without a brush; a cell is a Cell.
    suffix: the extension of the program, "" for the first one of the cell's language.
    version: the version of brushsvg, which the worker must have as well.
    name: the name of the program's file without its extension.
    """

    drawing: InMemory
    chosen: Choices
    brush: SentBrush | None
    suffix: str
    order: str
    lenient: bool
    version: str
    name: str


@dataclass(frozen=True)
class Figures:
    """The figures of one drawing. Lengths are in mm, see evaluation.figures.Figures.

    time_s: how long the machine takes.
    """

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
    """The result of a task.

    figures: None for a refused drawing.
    texts: the files of the program, by what each adds to the name of the program (see writer.in_parts).
    suffix: the extension of all these files.
    where, sentence, code: the element, reason and kind of a refusal.
    """

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
    """Return the version of brushsvg that is installed here."""
    return metadata.version("brushsvg")


def convert_task(task: Task) -> TaskResult:
    """Convert the drawing of a task. A refusal or a bug becomes a result."""
    installed_version = version()
    if task.version != installed_version:
        return TaskResult(None, {}, b"", version=installed_version)
    try:
        result = _convert(task)
    except Error as refusal:
        result = TaskResult(None, {}, b"", refusal.where, str(refusal), refusal.code, refusal.notices)
    except Exception as bug:  # a bug of brushsvg: the other drawings are converted nevertheless
        error = describe_unexpected(bug)
        result = TaskResult(None, {}, b"", sentence=str(error), code=error.code)
    return replace(result, version=installed_version)


def _convert(task: Task) -> TaskResult:
    chosen = replace(task.chosen, input=task.drawing, brush=task.brush.brush() if task.brush else None)
    if task.drawing.extension in (".svg", ".svgz"):
        chosen = replace(chosen, units=None)  # units are for the drawings of a batch that do not define them
    chosen = fill_from_drawing(check_choices(chosen), task.drawing)
    work = preparation.prepare(task.drawing, make_options(chosen))
    suffix = task.suffix or conversion.default_suffix(work.options.cell)
    simulated = conversion.simulate_and_check(
        work, suffix, Job(chosen.z_offset or 0.0), task.order, task.lenient, path=task.name + suffix
    )
    if simulated.problems:
        problem, *others = simulated.problems
        rest = f", and {len(others)} more of other kinds" if others else ""
        raise Error(f"{problem.sentence}{rest}", problem.where, code=problem.code, advice=problem.advice)
    joined = {name: join_pieces(pieces) for name, pieces in simulated.encoded().items()}
    texts = {name: text.encode() if isinstance(text, str) else text for name, text in joined.items()}
    _, total = measure_figures(
        PaintedPlan(
            simulated.work.plan,
            simulated.marks,
            work.brush,
            simulated.work.strokes,
            work.options.tolerance_mm,
            None,
            work.options.compensation,
            work.unreached,
        )
    )
    cell_notices = list_cell_notices(simulated.cell) if simulated.is_program else []
    notices = (*report_ineffective_flags(chosen), *simulated.work.notices, *simulated.remarks(), *cell_notices)
    measured = {item.name: getattr(total, item.name) for item in fields(Figures) if hasattr(total, item.name)}
    figures = Figures(
        strokes=len(simulated.work.plan.passes), time_s=simulated.time_s(), warnings=len(notices), **measured
    )
    picture = outputs.overlap_picture(".png", simulated.work, simulated.marks, PICTURE_LONG_SIDE_PX)
    return TaskResult(figures, texts, picture, notices=notices, suffix=suffix)


def sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
