"""A batch: drawings handed to an executor, their files written as they come back, each remembered in the manifest."""

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
from ...errors import Error, need, need_number, need_one_of, need_truth
from ...files import find_file, read_bytes, write_files
from ...machine.cells import cell_file
from ...machine.cells.cell_file import write_cell
from ...machine.posts import POSTS, sources_of_post
from ...machine.writer import path_next_to
from ...model import library
from ...show.contact_sheet import Card, contact_sheets
from ...units import clock
from ..cancelling import Cancel
from ..choices import ChoiceKeywords, Choices, load_cell
from ..conversion import ORDERS, make_choices
from . import executors, one, tables
from .items import Item, file_name_key, make_items
from .manifest import Manifest, Row, make_path_below
from .one import SentBrush, Task, TaskResult, convert_task, sha256

PROGRAMS, PICTURES = "programs", "pictures"
POLL_INTERVAL_S = 0.1
MAX_PENDING_DRAWINGS = 256  # drawings an executor is given ahead: a cluster's workers are not left waiting, and memory is bounded
MAX_PENDING_BYTES = 64 * 2**20


@dataclass(frozen=True)
class Batch:
    """rows: one for each drawing, in their order; resumed: how many of them an earlier run had done; files: the tables
    and contact sheets; removed: programs and pictures, below the folder, that an earlier run had made of drawings that
    are refused now."""

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
    """Convert many drawings, each as `convert` does. What an earlier run into the same folder has done with the same
    drawing, choices, brush, cell and version, and whose files are there as written, is not done again.

    items: paths of drawings, folders, patterns with * and lists (.txt), and pairs of a name and an SVG document.
    out: the folder: programs/NAME.ngc, pictures/NAME.png, manifest.jsonl, table.csv, contact-1.png ...; a drawing that
    is refused is a row with its sentence and code, and stops nothing; what an earlier run made of it is removed.
    executor: any of concurrent.futures; it is given functions and values that can be pickled, and is not shut down.
    jobs: without it, the number of processes, by default one for each processor (a script that starts them needs
    `if __name__ == "__main__":`); cluster: the address of a scheduler of Dask's instead. The rows and files are the
    same in any process.
    format: extension of the programs, by default the first of the cell's language; parquet: table.parquet, too.
    progress, cancel, order, lenient, choices: as for convert; corrections are for one drawing alone.

    Raises Error for what concerns all: the folder, items of one name, files there that were made of another drawing of
    that name, a brush, a cell; CancelledError once cancel says so, and what is done stays done.
    """
    need(out, (str, os.PathLike), "a path, which out is")
    need(format, str, "an extension, such as '.ngc'")
    need_one_of(order, ORDERS, "order")
    known = {".json", *(extension for post in POSTS.values() for extension in post.extensions)}
    if format and format not in known:
        raise Error(f"{format[:40]!r} is no extension of programs or plans", "format", code="program-format")
    if (executor is not None) + (jobs is not None) + (cluster is not None) > 1:
        raise Error("executor, jobs and cluster exclude each other", code="options-contradict")
    if executor is not None:
        need(executor, Executor, "an executor of concurrent.futures")
    if cluster is not None:
        need(cluster, str, "the address of a scheduler")
    if progress is not None:
        need(progress, Callable, "a callable, which progress is")
    is_over = getattr(cancel, "is_set", cancel) or (lambda: False)
    need(is_over, Callable, "a callable or an event, which cancel is")
    if "corrections" in choices:
        raise Error(
            "corrections are of one drawing, not of a batch", "corrections", code="options-contradict"
        )
    count = int(need_number(os.cpu_count() if jobs is None else jobs, "jobs", 1, 1000))
    if parquet:
        tables.need_parquet()
    need(items, Iterable, "an iterable of drawings")
    need(items, object if not isinstance(items, str | bytes) else tuple, "a list of drawings")
    listed = make_items(items)
    need_truth(lenient, "lenient")
    need_truth(parquet, "parquet")
    way = _make_batch_settings(make_choices(None, choices), format, order, bool(lenient))
    folder = Path(out)
    manifest = Manifest(folder)
    try:
        keys = [way.key(item) for item in listed]
        rows: list[Row | None] = [
            manifest.done(key, item) if item.digest else None for key, item in zip(keys, listed, strict=True)
        ]
        resumed = len(listed) - rows.count(None)
        left = [index for index, row in enumerate(rows) if row is None]
        for index in left:
            manifest.refuse_other_drawing(listed[index])
        places = _TakenPlaces(listed, manifest)
        removed = [path for row in rows if row for path in manifest.remove_outdated(row)]
        report_row = _make_reporter(len(listed), resumed, progress or (lambda text: None))
        with ExitStack() as stack:
            is_ours = executor is None and cluster is None
            if left and executor is None:
                place = (
                    executors.connect_cluster(cluster)
                    if cluster
                    else executors.start_processes(min(count, len(left)))
                )
                executor = stack.enter_context(place)
            for index, done in _convert_remaining(executor, is_ours, left, listed, way, is_over):
                row = _write_result(folder, listed[index], keys[index], done, places)
                row = rows[index] = replace(row, path=manifest.way_to(listed[index]))
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
    """How all are converted; said: all of it in one text, with what comes along."""

    chosen: Choices
    brush: SentBrush | None
    format: str
    order: str
    lenient: bool
    version: str
    said: str

    def key(self, item: Item) -> str:
        return sha256(f"{item.digest}\n{self.said}".encode())

    def task(self, item: Item) -> Task:
        return Task(item.read(), self.chosen, self.brush, self.format, self.order, self.lenient, self.version)


def _make_batch_settings(chosen: Choices, format: str, order: str, lenient: bool) -> _BatchSettings:
    version = one.version()
    cell = load_cell(chosen.cell) if chosen.cell is not None else None
    brush = _read_brush_to_send(chosen.brush) if chosen.brush is not None else None
    shipped = [library.SHIPPED.glob("*.json"), cell_file.SHIPPED.glob("*.toml")]
    along = [sha256(read_bytes(path)) for paths in shipped for path in sorted(paths)]
    chosen = replace(chosen, z_offset=chosen.z_offset or 0.0, join=bool(chosen.join))  # as flags have them
    typed = asdict(replace(chosen, brush=None, cell=None))
    post = [sha256(read_bytes(path)) for path in sources_of_post(cell)] if cell else []
    known = [brush and (brush.sha256, sha256(brush.data)), cell and write_cell(cell), post, along]
    said = json.dumps([typed, format, order, lenient, version, known])
    chosen = replace(chosen, brush=None, cell=cell)
    return _BatchSettings(chosen, brush, format, order, lenient, version, said)


def _read_brush_to_send(brush) -> SentBrush:
    if isinstance(brush, _core.Brush):
        return SentBrush(_core.write_brush(brush).encode(), brush.sha256)
    try:
        data = read_bytes(find_file("brush", library.SHIPPED, ".json", brush))
        library.parse_brush(data)
    except Error as refusal:
        refusal.file = refusal.file or os.fspath(brush)
        raise
    return SentBrush(data, sha256(data))


def _convert_remaining(
    executor, is_ours: bool, left: list[int], items: list[Item], way: _BatchSettings, is_over
):
    """(Number, Made) of each that is left, as they come. is_ours: the work ends by itself, and is not polled."""
    done: queue.SimpleQueue = queue.SimpleQueue()
    waiting: dict[Future, tuple[int, int]] = {}
    numbers = iter(left)
    try:
        while True:
            while (
                len(waiting) < MAX_PENDING_DRAWINGS
                and sum(size for _, size in waiting.values()) < MAX_PENDING_BYTES
            ):
                index = next(numbers, None)
                if index is None:
                    break
                try:
                    task = way.task(items[index])
                except Error as refusal:
                    yield index, TaskResult(None, {}, b"", refusal.where, str(refusal), refusal.code)
                    continue
                future = executor.submit(convert_task, task)
                waiting[future] = index, len(task.drawing.data)
                future.add_done_callback(done.put)
            if not waiting:
                return
            if is_over():
                raise CancelledError("cancelled")
            try:
                future = done.get(timeout=POLL_INTERVAL_S)
            except queue.Empty:
                continue
            index, _ = waiting.pop(future)
            yield index, _get_result(future, items[index], way.version)
    finally:
        for future in () if is_ours else waiting:
            future.cancel()


def _get_result(future: Future, item: Item, version: str) -> TaskResult:
    try:
        found = future.result()
    except BrokenExecutor as broken:
        sentence = f"a worker died, over {item.source} or another one; what was done before is kept: {broken}"
        raise Error(sentence.splitlines()[0], code="worker-lost") from None
    if found.version != version:
        sentence = f"the worker has version {found.version} of brushsvg, not {version}"
        raise Error(sentence, code="version-unknown")
    return found


class _TakenPlaces:
    """Where the files of each drawing may be written, with no regard to case, as on Windows and macOS.

    A program in several files is a folder: that of `a` may contain the file that `a/a` is written to.
    """

    def __init__(self, items: list[Item], manifest: Manifest):
        self.manifest = manifest
        self.sources = {file_name_key(item.name): item.source for item in items}
        self.folders = {
            file_name_key(folder.as_posix()): item.source
            for item in items
            for folder in Path(item.name).parents
        }

    def refuse_taken(self, item: Item, paths: Iterable[str]) -> None:
        """Error where a file of this drawing would be one of another drawing, or a folder that contains one."""
        for path in paths:
            place = Path(path).relative_to(Path(path).parts[0])
            stem, own = file_name_key(place.with_suffix("").as_posix()), file_name_key(item.name)
            other = self.sources.get(stem) if stem != own else None
            other = other or self.folders.get(file_name_key(place.as_posix()))
            other = other or self.manifest.other_source(item, path)
            if other:
                sentence = f"{path} belongs to {other}: {item.source} would be written over it"
                raise Error(sentence, code="name-taken", advice="rename one of the two drawings")


def _write_result(folder: Path, item: Item, key: str, done: TaskResult, places: _TakenPlaces) -> Row:
    """Its row, once its files are written, all or none."""
    if done.figures is None:
        return Row(item.name, item.source, key, None, done.code, done.where, done.sentence, done.notices)
    place = Path(PROGRAMS, item.name) if len(done.texts) > 1 else Path(PROGRAMS, item.name).parent
    first = place / f"{Path(item.name).name}{done.suffix}"
    data = {Path(path_next_to(first, name)).as_posix(): text for name, text in done.texts.items()}
    data[f"{PICTURES}/{item.name}.png"] = done.picture
    try:
        places.refuse_taken(item, data)
    except Error as refusal:
        return Row(item.name, item.source, key, None, refusal.code, refusal.where, str(refusal), done.notices)
    write_files({make_path_below(folder, name): text for name, text in data.items()})
    sums = {name: sha256(text) for name, text in data.items()}
    return Row(item.name, item.source, key, done.figures, notices=done.notices, files=sums)


def _make_reporter(count: int, resumed: int, progress):
    """Return a function that reports each row with the progress, the speed, and the time left."""
    start, found = time.monotonic(), [0, 0]

    def report_row(row: Row) -> None:
        found[0] += 1
        found[1] += row.figures is None
        rate = found[0] / max(time.monotonic() - start, 1e-9)
        refused = f", {found[1]} refused" if found[1] else ""
        left_s = (count - resumed - found[0]) / rate
        progress(
            f"{resumed + found[0]} of {count} drawings{refused}; {rate:.1f} a second, {clock(left_s)} left"
        )

    return report_row


def _write_summary(folder: Path, rows: list[Row], parquet: bool) -> list[str]:
    """The tables and the contact sheets of all rows, and nothing that an earlier, larger batch left of the latter."""
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
    overlap = "" if figures.overlap is None else f"overlap {figures.overlap:.3f}"
    takes = "" if figures.time_s is None else clock(figures.time_s)
    words = ", ".join(filter(None, (overlap, takes)))
    return Card(row.name, words, "", lambda: read_bytes(folder / PICTURES / f"{row.name}.png"))
