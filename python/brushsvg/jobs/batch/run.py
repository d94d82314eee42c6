"""Run a batch: convert drawings in an executor, and write their files.

Each drawing is recorded in the manifest as soon as its files are written.
"""

from __future__ import annotations

import json
import os
import queue
import time
from collections.abc import Callable, Iterable
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Unpack

from ... import _core
from ...errors import Error, name_file_in_errors, need_number, need_one_of, need_truth, require_type
from ...files import find_file, read_bytes, write_files
from ...machine.cells import cell_file
from ...machine.cells.cell_file import write_cell
from ...machine.posts import POSTS, sources_of_post
from ...machine.writer import path_next_to
from ...model import library
from ...reporting.report_text import format_overlap
from ...show.contact_sheet import Card, contact_sheets
from ...units import clock
from ..cancelling import Cancel
from ..choices.choices import ChoiceKeywords, Choices
from ..conversion import ORDERS, make_choices, refuse_job_of_plan
from ..options import load_cell
from ..project.ignored_settings import drop_from_project
from . import executors, one, tables
from .items import Item, file_name_key, make_items
from .manifest import Manifest, Row, make_path_below
from .one import SentBrush, Task, TaskResult, convert_task, sha256

PROGRAMS, PICTURES = "programs", "pictures"
POLL_INTERVAL_S = 0.1
# Drawings that are submitted ahead. With fewer, the workers of a cluster wait; with more, memory grows.
MAX_PENDING_DRAWINGS = 256
MAX_PENDING_BYTES = 64 * 2**20


@dataclass(frozen=True)
class Batch:
    """The result of a batch.

    rows: one for each drawing, in the order of the drawings.
    resumed: the number of drawings that an earlier run had finished.
    files: paths of the tables and contact sheets.
    removed: programs and pictures, by their path below the folder, that an earlier run made of drawings that are
        refused now.
    """

    rows: tuple[Row, ...]
    resumed: int
    files: tuple[str, ...]
    removed: tuple[str, ...] = ()

    @property
    def refused(self) -> tuple[Row, ...]:
        return tuple(row for row in self.rows if row.figures is None)


def batch(
    items: Iterable[str | os.PathLike[str] | tuple[str, str | bytes] | Item],
    out: str | os.PathLike[str],
    *,
    executor: Executor | None = None,
    jobs: int | None = None,
    cluster: str | None = None,
    format: str = "",
    order: str = "drawn",
    lenient: bool = False,
    parquet: bool = False,
    progress: Callable[[str], object] | None = None,
    cancel: Cancel | None = None,
    **choices: Unpack[ChoiceKeywords],
) -> Batch:
    """Convert many drawings, each as `convert` does.

    A drawing is not converted again if an earlier run into the same folder has finished it. For this, the drawing,
    choices, brush, cell and version must be the same, and its files must be unchanged.

    items: paths of drawings, folders, patterns with * and lists (.txt), and pairs of a name and an SVG document.
    out: the folder for programs/NAME.ngc, pictures/NAME.png, manifest.jsonl, table.csv, contact-1.png and so on.
    executor: any executor of concurrent.futures; it receives functions and values that can be pickled, and is not
        shut down.
    jobs: the number of processes if there is no executor, by default one for each processor. A script that starts
        processes must be a file, and needs `if __name__ == "__main__":`.
    cluster: the address of a Dask scheduler, to use in place of processes. Rows and files are the same in any
        process.
    format: the extension of the programs, by default the first one of the cell's language.
    parquet: also write table.parquet.
    progress, cancel, order, lenient, choices: as for `convert`. Corrections are not accepted, because they belong
        to one drawing.

    A refused drawing is a row with its sentence and code. It does not stop the batch, and files that an earlier run
    made of it are removed.

    Raises Error for a problem that concerns the whole batch: the folder, two items with one name, files that were
        made of another drawing with that name, a brush or a cell. Raises CancelledError when `cancel` is set;
        finished drawings are kept.
    """
    require_type(out, (str, os.PathLike), "a path", "out")
    require_type(format, str, "an extension, such as '.ngc'")
    need_one_of(order, ORDERS, "order")
    extensions = {".json", *(extension for post in POSTS.values() for extension in post.extensions)}
    if format and format not in extensions:
        raise Error(f"{format[:40]!r} is no extension of programs or plans", "format", code="program-format")
    if (executor is not None) + (jobs is not None) + (cluster is not None) > 1:
        raise Error("executor, jobs and cluster exclude each other", code="options-contradict")
    if executor is not None:
        require_type(executor, Executor, "an executor of concurrent.futures")
    if cluster is not None:
        require_type(cluster, str, "the address of a scheduler")
    if progress is not None:
        require_type(progress, Callable, "a callable", "progress")
    if executor is None and cluster is None:
        executors.end_repeated_script()
    is_cancelled = getattr(cancel, "is_set", cancel) or (lambda: False)
    require_type(is_cancelled, Callable, "a callable or an event", "cancel")
    if "corrections" in choices:
        raise Error(
            "corrections belong to one drawing: a batch cannot use them", "corrections", code="options-contradict"
        )
    count = int(need_number(os.cpu_count() if jobs is None else jobs, "jobs", 1, 1000))
    if parquet:
        tables.need_parquet()
    require_type(items, Iterable, "an iterable of drawings")
    require_type(items, object if not isinstance(items, str | bytes) else tuple, "a list of drawings")
    drawings = make_items(items)
    need_truth(lenient, "lenient")
    need_truth(parquet, "parquet")
    # Margin strokes belong to a page. A project may set them for conversions with a page.
    chosen = drop_from_project(make_choices(None, choices), ["margin_strokes"])
    chosen = refuse_job_of_plan(chosen, [format] if format else [])
    settings = _make_batch_settings(chosen, format, order, bool(lenient))
    folder = Path(out)
    manifest = Manifest(folder)
    try:
        keys = [settings.key(item) for item in drawings]
        rows: list[Row | None] = [
            manifest.find_finished(key, item) if item.digest else None for key, item in zip(keys, drawings, strict=True)
        ]
        resumed = len(drawings) - rows.count(None)
        remaining = [index for index, row in enumerate(rows) if row is None]
        for index in remaining:
            manifest.refuse_other_drawing(drawings[index])
        places = _TakenPlaces(drawings, manifest)
        removed = [path for row in rows if row for path in manifest.remove_outdated(row)]
        report_row = _make_reporter(len(drawings), resumed, progress or (lambda text: None))
        with ExitStack() as stack:
            is_ours = executor is None and cluster is None
            if remaining and executor is None:
                executor_context = (
                    executors.connect_cluster(cluster)
                    if cluster
                    else executors.start_processes(min(count, len(remaining)))
                )
                executor = stack.enter_context(executor_context)
            for index, result in _convert_remaining(executor, is_ours, remaining, drawings, settings, is_cancelled):
                row = _write_result(folder, drawings[index], keys[index], result, places)
                row = rows[index] = replace(row, path=manifest.make_relative_path(drawings[index]))
                removed += manifest.remove_outdated(row)
                manifest.add(row)
                report_row(row)
        manifest.finish(rows)
        files = _write_summary(folder, rows, parquet)
    finally:
        manifest.close()
    return Batch(tuple(rows), resumed, tuple(files), tuple(removed))


@dataclass(frozen=True)
class _BatchSettings:
    """How all drawings are converted.

    description: all settings in one text, with the hashes of everything that is shipped with brushsvg.
    """

    chosen: Choices
    brush: SentBrush | None
    format: str
    order: str
    lenient: bool
    version: str
    description: str

    def key(self, item: Item) -> str:
        return sha256(f"{item.digest}\n{self.description}".encode())

    def task(self, item: Item) -> Task:
        return Task(
            item.read(), self.chosen, self.brush, self.format, self.order, self.lenient, self.version, item.name
        )


def _make_batch_settings(chosen: Choices, format: str, order: str, lenient: bool) -> _BatchSettings:
    version = one.version()
    cell = load_cell(chosen.cell) if chosen.cell is not None else None
    brush = _read_brush_to_send(chosen.brush) if chosen.brush is not None else None
    shipped = [library.SHIPPED.glob("*.json"), cell_file.SHIPPED.glob("*.toml")]
    shipped_hashes = [sha256(read_bytes(path)) for paths in shipped for path in sorted(paths)]
    # The command line sets these two choices in the same way, so both give the same keys.
    chosen = replace(chosen, z_offset=chosen.z_offset or 0.0, join=bool(chosen.join))
    plain_choices = asdict(replace(chosen, brush=None, cell=None))
    post_hashes = [sha256(read_bytes(path)) for path in sources_of_post(cell)] if cell else []
    hashes = [
        brush and (brush.sha256, sha256(brush.data)),
        cell and write_cell(cell),
        post_hashes,
        shipped_hashes,
    ]
    description = json.dumps([plain_choices, format, order, lenient, version, hashes])
    chosen = replace(chosen, brush=None, cell=cell)
    return _BatchSettings(chosen, brush, format, order, lenient, version, description)


def _read_brush_to_send(brush) -> SentBrush:
    if isinstance(brush, _core.Brush):
        return SentBrush(_core.write_brush(brush).encode(), brush.sha256)
    with name_file_in_errors(brush):
        data = read_bytes(find_file("brush", library.SHIPPED, ".json", brush))
        library.parse_brush(data)
    return SentBrush(data, sha256(data))


def _convert_remaining(
    executor, is_ours: bool, remaining: list[int], items: list[Item], settings: _BatchSettings, is_cancelled
):
    """Yield number and TaskResult of each drawing as it finishes; is_ours: the executor ends with the batch."""
    finished: queue.SimpleQueue = queue.SimpleQueue()
    pending: dict[Future, tuple[int, int]] = {}
    numbers = iter(remaining)
    try:
        while True:
            while len(pending) < MAX_PENDING_DRAWINGS and sum(size for _, size in pending.values()) < MAX_PENDING_BYTES:
                index = next(numbers, None)
                if index is None:
                    break
                try:
                    task = settings.task(items[index])
                except Error as refusal:
                    yield index, TaskResult(None, {}, b"", refusal.where, str(refusal), refusal.code)
                    continue
                try:
                    future = executor.submit(convert_task, task)
                except BrokenExecutor as broken:
                    raise _make_lost_worker_error(items[index], broken) from None
                pending[future] = index, len(task.drawing.data)
                future.add_done_callback(finished.put)
            if not pending:
                return
            if is_cancelled():
                raise CancelledError("cancelled")
            try:
                future = finished.get(timeout=POLL_INTERVAL_S)
            except queue.Empty:
                continue
            index, _ = pending.pop(future)
            yield index, _get_result(future, items[index], settings.version)
    finally:
        for future in () if is_ours else pending:
            future.cancel()


def _get_result(future: Future, item: Item, version: str) -> TaskResult:
    try:
        result = future.result()
    except BrokenExecutor as broken:
        raise _make_lost_worker_error(item, broken) from None
    if result.version != version:
        sentence = f"the worker has version {result.version} of brushsvg, not {version}"
        raise Error(sentence, code="version-unknown")
    return result


def _make_lost_worker_error(item: Item, broken: BrokenExecutor) -> Error:
    sentence = (
        f"a worker process died while it converted {item.source} or another drawing; finished drawings are kept: "
        f"{broken}"
    )
    return Error(sentence.splitlines()[0], code="worker-lost")


class _TakenPlaces:
    """Where the files of each drawing may be written, without regard to case.

    Windows and macOS ignore case. A program in several files is a folder: the folder of drawing `a` may contain the
    file that drawing `a/a` is written to.
    """

    def __init__(self, items: list[Item], manifest: Manifest):
        self.manifest = manifest
        self.sources = {file_name_key(item.name): item.source for item in items}
        self.folders = {
            file_name_key(folder.as_posix()): item.source for item in items for folder in Path(item.name).parents
        }

    def refuse_taken(self, item: Item, paths: Iterable[str]) -> None:
        """Raise Error if a file would replace a file of another drawing.

        A file also must not replace a folder that contains files of another drawing.
        """
        for path in paths:
            place = Path(path).relative_to(Path(path).parts[0])
            stem_key, own_key = file_name_key(place.with_suffix("").as_posix()), file_name_key(item.name)
            other = self.sources.get(stem_key) if stem_key != own_key else None
            other = other or self.folders.get(file_name_key(place.as_posix()))
            other = other or self.manifest.find_other_source(item, path)
            if other:
                sentence = f"{path} belongs to {other}: {item.source} would replace it"
                raise Error(sentence, code="name-taken", advice="rename one of the two drawings")


def _write_result(folder: Path, item: Item, key: str, result: TaskResult, places: _TakenPlaces) -> Row:
    """Write all files of a drawing or none, and return its row."""
    if result.figures is None:
        return Row(item.name, item.source, key, None, result.code, result.where, result.sentence, result.notices)
    program_folder = Path(PROGRAMS, item.name) if len(result.texts) > 1 else Path(PROGRAMS, item.name).parent
    first = program_folder / f"{Path(item.name).name}{result.suffix}"
    contents = {Path(path_next_to(first, name)).as_posix(): text for name, text in result.texts.items()}
    contents[f"{PICTURES}/{item.name}.png"] = result.picture
    try:
        places.refuse_taken(item, contents)
    except Error as refusal:
        return Row(item.name, item.source, key, None, refusal.code, refusal.where, str(refusal), result.notices)
    write_files({make_path_below(folder, name): text for name, text in contents.items()})
    hashes = {name: sha256(text) for name, text in contents.items()}
    return Row(item.name, item.source, key, result.figures, notices=result.notices, files=hashes)


def _make_reporter(count: int, resumed: int, progress):
    """Return a function that reports progress, speed and time left after each row."""
    start, counts = time.monotonic(), [0, 0]

    def report_row(row: Row) -> None:
        counts[0] += 1
        counts[1] += row.figures is None
        drawings_per_s = counts[0] / max(time.monotonic() - start, 1e-9)
        refused = f", {counts[1]} refused" if counts[1] else ""
        left_s = (count - resumed - counts[0]) / drawings_per_s
        progress(
            f"{resumed + counts[0]} of {count} drawings{refused}; {drawings_per_s:.1f} a second, {clock(left_s)} left"
        )

    return report_row


def _write_summary(folder: Path, rows: list[Row], parquet: bool) -> list[str]:
    """Write tables and contact sheets of all rows, delete those of a larger batch, and return their paths."""
    files = {folder / "table.csv": tables.format_csv(rows)}
    if parquet:
        files[folder / "table.parquet"] = tables.format_parquet(rows)
    cards = [_make_card(folder, row) for row in rows]
    sheets = contact_sheets(cards)
    for number, data in enumerate(sheets, 1):
        write_files({folder / f"contact-{number}.png": data})
        files[folder / f"contact-{number}.png"] = None
    write_files({path: data for path, data in files.items() if data is not None})
    number = sum(data is None for data in files.values())
    for path in folder.glob("contact-*.png"):
        if path.stem.removeprefix("contact-").isdigit() and int(path.stem.removeprefix("contact-")) > number:
            path.unlink()
    return [os.fspath(path) for path in files]


def _make_card(folder: Path, row: Row) -> Card:
    if row.figures is None:
        return Card(row.name, row.code, row.text, None)
    figures = row.figures
    overlap = "" if figures.overlap is None else f"overlap {format_overlap(figures.overlap)}"
    duration = "" if figures.time_s is None else clock(figures.time_s)
    caption = ", ".join(filter(None, (overlap, duration)))
    return Card(row.name, caption, "", lambda: read_bytes(folder / PICTURES / f"{row.name}.png"))
