"""Reader from the G-code of a pen plotter to a Design.

Moves with the pen down become lines. The rules are in docs/reference/drawings.md.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from ...errors import Error
from .. import AS_DRAWN, ReadOptions
from ..design import Design, Element, Notice, SubPath
from ..empty_drawing import empty_drawing_error
from ..layout import scale_and_move
from .dips import find_dips, read_comments
from .pen import MAX_HOP_MM, read_pen
from .toolpaths import Way, read_moves

MARGIN_MM = 20.0
LINE_WIDTH_MM = 1.0
# Shares of the length that a program seems to draw. If less is read, the program is refused, or a notice reports it.
MIN_READ_SHARE, SURE_READ_SHARE = 0.5, 0.95


def read_gcode(data: bytes, options: ReadOptions = AS_DRAWN) -> Design:
    """Return the lines of a plotter program as a Design, in the order drawn.

    Without options.sheet_mm, the sheet is the bounding box of the lines plus a margin of 20 mm. A given sheet has
    its lower left corner at the zero of the program.

    Raises Error for a program that brushsvg wrote, because it moves a brush and is not a drawing, and for lines
    that cannot be read.
    """
    text = data.decode("utf-8-sig", errors="replace")
    if is_ours(text):
        sentence = (
            "brushsvg wrote this program: its lines move a brush and are not a drawing; convert the drawing instead"
        )
        raise Error(sentence, code="program-ours")
    all_ways = read_moves(text)
    pen = read_pen(all_ways, options.pen, options.paper_z_mm) if all_ways else None
    if pen and pen.share < MIN_READ_SHARE and options.pen is None and options.paper_z_mm is None:
        sentence = f"only {100 * pen.share:.0f} % of what it seems to draw is read: {pen.how}"
        raise Error(sentence, code="pen-unclear", advice=_suggest_readings(all_ways, pen.kind))
    chains = _group_into_lines(all_ways, pen.down if pen else ())
    notices = []
    if pen:
        is_unsure = pen.share < SURE_READ_SHARE
        sentence = f"{100 * pen.share:.0f} % of what it seems to draw is read: {pen.how}" if is_unsure else pen.how
        notices.append(Notice("pen", sentence, code="pen-reading"))
        notices += pen.notices
    chains, left_out = _leave_out_dips(chains, read_comments(text), options)
    notices += left_out
    elements = [_line_to_element(chain) for chain in chains]
    if not elements:
        raise empty_drawing_error(notices)
    ends = np.concatenate([sub.cubics[:, ::3].reshape(-1, 2) for element in elements for sub in element.subpaths])
    sentence = f"G-code has no widths: its lines count as {LINE_WIDTH_MM:g} mm wide"
    notices.append(Notice("", sentence, code="gcode-no-width", advice="--width MM sets their width"))
    heights = np.concatenate([way.points_mm[:, 2] for chain in chains for way in chain])
    if np.isfinite(heights).all() and np.ptp(heights) > 1e-3:
        sentence = f"its pen moves at heights from {heights.min():.6g} to {heights.max():.6g} mm: they are left out"
        notices.append(Notice("z", sentence, code="gcode-not-flat"))
    if options.sheet_mm:
        return Design(options.sheet_mm, tuple(elements), tuple(notices))
    shift = MARGIN_MM - ends.min(axis=0)
    width, height = (ends.max(axis=0) + shift + MARGIN_MM).tolist()
    return Design(
        (width, height), tuple(scale_and_move(element, 1.0, shift, 1.0) for element in elements), tuple(notices)
    )


def _suggest_readings(all_ways: list[Way], kind: str) -> str:
    """Return advice: the flags that choose the other readings of a program."""
    has_height = any(np.isfinite(way.points_mm[:, 2]).any() for way in all_ways)
    other = "servo" if kind == "z" else "z"
    has_other = any(way.power is not None for way in all_ways) if kind == "z" else has_height
    readings = [f"--pen {other} chooses the other reading"] if has_other else []
    return ", ".join(readings + (["--paper-z MM gives the height at which it draws"] if has_height else []))


def _group_into_lines(all_ways: list[Way], down: Sequence[bool]) -> list[list[Way]]:
    """Return drawn ways as lines; a pen that comes down where it went up continues its line."""
    chains: list[list[Way]] = []
    is_drawn = False
    for way, is_down in zip(all_ways, down, strict=True):
        was_drawn, is_drawn = is_drawn, is_down and bool(np.isfinite(way.points_mm[:, :2]).all())
        if not is_drawn:  # also true for the way to the first place, whose start is unknown
            continue
        if not was_drawn and not (chains and _continues_line(chains[-1], way)):
            chains.append([])
        chains[-1].append(way)
    return chains


def _continues_line(chain: list[Way], way: Way) -> bool:
    gap = way.points_mm[0, :2] - chain[-1].points_mm[-1, :2]
    is_line = all(np.ptp(part.points_mm[:, :2], axis=0).any() for part in (chain[-1], way))
    return is_line and bool(np.hypot(*gap) <= MAX_HOP_MM)


def _leave_out_dips(chains: list, comment_by_line: dict[int, str], options: ReadOptions) -> tuple[list, list[Notice]]:
    """Return the lines that draw, and notices about the lines that were left out.

    Left out are strokes that fetch paint and strokes that the options skip.

    comment_by_line: comments of the program by line number.
    """
    strokes = [(chain[0].line, np.concatenate([way.points_mm[:, :2] for way in chain])) for chain in chains]
    skipped = [_is_skipped(line, points, comment_by_line, options) for line, points in strokes]
    notices = []
    if any(skipped):
        sentence = f"left out by region or comment: {sum(skipped)} of {len(skipped)} strokes"
        notices.append(Notice("skip", sentence, code="strokes-skipped"))
    remaining = [
        (chain, stroke) for chain, stroke, is_skipped in zip(chains, strokes, skipped, strict=True) if not is_skipped
    ]
    # If the user chooses the strokes to leave out, no others are left out.
    if options.skip_comments or options.skip_regions_mm:
        return [chain for chain, _ in remaining], notices
    are_dips, how = find_dips([stroke for _, stroke in remaining], comment_by_line)
    if any(are_dips):
        lines = [stroke[0] for (_, stroke), is_dip in zip(remaining, are_dips, strict=True) if is_dip]
        count = f"{len(lines)} dips are" if len(lines) > 1 else "1 dip is"
        sentence = f"{count} left out, recognised {how}; the first is in line {lines[0]}"
        advice = "--skip-comment TEXT or --skip-region X0,Y0,X1,Y1 leaves out other strokes instead"
        notices.append(Notice("dips", sentence, code="dips-left-out", advice=advice))
    return [chain for (chain, _), is_dip in zip(remaining, are_dips, strict=True) if not is_dip], notices


def _is_skipped(line: int, points: np.ndarray, comment_by_line: dict[int, str], options: ReadOptions) -> bool:
    before = [number for number in comment_by_line if number <= line]
    words = comment_by_line[max(before)].casefold() if before else ""
    if any(word.casefold() in words for word in options.skip_comments):
        return True
    regions = (np.array(region) for region in options.skip_regions_mm)
    return any(bool(((points >= region[:2]) & (points <= region[2:])).all()) for region in regions)


def is_ours(text: str) -> bool:
    """Whether brushsvg wrote a program, by its header or the comment above a stroke."""
    head = text[:4000]
    return any(f"({word}: " in head or f"; {word}: " in head for word in ("brush", "cell", "sheet")) or bool(
        re.search(r"(?m)^(?:\(|; ?)stroke \d+ of \d+: ", text)
    )


def _line_to_element(chain: list) -> Element:
    points = [chain[0].points_mm[:1, :2], *(way.points_mm[1:, :2] for way in chain)]
    path = np.concatenate(points)
    path = path[np.r_[True, np.diff(path, axis=0).any(axis=1)]]
    if len(path) == 1:
        path = np.repeat(path, 2, axis=0)
    a, b = path[:-1], path[1:]
    cubics = np.stack([a, a + (b - a) / 3, a + (b - a) * 2 / 3, b], axis=1)
    return Element(f"line{chain[0].line}", (SubPath(cubics),), LINE_WIDTH_MM)
