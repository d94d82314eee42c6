"""Read how a program was made from the header that brushsvg wrote."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ...errors import Error


@dataclass(frozen=True)
class ProgramHeader:
    """How a program was made, from its header.

    tolerance_mm is None where the header does not state it. strokes: number of strokes of the job; notes: the lines
    about its planning, as they are written. border_mm: left, bottom, right and top of the border that an air run
    follows; heights_mm: highest, lowest and step of the strokes that find the paper; first_mm: highest, lowest and step
    of a first run. These three are None for programs that paint.
    """

    title: str
    brush: str
    cell: str
    sheet_mm: tuple[float, float] | None
    z_offset_mm: float
    first_stroke: int
    nearest_first: bool
    is_corrected: bool
    compensation: str
    tolerance_mm: float | None
    lag_mm: float | None
    start: str | None = None
    end: str | None = None
    strokes: int = 0
    notes: tuple[str, ...] = ()
    border_mm: tuple[float, ...] | None = None
    heights_mm: tuple[float, ...] | None = None
    first_mm: tuple[float, ...] | None = None
    has_margin: bool = False  # margin strokes were requested, even if they did not fit
    is_of_plan: bool = False  # made from a plan.json, which does not say how it was planned


def read_header(text: str) -> ProgramHeader:
    """Read how a program was made from its header.

    Raises Error when brushsvg did not write the header, or when one of its numbers is damaged.
    """
    header = _header_lines(text)
    if missing := [word for word in ("title", "brush", "cell") if word not in header]:
        lost = "" if len(missing) == 3 else ", or a line was lost"
        sentence = f"its header does not name {' and '.join(missing)}: brushsvg did not write this program{lost}"
        raise Error(sentence, code="header-damaged")
    sheet = _numbers_in(header, "sheet", r"(\S+) x (\S+) mm", (1e-3, 1e6))
    paper = _numbers_in(header, "paper", r"(\S+) mm against the cell's", (-20.0, 20.0))
    resumed = _numbers_in(header, "resumed", r"from stroke (\d+)", (1, 1e6))
    border = _numbers_in(header, "border", r"(\S+) to (\S+) mm, (\S+) to (\S+) mm", (-1e5, 1e6))
    heights = _numbers_in(header, "heights", r"(\S+) to (\S+) mm, (\S+) mm apart", (-1000.0, 1000.0))
    first = _numbers_in(header, "first", r"heights (\S+) to (\S+) mm, (\S+) mm apart", (-1000.0, 1000.0))
    how = re.match(r"(none|constant|closed|refined), ", header.get("compensation", "closed, "))
    ends = r"(?:, start (?:auto|round|butt|pointed))?(?:, end (?:auto|round|butt|pointed))?"
    written = rf"\w+, tolerance (\S+) mm(?:, lag \S+ mm)?{ends}"
    tolerance = _numbers_in(header, "compensation", written, (1e-5, 10.0))
    start = re.search(r", start (\w+)(?:, end \w+)?$", header.get("compensation", ""))
    end = re.search(r", end (\w+)$", header.get("compensation", ""))
    has_lag = ", lag " in header.get("compensation", "")
    lag = _numbers_in(header, "compensation", r".*, lag (\S+) mm.*", (0.0, 1000.0)) if has_lag else None
    if how is None:
        raise _damaged_error("compensation", header["compensation"])
    _numbers_in(header, "warnings", r"(\d+)(?:, \d+ of them damaged geometry)?", (0, 1e6))
    if header.get("order", "nearest first") != "nearest first":
        raise _damaged_error("order", header["order"])
    _numbers_in(header, "corrections", r"(\d+) strokes, shifted by (\S+) mm at most", (0, 1e6))
    _numbers_in(header, "margin", r"(\d+) strokes", (0, 1e6))
    strokes = re.search(r", (\d{1,7}) strokes$", header["brush"])
    return ProgramHeader(
        title=header["title"],
        brush=header["brush"].rpartition(", ")[0] or header["brush"],
        cell=header["cell"].rpartition(", ")[0],
        sheet_mm=(sheet[0], sheet[1]) if sheet else None,
        z_offset_mm=paper[0] if paper else 0.0,
        first_stroke=int(resumed[0]) if resumed else 1,
        nearest_first="order" in header,
        is_corrected="corrections" in header,
        compensation=how[1],
        tolerance_mm=tolerance[0] if tolerance else None,
        lag_mm=lag[0] if lag else None,
        start=start[1] if start else None,
        end=end[1] if end else None,
        strokes=int(strokes[1]) if strokes else 0,
        notes=tuple(
            f"{word}: {header[word]}"
            for word in ("compensation", "warnings", "margin", "corrections", "order")
            if word in header
        ),
        border_mm=(border[0], border[2], border[1], border[3]) if border else None,
        heights_mm=tuple(heights) if heights else None,
        first_mm=tuple(first) if first else None,
        has_margin="margin" in header,
        is_of_plan="compensation" not in header,
    )


def _numbers_in(header: dict[str, str], word: str, pattern: str, bounds: tuple[float, float]) -> list[float] | None:
    """Return a header line's numbers, None without it; raise Error if damaged or out of bounds."""
    if word not in header:
        return None
    found = re.fullmatch(pattern, header[word])
    try:
        numbers = [float(text) for text in found.groups()]
    except (AttributeError, ValueError):
        raise _damaged_error(word, header[word]) from None
    for value in numbers:
        if not bounds[0] <= value <= bounds[1]:
            sentence = f"{word} in its header: {value:g} is outside the range [{bounds[0]:g}, {bounds[1]:g}]"
            raise Error(sentence, code="header-damaged")
    return numbers


def _damaged_error(word: str, text: str) -> Error:
    return Error(
        f"its header is damaged: ({word}: {text[:50]}) is not what brushsvg writes there",
        code="header-damaged",
    )


def _header_lines(text: str) -> dict[str, str]:
    """Return the lines at the top of a program by their first word. These are title, brush, sheet, cell and others."""
    text = re.sub(r" *; *\r?\n *\d*: *!\+", "", text)  # join continued remarks of TP
    line_pattern = re.compile(
        r"\((\w+): (.*)\)| *(?:[#!;]|--) (\w+):(?: (.*))?| *\d*: *!(\w+):(?: (.*?))? *;|CO \"(\w+): (.*)\";"
    )
    lines = (line_pattern.fullmatch(line.rstrip(" \r")) for line in text.lstrip("\ufeff").split("\n")[:100])
    found = ([each for each in line.groups() if each is not None] for line in lines if line)
    return {word: texts[0] if texts else "" for word, *texts in found}
