"""Run the scripts of figures/ and make a page of their pictures, numbers and code.

A script uses public names only, in at most 40 lines. It leaves `figure`, a matplotlib Figure, and `rows`: (name, the
printed number or None, our number). Its docstring is the title and the remarks, for example why a printed value cannot
be reproduced.
"""

from __future__ import annotations

import ast
import io
import runpy
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

SCRIPTS = Path(__file__).with_name("figures")
DOTS_PER_INCH = 90  # 720 pixels wide: read on a page without zooming, some 30 kB each

TOP = """# The article, figure by figure

"Physically Motivated Model of a Painting Brush for Robotic Painting and Calligraphy" (Robotics 2024, 13(6), 94),
computed again by the public functions of brushsvg. `python examples/article docs` writes this page; it needs
matplotlib. Each script below runs as it stands. It leaves `figure`, a picture, and `rows`, the table under it: the
printed value, ours and the difference. An empty cell was not printed. Lengths are in mm, z is the press depth. Where
the print is wrong:
[equations.md](equations.md).

Not drawn: figures 5 (a flow chart) and 8 (photographs of a set-up and of the brush).
"""


@dataclass(frozen=True)
class Drawn:
    """One figure: name of its script, title, remarks, code, rows and picture (PNG)."""

    name: str
    title: str
    remarks: str
    code: str
    rows: list[tuple[str, float | None, float]]
    picture: bytes


def article_page(stage: Callable[[str], None] = lambda text: None) -> dict[str, bytes]:
    """Return the files of the page by their paths: article.md and its pictures, article/NAME.png.

    stage: called with the name of each script before it runs. Takes half a minute at most.
    """
    drawn = []
    for path in sorted(SCRIPTS.glob("*.py")):
        stage(f"drawing {path.stem}")
        drawn.append(run(path))
    page = "\n".join([TOP, *map(_section, drawn)])
    return {"article.md": page.encode()} | {f"article/{one.name}.png": one.picture for one in drawn}


def run(path: Path) -> Drawn:
    """Run a script and draw its figure."""
    text = path.read_text(encoding="utf-8")
    left = runpy.run_path(str(path))
    title, _, remarks = left["__doc__"].strip().partition("\n\n")
    out = io.BytesIO()
    left["figure"].savefig(out, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
    return Drawn(path.stem, title, remarks.strip(), code_of(text), left["rows"], out.getvalue())


def code_of(text: str) -> str:
    """Return a script without its docstring."""
    lines = text.splitlines()
    return "\n".join(lines[ast.parse(text).body[0].end_lineno :]).strip()


def _section(one: Drawn) -> str:
    table = ["| | printed | ours | difference |", "|---|---|---|---|"]
    for what, printed, ours in one.rows:
        known = printed is not None
        cells = [
            what,
            _number(printed) if known else "",
            _number(ours),
            _number(ours - printed) if known else "",
        ]
        table.append(f"| {' | '.join(cells)} |")
    code = [f"    {line}".rstrip() for line in one.code.splitlines()]
    parts = [f"## {one.title}", one.remarks, f"![{one.title}](article/{one.name}.png)", "\n".join(table)]
    return "\n\n".join([*parts, "\n".join(code)]) + "\n"


def _number(value: float) -> str:
    """Return four digits: as many as every processor agrees on."""
    text = f"{float(value) + 0.0:.4g}"
    return "0" if float(text) == 0.0 or abs(float(value)) < 1e-9 else text
